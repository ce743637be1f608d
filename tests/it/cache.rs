//! "Run, change one thing, assert what ran again."

use crate::support::{Bench, files};
use std::collections::BTreeSet;

/// Stages and units that a run computed, from its explanation.
fn computed(bench: &Bench, arguments: &[&str]) -> BTreeSet<String> {
    let mut all = vec!["run", "--explain"];
    all.extend(arguments);
    let said = bench.run(&all);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let stages = pipeline::run::STAGES;
    let is_work = |l: &&str| stages.iter().any(|s| l.starts_with(&format!("{s} ")));
    said.out
        .lines()
        .filter(is_work)
        .map(|l| l.split(": ").next().unwrap().to_owned())
        .collect()
}

fn set(items: &[&str]) -> BTreeSet<String> {
    items.iter().map(ToString::to_string).collect()
}

const DOWNSTREAM: [&str; 6] = [
    "fit small 10 mm",
    "compare small 10 mm",
    "diagnose small 10 mm",
    FIGURES,
    "report reports",
    "report tables",
];
const FIGURES: &str = "report figures of small 10 mm";

#[test]
fn a_second_run_does_nothing_and_says_so() {
    let bench = Bench::small();
    assert_eq!(computed(&bench, &[]).len(), 6 * 3 + 6);
    let before = bench.snapshot("reports");
    let said = bench.run(&["run"]);
    assert!(
        said.out
            .starts_with("nothing to do: 6 sessions, all 24 results are up to date"),
        "{}",
        said.out
    );
    assert_eq!(bench.snapshot("reports"), before);
    let status = bench.run(&["status"]);
    assert_eq!(
        (status.code, status.out.contains("nothing to do")),
        (0, true)
    );
}

#[test]
fn a_changed_byte_in_one_log_redoes_that_session_and_what_depends_on_it() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let log = bench.raw().join("small/b/c50/test8.csv");
    let mut bytes = std::fs::read(&log).unwrap();
    let digit = bytes
        .iter()
        .position(|b| (b'1'..=b'8').contains(b))
        .unwrap();
    bytes[digit] += 1;
    std::fs::write(&log, bytes).unwrap();
    let status = bench.run(&["status"]);
    assert_eq!(status.code, 1);
    assert!(
        status.out.contains("input changed: test8.csv"),
        "{}",
        status.out
    );
    let ran = computed(&bench, &[]);
    let session = "small-b-c50";
    assert!(ran.contains(&format!("ingest {session}")), "{ran:?}");
    assert!(
        ran.iter()
            .all(|r| r.ends_with(session) || DOWNSTREAM.contains(&r.as_str())),
        "{ran:?}"
    );
}

#[test]
fn a_touched_file_and_a_comment_redo_nothing() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let session = bench.raw().join("small/a/c00/session.toml");
    let text = std::fs::read_to_string(&session).unwrap();
    std::fs::write(&session, format!("# a remark\n{text}")).unwrap();
    let log = bench.raw().join("small/a/c00/test8.csv");
    let bytes = std::fs::read(&log).unwrap();
    std::fs::write(&log, bytes).unwrap();
    assert_eq!(computed(&bench, &[]), set(&[]));
}

#[test]
fn an_option_redoes_the_stages_that_read_it() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let config = bench.root().join("pipeline.toml");
    std::fs::write(&config, "[report]\ntitle = \"Another\"\n").unwrap();
    assert_eq!(computed(&bench, &[]), set(&["report reports"]));
    let diagnose = "[report]\ntitle = \"Another\"\n[diagnose]\ndraws = 39\n";
    std::fs::write(&config, diagnose).unwrap();
    let again = [
        "diagnose small 10 mm",
        FIGURES,
        "report reports",
        "report tables",
    ];
    assert_eq!(computed(&bench, &[]), set(&again));
    std::fs::write(
        &config,
        "[report]\ntitle = \"Another\"\n[fit]\nloss = \"least_squares\"\n",
    )
    .unwrap();
    let said = bench.run(&["status"]);
    assert!(
        said.out
            .contains("option fit.loss \"huber\" -> \"least_squares\""),
        "{}",
        said.out
    );
    assert_eq!(computed(&bench, &[]), set(&DOWNSTREAM));
    std::fs::remove_file(&config).unwrap();
    assert_eq!(
        computed(&bench, &[]),
        set(&[]),
        "what was computed before is still there"
    );
}

#[test]
fn an_unchanged_intermediate_result_stops_the_cascade() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let log = bench.raw().join("small/c/c00/test8.csv");
    let text = std::fs::read_to_string(&log).unwrap();
    std::fs::write(&log, text.replace('\n', "\r\n")).unwrap();
    assert_eq!(
        computed(&bench, &[]),
        set(&["ingest small-c-c00"]),
        "other line ends, same numbers"
    );
}

#[test]
fn moving_the_directory_changes_nothing() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let reports = bench.snapshot("reports");
    let elsewhere = Bench::empty();
    std::fs::remove_dir(elsewhere.raw()).unwrap();
    for folder in ["raw", "derived", "reports"] {
        std::fs::rename(bench.root().join(folder), elsewhere.root().join(folder)).unwrap();
    }
    assert_eq!(computed(&elsewhere, &[]), set(&[]));
    assert_eq!(elsewhere.snapshot("reports"), reports);
}

#[test]
fn the_same_inputs_give_the_same_bytes_whatever_the_number_of_jobs() {
    let (one, two) = (Bench::small(), Bench::small());
    computed(&one, &["--jobs", "1"]);
    computed(&two, &["--jobs", "4"]);
    assert_eq!(one.snapshot("reports"), two.snapshot("reports"));
    assert_eq!(
        one.snapshot("derived/cache/objects"),
        two.snapshot("derived/cache/objects")
    );
}

#[test]
fn what_is_lost_below_reports_is_put_back_without_computing() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let before = bench.snapshot("reports");
    std::fs::remove_dir_all(bench.root().join("reports")).unwrap();
    assert_eq!(computed(&bench, &[]), set(&[]));
    assert_eq!(bench.snapshot("reports"), before);
}

#[test]
fn every_damaged_object_heals_to_the_same_bytes() {
    let bench = Bench::small();
    computed(&bench, &[]);
    let reports = bench.snapshot("reports");
    let objects = files(&bench.root().join("derived/cache/objects"));
    assert!(objects.len() > 20);
    for (k, object) in objects.iter().enumerate() {
        let mut bytes = std::fs::read(object).unwrap();
        match k % 3 {
            0 => std::fs::remove_file(object).unwrap(),
            1 => std::fs::write(object, &bytes[..bytes.len() / 2]).unwrap(),
            _ => {
                let middle = bytes.len() / 2;
                bytes[middle] ^= 1;
                std::fs::write(object, bytes).unwrap();
            }
        }
    }
    std::fs::remove_dir_all(bench.root().join("reports")).unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(bench.snapshot("reports"), reports);
}

#[test]
fn a_removed_session_takes_its_results_with_it() {
    let bench = Bench::small();
    computed(&bench, &[]);
    std::fs::remove_dir_all(bench.raw().join("small/a")).unwrap();
    let ran = computed(&bench, &[]);
    assert_eq!(ran, set(&DOWNSTREAM));
    assert!(bench.table("plateaus").iter().all(|r| r["specimen"] != "a"));
    let mut raw = files(&bench.raw());
    raw.retain(|f| f.to_string_lossy().contains("/a/"));
    assert!(raw.is_empty());
}

#[test]
fn nothing_in_raw_is_ever_written() {
    let bench = Bench::small();
    let before = bench.snapshot("raw");
    computed(&bench, &[]);
    assert_eq!(bench.snapshot("raw"), before);
}
