//! Tests of whole campaigns; the parts are tested in their own files.

use super::*;
use crate::base::session::Session;
use crate::formats::session_toml;
use crate::numerics::plateaus::{PlateauOptions, find_plateaus};

const COMMITTED: [&str; 2] = [
    include_str!("../../truths/simulated-10mm.toml"),
    include_str!("../../truths/simulated-20mm.toml"),
];

const SMALL: &str = r#"
schema = "bpa-truth/1"
campaign = "small"
seed = 5
diameter_mm = 10
coefficients = "published"
contractions = [0, 0.5]
runs = [8, 9]
sampling = "timeseries"
[[specimen]]
id = "a"
rest_length_mm = 182
contraction_max = 0.165
[[specimen]]
id = "b"
rest_length_mm = 83
contraction_max = 0.157
role = "holdout"
[rig]
rows = 600
zero_rows = 200
"#;

fn truth(text: &str) -> Truth {
    read_truth("truth.toml", text).expect("a good truth file")
}

fn session(files: &SessionFiles) -> Session {
    let text = std::str::from_utf8(&files.files[0].1).expect("UTF-8");
    session_toml::read("session.toml", text).expect("a good session.toml")
}

/// The columns of a log.
fn columns(bytes: &[u8]) -> Vec<Vec<f64>> {
    let text = std::str::from_utf8(bytes).expect("UTF-8");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|l| l.split(',').map(|c| c.parse().expect("a number")).collect())
        .collect();
    (0..rows[0].len())
        .map(|k| rows.iter().map(|r| r[k]).collect())
        .collect()
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

#[test]
fn the_same_truth_gives_the_same_bytes_and_another_seed_gives_others() {
    let campaign = simulate(&truth(SMALL));
    assert_eq!(campaign, simulate(&truth(SMALL)));
    let other = simulate(&truth(&SMALL.replace("seed = 5", "seed = 6")));
    assert_ne!(campaign.sessions[0].files[1], other.sessions[0].files[1]);
}

#[test]
fn what_is_added_leaves_the_other_sessions_as_they_were() {
    let before = simulate(&truth(SMALL));
    let more = SMALL
        .replace("[0, 0.5]", "[0.25, 0, 0.5]")
        .replace("[8, 9]", "[10, 8, 9]\nrun_speed = [1, 1, 0.56]")
        .replace(
            "[[specimen]]\nid = \"a\"",
            "[[specimen]]\nid = \"new\"\nrest_length_mm = 300\ncontraction_max = 0.17\n[[specimen]]\nid = \"a\"",
        );
    let after = simulate(&truth(&more));
    assert_eq!(after.sessions.len(), 9);
    for old in &before.sessions {
        let new = after.sessions.iter().find(|s| s.folder == old.folder);
        let new = new.expect("the session is still there");
        for (name, bytes) in old.files.iter().filter(|f| f.0.ends_with(".csv")) {
            assert!(
                new.files.iter().any(|f| &f.0 == name && &f.1 == bytes),
                "{name}"
            );
        }
    }
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
            let length = session.setup_number(crate::base::columns::LENGTH);
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
fn plateaus_of_a_noise_free_log_agree_with_the_model() {
    let mut truth = truth(&SMALL.replace("rows = 600", "rows = 12000\nfill_share = 0.2"));
    (truth.rig.force_noise_n, truth.rig.pressure_noise_kpa) = (0.0, 0.0);
    let options = PlateauOptions {
        bin_s: 0.02,
        step_rate_kpa_per_s: 60.0,
        settle_s: 0.15,
        window_s: 0.25,
        shortest_window_s: 0.1,
        distinct_kpa: 5.0,
        longest_gap_s: 0.1,
    };
    let campaign = simulate(&truth);
    for (files, drawn) in campaign.sessions.iter().zip(&campaign.drawn.sessions) {
        let actuator = campaign.drawn.actuator(drawn);
        let [force, pressure, time, _] = &columns(&files.files[2].1)[..] else {
            panic!("four columns");
        };
        let plateaus = find_plateaus(time, pressure, &options).plateaus;
        assert!(plateaus.len() >= 12, "{}", plateaus.len());
        for plateau in plateaus {
            let p = mean(&pressure[plateau.window.clone()]);
            let f = mean(&force[plateau.window.clone()]) - drawn.force_zero_n;
            let expected = actuator.force(drawn.length_mm * 1e-3, p);
            let clipped = expected + drawn.force_zero_n < truth.rig.force_clip_n;
            // Half a count of force, half a count of pressure at most 0.9 N/kPa.
            assert!(
                clipped || (f - expected).abs() < 0.6831,
                "{p} kPa: {f} N, {expected} N"
            );
        }
    }
}

#[test]
fn zero_logs_show_the_zero_and_clip_where_the_amplifier_does() {
    let zero = |mean_n: &str| {
        let rig = format!("zero_sd_n = 0\nzero_mean_n = {mean_n}\nzero_rows = 2000");
        let campaign = simulate(&truth(&SMALL.replace("zero_rows = 200", &rig)));
        columns(&campaign.sessions[0].files[1].1)[0].clone()
    };
    assert!((mean(&zero("7.5")) - 7.5).abs() < 0.1);
    let clipped = zero("-12");
    let low = clipped.iter().filter(|f| **f == -8.7354).count();
    assert!(low > 1900, "{low}");
}

#[test]
fn the_zero_wanders_and_the_strength_belongs_to_the_specimen() {
    let drawn = DrawnTruth::new(&truth(COMMITTED[0]));
    let of = |k: usize| drawn.sessions.iter().filter(move |s| s.specimen == k);
    for k in 0..6 {
        let strengths: Vec<f64> = of(k).map(|s| s.strength).collect();
        assert!(strengths.windows(2).all(|w| w[0] == w[1]));
        assert!((strengths[0] - 1.0).abs() < 0.1);
    }
    let zeros: Vec<f64> = drawn.sessions.iter().map(|s| s.force_zero_n).collect();
    assert!(zeros.iter().any(|z| *z > 6.0) && zeros.iter().any(|z| *z < 2.0));
}

#[test]
fn steady_rows_agree_with_the_model_to_their_noise() {
    for text in COMMITTED {
        let (drawn, rows) = rows(&truth(text));
        assert!(rows.len() > 500, "{}", rows.len());
        let errors: Vec<f64> = rows
            .iter()
            .map(|row| {
                let session = &drawn.sessions[row.session];
                let length = session.length_mm * 1e-3;
                row.force_n - drawn.actuator(session).force(length, row.pressure_kpa)
            })
            .collect();
        let rmse = mean(&errors.iter().map(|e| e * e).collect::<Vec<f64>>()).sqrt();
        assert!(mean(&errors).abs() < 0.1 && rmse < 0.4, "{rmse}");
    }
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
fn every_mistake_of_a_truth_file_is_reported_with_line_and_hint() {
    let text = SMALL
        .replace("seed = 5", "sede = 5")
        .replace("[0, 0.5]", "[0, 3, 0]")
        .replace("contraction_max = 0.157", "contraction_max = 157")
        .replace(
            "rows = 600",
            "rows = 600\nsuply_kpa = 620\n[[effect]]\nid = \"creep\"",
        );
    let mistakes = read_truth("truth.toml", &text).expect_err("four mistakes");
    let lines: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
    let has = |parts: &[&str]| lines.iter().any(|l| parts.iter().all(|p| l.contains(p)));
    assert!(has(&["truth.toml:1 [seed]", "found nothing"]), "{lines:#?}");
    assert!(
        has(&["truth.toml:4 [sede]", "did you mean `seed`?"]),
        "{lines:#?}"
    );
    assert!(
        has(&["truth.toml:7 [contractions[1]]", "found 3"]),
        "{lines:#?}"
    );
    assert!(
        has(&["[specimen[1].contraction_max]", "found 157"]),
        "{lines:#?}"
    );
    assert!(
        has(&["[rig.suply_kpa]", "did you mean `supply_kpa`?"]),
        "{lines:#?}"
    );
    assert!(has(&["[effect]", "an unknown key"]), "{lines:#?}");
}

#[test]
fn what_the_rig_cannot_measure_is_refused() {
    let mistake = |text: &str| read_truth("t", text).expect_err("a mistake")[0].to_string();
    let strong = "coefficients = { b1 = 3000, b2 = 19, l_0 = 0.0075, c0 = 0.5, c1 = 4, c2 = 0.5 }";
    let text = SMALL.replace("coefficients = \"published\"", strong);
    assert!(
        mistake(&text).contains("force_quantum_n"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("diameter_mm = 10", "diameter_mm = 40");
    assert!(
        mistake(&text).contains("not published"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("id = \"b\"", "id = \"A\"");
    assert!(
        mistake(&text).contains("`a` a second time"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("rows = 600", "rows = 600\nfloor_kpa = 80\nsupply_kpa = 70");
    assert!(
        mistake(&text).contains("rig.floor_kpa"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("id = \"b\"", "id = \"../b\"");
    assert!(
        mistake(&text).contains("letters, digits"),
        "{}",
        mistake(&text)
    );
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
