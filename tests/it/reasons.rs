//! One thing of each kind is changed; the whole printed line is what is expected.

use crate::support::{Bench, files};
use pipeline::base::digest::Digest;
use pipeline::cache::{KeyParts, State, Store};
use pipeline::config::Config;
use pipeline::run::cache::STATE;

const FIT: &str = "fit/small 10 mm";

/// What `status` says, without its last line, the counts.
fn status(bench: &Bench) -> Vec<String> {
    lines(&bench.run(&["status"]).out)
}

fn lines(out: &str) -> Vec<String> {
    let mut lines: Vec<String> = out.lines().map(ToOwned::to_owned).collect();
    lines.pop();
    lines
}

fn configure(bench: &Bench, text: &str) {
    std::fs::write(bench.root().join("pipeline.toml"), text).unwrap();
}

/// The path of an output of a unit in the cache.
fn object(bench: &Bench, unit: &str, output: &str) -> std::path::PathBuf {
    let store = Store::new(&bench.root().join("derived/cache"));
    let state: State = store.read_aside(STATE);
    store.object_path(&state[unit].outputs[output].digest)
}

/// Makes the cache look as if the last run had computed the fit from other parts; the version among them.
fn pretend(bench: &Bench, change: fn(&mut KeyParts)) -> u32 {
    let store = Store::new(&bench.root().join("derived/cache"));
    let mut state: State = store.read_aside(STATE);
    let left = state.get_mut(FIT).unwrap();
    let mut entry = store.recorded(&left.key).unwrap();
    store.forget(&left.key);
    change(&mut entry.parts);
    left.key = entry.parts.key();
    store.put_entry(&entry).unwrap();
    store.write_aside(STATE, &state).unwrap();
    entry.parts.version
}

const AFTER_FIT: [&str; 4] = [
    "compare small 10 mm: waits for fit",
    "report figures of small 10 mm: waits for fit of small 10 mm",
    "report reports: waits for fit of small 10 mm",
    "report tables: waits for fit of small 10 mm",
];

#[test]
fn the_first_run_says_so() {
    let bench = Bench::small();
    let said = status(&bench);
    let first = "waits for normalize of small-a-c00";
    let mut expected = vec![
        format!("fit small 10 mm: {first}"),
        "compare small 10 mm: waits for fit".to_owned(),
        format!("diagnose small 10 mm: {first}"),
        "report reports: waits for session small-a-c00".to_owned(),
        "report tables: waits for session small-a-c00".to_owned(),
    ];
    for session in ["a-c00", "a-c50", "b-c00", "b-c50", "c-c00", "c-c50"] {
        for (stage, why) in [
            ("ingest", "no earlier result"),
            ("clean", "waits for ingest"),
            ("normalize", "waits for clean"),
        ] {
            expected.push(format!("{stage} small-{session}: {why}"));
        }
    }
    for line in expected {
        assert!(said.contains(&line), "{line} is not in {said:#?}");
    }
    let place = |stage: &str| said.iter().position(|l| l.starts_with(stage));
    assert!(
        pipeline::run::STAGES
            .windows(2)
            .all(|pair| place(pair[0]) <= place(pair[1]) || place(pair[1]).is_none())
    );
}

#[test]
fn a_changed_log_names_the_file_and_both_digests() {
    let bench = Bench::small_done();
    let log = bench.raw().join("small/b/c50/test8.csv");
    let before = std::fs::read(&log).unwrap();
    let mut after = before.clone();
    after.extend(b"\n");
    std::fs::write(&log, &after).unwrap();
    let [old, new] = [before, after].map(|b| Digest::of(&b).short().to_owned());
    let line = format!("ingest small-b-c50: input changed: test8.csv {old} -> {new}");
    assert_eq!(status(&bench)[0], line);
    std::fs::remove_file(&log).unwrap();
    let said = status(&bench);
    let missing = format!("ingest small-b-c50: input changed: test8.csv {old} -> ");
    assert!(said[0].starts_with(&missing), "{said:#?}");
}

#[test]
fn a_changed_option_is_named_with_both_values() {
    let bench = Bench::small_done();
    let usual = Config::default();
    let draws = usual.diagnose.draws;
    let draws = format!("diagnose small 10 mm: option diagnose.draws {draws} -> 49");
    configure(&bench, "[diagnose]\ndraws = 49\n");
    let said = status(&bench);
    assert_eq!(
        said,
        [
            draws.as_str(),
            "report figures of small 10 mm: waits for diagnose of small 10 mm",
            "report reports: waits for diagnose of small 10 mm",
            "report tables: waits for diagnose of small 10 mm",
        ]
    );
    configure(&bench, "[report]\ntitle = \"Another\"\n");
    let title = format!(
        "option report.title {:?} -> \"Another\"",
        usual.report.title
    );
    assert_eq!(status(&bench), [format!("report reports: {title}")]);
}

#[test]
fn changed_code_and_a_raised_version_are_told_apart() {
    let bench = Bench::small_done();
    pretend(&bench, |parts| parts.code = "sha256:0".to_owned());
    let said = status(&bench);
    assert_eq!(said[0], "fit small 10 mm: code of the stage changed");
    assert_eq!(said[1..], AFTER_FIT);
    let raised = pretend(&bench, |parts| parts.version += 1);
    let said = status(&bench);
    let versions = format!("version of the stage {raised} -> {}", raised - 1);
    assert_eq!(
        said[0],
        format!("fit small 10 mm: {versions}; code of the stage changed")
    );
}

#[test]
fn a_lost_and_a_damaged_output_are_told_apart() {
    let bench = Bench::small_done();
    let readings = object(&bench, "clean/small-a-c00", "readings.parquet");
    let mut bytes = std::fs::read(&readings).unwrap();
    bytes[20] ^= 1;
    std::fs::write(&readings, &bytes).unwrap();
    let waits = "normalize small-a-c00: waits for clean";
    let line =
        |why: &str| format!("clean small-a-c00: cache entry damaged: readings.parquet {why}");
    let said = status(&bench);
    assert_eq!(
        said[..2],
        [line("does not agree with its digest"), waits.to_owned()]
    );
    std::fs::write(&readings, &bytes[..9]).unwrap();
    assert_eq!(status(&bench)[0], line("has another size"));
    std::fs::remove_file(&readings).unwrap();
    assert_eq!(status(&bench)[0], line("is missing"));
}

#[test]
fn a_lost_and_a_damaged_entry_are_told_apart() {
    let bench = Bench::small_done();
    let store = Store::new(&bench.root().join("derived/cache"));
    let state: State = store.read_aside(STATE);
    let key = &state[FIT].key;
    let is_entry = |f: &std::path::PathBuf| f.to_string_lossy().contains(&key.hex()[2..]);
    let entry = files(&store.root().join("entries"))
        .into_iter()
        .find(is_entry)
        .unwrap();
    let bytes = std::fs::read(&entry).unwrap();
    std::fs::write(&entry, &bytes[..bytes.len() - 2]).unwrap();
    let unreadable = format!("cache entry damaged: entry {} is not readable", key.short());
    assert_eq!(status(&bench)[0], format!("fit small 10 mm: {unreadable}"));
    std::fs::remove_file(&entry).unwrap();
    let line = "fit small 10 mm: cache entry damaged: the entry is missing";
    assert_eq!(status(&bench)[0], line);
}

#[test]
fn a_removed_and_an_added_session_are_named() {
    let bench = Bench::small_done();
    let (from, to) = (bench.raw().join("small/a/c00"), bench.root().join("aside"));
    std::fs::rename(&from, &to).unwrap();
    let said = status(&bench);
    assert_eq!(said[0], "fit small 10 mm: input removed: small-a-c00");
    assert_eq!(bench.run(&["run"]).code, 0);
    std::fs::rename(&to, &from).unwrap();
    // The three stages of the session are still in the cache, and so is the fit of all.
    let said = status(&bench);
    assert!(
        said.iter().all(|l| ["reports/", "derived/", "and "]
            .iter()
            .any(|start| l.starts_with(start))),
        "{said:#?}"
    );
}

#[test]
fn a_forced_stage_and_a_lost_file_say_so() {
    let bench = Bench::small_done();
    let said = lines(&bench.run(&["run", "--dry-run", "--force", "fit"]).out);
    assert_eq!(said[0], "fit small 10 mm: requested with --force");
    assert_eq!(said[1..], AFTER_FIT);
    std::fs::remove_file(bench.root().join("reports/force.pdf")).unwrap();
    assert_eq!(status(&bench), ["reports/force.pdf: missing"]);
    std::fs::write(bench.root().join("reports/force.pdf"), "mine").unwrap();
    assert_eq!(status(&bench), ["reports/force.pdf: changed since the run"]);
}
