//! Everything below `derived/` damaged, one file at a time; disks that are full or read-only; inputs that are edited while they are read.

use crate::support::{Bench, FAST, Said, files};
use pipeline::base::digest::{Digest, Outputs};
use pipeline::base::error::Error;
use pipeline::base::random::Stream;
use pipeline::run::engine::Engine;
use pipeline::run::step::{Stage, Step};
use pipeline::run::{RunOptions, Silent};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const RUN: [&str; 3] = ["run", "--config", FAST];

fn runs(bench: &Bench) -> Said {
    let said = bench.run(&RUN);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    said
}

/// What is done to a file, and how.
type Damage = (&'static str, fn(&Path));

fn flip(file: &Path) {
    let mut bytes = std::fs::read(file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(file, bytes).unwrap();
}

fn cut(file: &Path) {
    let bytes = std::fs::read(file).unwrap();
    std::fs::write(file, &bytes[..bytes.len() / 2]).unwrap();
}

fn remove(file: &Path) {
    std::fs::remove_file(file).unwrap();
}

/// The small files of the cache and one of every other kind, in each of the three ways.
#[test]
fn a_file_of_each_kind_is_mended_however_it_is_damaged() {
    let bench = Bench::quick_done();
    let right = bench.results();
    let first = |folder: &str| {
        files(&bench.root().join(folder))
            .into_iter()
            .next()
            .unwrap()
    };
    let small = ["state", "hashes", "messages", "materialized"];
    let small = small.map(|n| bench.root().join(format!("derived/cache/{n}.jsonl")));
    let others = [
        "derived/cache/entries",
        "derived/cache/objects",
        "derived/sessions",
        "reports/tables",
    ];
    for file in small.into_iter().chain(others.map(first)) {
        for damage in [flip, cut, remove] {
            damage(&file);
            let said = runs(&bench);
            assert_eq!(bench.results(), right, "{}: {}", file.display(), said.out);
        }
    }
    assert_eq!(bench.outcome(&RUN)["computed"], serde_json::json!([]));
}

/// A file may not grow beyond some blocks: every write of more fails as on a full disk, wherever the run is.
#[cfg(unix)]
#[test]
fn a_full_disk_is_said_and_the_next_run_goes_on() {
    let right = Bench::quick_done().results();
    let bench = Bench::quick();
    let mut stopped = 0;
    for blocks in [0, 1, 4, 16, 64, 256] {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        // A pipe has no size: what the program says still comes through.
        let output = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_pipeline")])
            .args(RUN)
            .current_dir(bench.root())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        if output.status.success() {
            continue;
        }
        stopped += 1;
        assert_eq!(output.status.code(), Some(2), "{blocks} blocks: {said}");
        assert!(
            said.starts_with("error: cannot write"),
            "{blocks} blocks: {said}"
        );
        for (name, bytes) in bench
            .results()
            .into_iter()
            .filter(|(n, _)| !n.contains(".writing-"))
        {
            assert!(right.get(&name) == Some(&bytes), "{blocks} blocks: {name}");
        }
    }
    assert!(stopped >= 3, "only {stopped} runs found the disk full");
    runs(&bench);
    assert_eq!(bench.results(), right);
}

/// A place that belongs to somebody else.
#[cfg(unix)]
#[test]
fn a_read_only_place_is_said_and_left_as_it_is() {
    let bench = Bench::quick_done();
    remove(&bench.root().join("reports/force.pdf"));
    let folders = ["", "reports", "derived", "derived/cache"];
    folders.iter().for_each(|f| bench.set_mode(f, 0o555));
    let said = bench.run_unprivileged(&RUN);
    folders.iter().for_each(|f| bench.set_mode(f, 0o755));
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(
        said.err.starts_with("error: cannot open the lock"),
        "{}",
        said.err
    );
    let outcome = bench.outcome(&RUN);
    assert_eq!(
        outcome["files_written"],
        serde_json::json!(["reports/force.pdf"])
    );
}

/// As after `cp -p` or with a clock that was set back: other contents, the same size and time of change.
#[cfg(unix)]
#[test]
fn other_contents_of_the_same_size_and_time_are_seen() {
    let bench = Bench::quick_done();
    let log = bench.raw().join("small/b/c50/test8.csv");
    let (size, time) = {
        let metadata = std::fs::metadata(&log).unwrap();
        (metadata.len(), metadata.modified().unwrap())
    };
    flip_digit(&log);
    let open = std::fs::File::options().write(true).open(&log).unwrap();
    open.set_modified(time).unwrap();
    assert_eq!(std::fs::metadata(&log).unwrap().len(), size);
    let said = bench.run(&["status", "--config", FAST]);
    let line = "ingest small-b-c50: input changed: test8.csv";
    assert!(said.out.contains(line), "{}", said.out);
}

fn flip_digit(log: &Path) {
    let mut bytes = std::fs::read(log).unwrap();
    let digit = bytes.iter().position(|b| (b'1'..=b'8').contains(b));
    bytes[digit.unwrap()] += 1;
    std::fs::write(log, bytes).unwrap();
}

/// A defect of the program in the work on one unit: named, and of no consequence for the next unit of a run that keeps going.
#[test]
fn a_panic_in_one_unit_is_named_and_stops_only_a_run_that_does_not_keep_going() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage {
        name: "clean",
        version: 1,
        code: "",
    };
    let readings: Vec<f64> = Vec::new();
    let try_both = |keep_going: bool| {
        let options = RunOptions {
            keep_going,
            ..RunOptions::below(folder.path())
        };
        let engine = Engine::open(&options, None, &Silent).unwrap();
        let broken = || Ok(Outputs::from([("x".to_owned(), vec![readings[3] as u8])]));
        let broken = engine.step(stage, "iso10", BTreeMap::new(), BTreeMap::new(), broken);
        let whole = || Ok(Outputs::from([("x".to_owned(), b"y".to_vec())]));
        let inputs = BTreeMap::from([("log".to_owned(), Digest::of(b"log"))]);
        let whole = engine.step(stage, "iso20", BTreeMap::new(), inputs, whole);
        assert!(whole.unwrap().entry().is_some());
        let failed = engine.take_work().unwrap().2;
        (broken, failed)
    };
    let why = "clean of iso10: index out of bounds: the len is 0 but the index is 3";
    let (stops, failed) = try_both(false);
    assert!(matches!(stops, Err(Error::Internal(w)) if w == why));
    assert!(failed.is_empty());
    let (goes_on, failed) = try_both(true);
    assert!(matches!(goes_on, Ok(Step::Pending)));
    assert_eq!(failed.len(), 1);
    assert_eq!(
        (failed[0].unit.as_str(), failed[0].why.as_str()),
        ("iso10", why)
    );
}

#[test]
fn a_run_that_is_to_stay_offline_refuses_an_address() {
    let bench = Bench::quick();
    let said = bench.run(&["run", "--offline-only", "--raw", "https://lab.example/raw"]);
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(
        said.err.contains("https://lab.example/raw is on a network"),
        "{}",
        said.err
    );
    let said = bench.run(&["run", "--config", FAST, "--offline-only", "--keep-going"]);
    assert_eq!(said.code, 0, "{}", said.err);
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;

    /// A log that is edited while the program reads it: whatever that run made of it, the next one gives what the log then says.
    #[test]
    #[ignore = "long: 47 s of processor time"]
    fn a_log_that_is_edited_during_a_run_poisons_nothing() {
        let bench = Bench::quick();
        let began = Instant::now();
        runs(&bench);
        let whole = began.elapsed();
        let log = bench.raw().join("small/b/c50/test8.csv");
        let mut stream = Stream::new(1, &["edited"]);
        for _ in 0..12 {
            std::fs::remove_dir_all(bench.root().join("derived")).unwrap();
            // Which figures there are depends on what is found; without derived/ nobody knows those of an earlier log.
            let reports = bench.root().join("reports");
            if reports.exists() {
                std::fs::remove_dir_all(&reports).unwrap();
            }
            let mut child = bench.start(&RUN);
            std::thread::sleep(whole.mul_f64(0.3 * stream.uniform()));
            let mut bytes = std::fs::read(&log).unwrap();
            let digits = (0..bytes.len()).filter(|k| bytes[*k].is_ascii_digit());
            let digits: Vec<usize> = digits.collect();
            let at = digits[(stream.uniform() * digits.len() as f64) as usize];
            bytes[at] = b'0' + (bytes[at] - b'0' + 1) % 10;
            std::fs::write(&log, &bytes).unwrap();
            child.wait().unwrap();
        }
        std::thread::sleep(Duration::from_millis(10));
        runs(&bench);
        let fresh = Bench::quick();
        std::fs::write(
            fresh.raw().join("small/b/c50/test8.csv"),
            std::fs::read(&log).unwrap(),
        )
        .unwrap();
        runs(&fresh);
        assert_eq!(bench.results(), fresh.results());
    }

    /// Damages every file below `derived/`, some at a time and each in one of three ways; the next run has to mend them.
    #[test]
    #[ignore = "long: 16 s of processor time"]
    fn every_damaged_file_below_derived_is_mended_by_the_next_run() {
        const AT_ONCE: usize = 32;
        let bench = Bench::quick_done();
        let right = bench.results();
        let objects = bench.snapshot("derived/cache/objects");
        let damages: [Damage; 3] = [("flipped", flip), ("cut", cut), ("removed", remove)];
        let mut all = files(&bench.root().join("derived"));
        all.retain(|f| !f.ends_with("lock"));
        for batch in all.chunks(AT_ONCE) {
            let mut done = Vec::new();
            for (k, file) in batch.iter().enumerate() {
                let (how, damage) = damages[k % 3];
                damage(file);
                done.push(format!("{} {how}", file.display()));
            }
            let said = runs(&bench);
            assert_eq!(bench.results(), right, "{done:#?}: {}", said.out);
            let mended = bench.snapshot("derived/cache/objects");
            assert_eq!(mended, objects, "{done:#?}: {}", said.out);
        }
    }
}
