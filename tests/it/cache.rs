//! "Run, change one thing, assert what ran again."

use crate::support::{Bench, files};
use std::collections::{BTreeMap, BTreeSet};

type Files = BTreeMap<String, Vec<u8>>;

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

/// The files of which only one of two looks knows, or which changed in between.
fn differing(before: &Files, after: &Files) -> Vec<String> {
    let all: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
    let changed = all.into_iter().filter(|f| before.get(*f) != after.get(*f));
    changed.cloned().collect()
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
    let sessions = ["a-c00", "a-c50", "b-c00", "b-c50", "c-c00", "c-c50"];
    let stages = ["ingest", "clean", "normalize"];
    let of_sessions = sessions
        .iter()
        .flat_map(|id| stages.map(|s| format!("{s} small-{id}")));
    let everything: BTreeSet<String> = of_sessions.chain(set(&DOWNSTREAM)).collect();
    assert_eq!(computed(&bench, &[]), everything);
    let before = bench.snapshot("");
    let outcome = bench.outcome(&["run"]);
    assert_eq!(outcome["computed"], serde_json::json!([]));
    assert_eq!(outcome["files_written"], serde_json::json!([]));
    assert_eq!(outcome["up_to_date"], everything.len());
    let written = differing(&before, &bench.snapshot(""));
    assert!(
        written.iter().all(|f| f.starts_with("derived/cache/")),
        "{written:?}"
    );
    assert!(bench.run(&["run"]).out.starts_with("nothing to do"));
    assert_eq!(bench.run(&["status"]).code, 0);
}

#[test]
fn a_changed_byte_in_one_log_redoes_that_session_and_what_depends_on_it() {
    let bench = Bench::small_done();
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
    let bench = Bench::small_done();
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
    let bench = Bench::small_done();
    let config = bench.root().join("pipeline.toml");
    std::fs::write(&config, "[report]\ntitle = \"Another\"\n").unwrap();
    assert_eq!(computed(&bench, &[]), set(&["report reports"]));
    let diagnose = "[report]\ntitle = \"Another\"\n[diagnose]\ndraws = 49\n";
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
    let bench = Bench::small_done();
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
    let bench = Bench::small_done();
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
    let bench = Bench::small_done();
    let before = bench.snapshot("reports");
    std::fs::remove_dir_all(bench.root().join("reports")).unwrap();
    assert_eq!(computed(&bench, &[]), set(&[]));
    assert_eq!(bench.snapshot("reports"), before);
}

#[test]
fn every_damaged_object_heals_to_the_same_bytes() {
    let bench = Bench::small_done();
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
    let bench = Bench::small_done();
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
    let (before, after) = (Bench::small(), Bench::small_done());
    assert_eq!(after.snapshot("raw"), before.snapshot("raw"));
}
