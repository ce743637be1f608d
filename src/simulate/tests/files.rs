//! What is written, and where not.

use super::super::*;
use super::{COMMITTED, SMALL, truth};
use pipeline_base::session::Session;
use pipeline_formats::session_toml;

fn session(files: &SessionFiles) -> Session {
    let text = std::str::from_utf8(&files.files[0].1).expect("UTF-8");
    session_toml::read("session.toml", text).expect("a good session.toml")
}

#[test]
fn session_files_are_read_back_without_a_mistake() {
    for text in COMMITTED.into_iter().chain([SMALL]) {
        let mut truth = truth(text);
        (truth.rig.rows, truth.rig.zero_rows) = (100, 100);
        let campaign = simulate(&truth);
        for (files, drawn) in campaign.sessions.iter().zip(&campaign.drawn.sessions) {
            let session = session(files);
            assert_eq!(session.id, drawn.id);
            assert!(session.is_simulated());
            assert_eq!(session.role, campaign.drawn.specimen(drawn).role);
            assert_eq!(session.date, truth.date);
            let length = session.setup_number(pipeline_base::columns::LENGTH);
            assert_eq!(length, Some(drawn.length_mm * 1e-3));
            let names: Vec<&str> = session.logs.iter().map(|l| l.file.as_str()).collect();
            let written: Vec<&str> = files.files[1..].iter().map(|f| f.0.as_str()).collect();
            assert_eq!(names, written);
            assert!(session.logs[0].is_zero);
        }
    }
}

#[test]
fn notes_with_quotes_and_line_breaks_survive() {
    let text = SMALL.replace("seed = 5", "seed = 5\nnotes = \"a \\\"quoted\\\"\\nline\"");
    let campaign = simulate(&truth(&text));
    let notes = session(&campaign.sessions[0]).notes.expect("notes");
    assert_eq!(
        notes,
        "simulated by pipeline simulate, campaign small, seed 5; a \"quoted\"\nline"
    );
}

#[test]
fn points_are_steady_readings_at_the_pressures_asked_for() {
    let text = SMALL.replace(
        "\"timeseries\"",
        "\"points\"\npressures_kpa = [0, 300, 620]",
    );
    let truth = truth(&text);
    let campaign = simulate(&truth);
    assert_eq!(session(&campaign.sessions[0]).logs.len(), 2);
    let log = std::str::from_utf8(&campaign.sessions[0].files[1].1).expect("UTF-8");
    assert_eq!(log.lines().count(), 4);
    assert_eq!(rows(&truth).1.len(), 2 * 2 * 2 * 3);
}

#[test]
fn committed_campaigns_stay_small() {
    let sizes: Vec<usize> = COMMITTED
        .iter()
        .flat_map(|text| simulate(&truth(text)).sessions)
        .flat_map(|s| s.files.into_iter().map(|f| f.1.len()).collect::<Vec<_>>())
        .collect();
    assert!(sizes.iter().sum::<usize>() < 9_000_000);
    assert!(sizes.iter().max() < Some(&2_000_000));
}

#[test]
fn a_folder_that_is_not_empty_is_refused_and_only_simulated_sessions_are_replaced() {
    let campaign = simulate(&truth(SMALL));
    let place = tempfile::tempdir().expect("a folder");
    let out = place.path().join("raw/small");
    let truth_out = place.path().join("truth/small.json");
    let written = write(&campaign, &out, Some(&truth_out), false).expect("written");
    assert_eq!((written.sessions, written.files), (4, 16));
    assert!(out.join("a/c50/session.toml").is_file() && truth_out.is_file());
    let refused = |replace| {
        write(&campaign, &out, None, replace)
            .expect_err("refused")
            .to_string()
    };
    assert!(refused(false).contains("is not empty"));
    write(&campaign, &out, None, true).expect("replaced");
    std::fs::create_dir(out.join("mine")).expect("a folder");
    std::fs::write(out.join("mine/session.toml"), "notes = \"measured\"").expect("a file");
    assert!(refused(true).contains("was not written by `pipeline simulate`"));
    assert!(out.join("a/c50/test8.csv").is_file());
}

#[test]
fn the_truth_is_never_written_into_the_campaign() {
    let campaign = simulate(&truth(SMALL));
    let place = tempfile::tempdir().expect("a folder");
    let inside = place.path().join("raw/truth.json");
    let error =
        write(&campaign, &place.path().join("raw"), Some(&inside), false).expect_err("refused");
    assert!(error.to_string().contains("inside the campaign's folder"));
    assert!(!place.path().join("raw").exists());
}
