//! What a run leaves when it is killed, and what the next one makes of it.

use crate::support::{Bench, FAST, files};
use pipeline::base::random::Stream;
use std::time::{Duration, Instant};

/// Runs that are killed.
const KILLED: usize = 200;

const RUN: [&str; 3] = ["run", "--config", FAST];

/// Removes a folder, which a killed run may not even have made.
fn remove(bench: &Bench, folder: &str) {
    let path = bench.root().join(folder);
    if path.exists() {
        std::fs::remove_dir_all(path).unwrap();
    }
}

#[test]
fn two_runs_at_once_take_turns_and_agree() {
    let bench = Bench::quick_done();
    let right = bench.results();
    std::fs::remove_dir_all(bench.root().join("derived")).unwrap();
    let mut first = bench.start(&RUN);
    while !bench.root().join("derived/cache/lock").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let second = bench.run(&["run", "--config", FAST, "--json"]);
    assert!(first.wait().unwrap().success());
    assert_eq!(second.code, 0, "{}", second.err);
    assert!(
        second
            .err
            .contains("another run is working on this directory"),
        "{}",
        second.err
    );
    let outcome: serde_json::Value = serde_json::from_str(&second.out).unwrap();
    assert_eq!(outcome["computed"], serde_json::json!([]));
    assert_eq!(bench.results(), right);
}

#[test]
fn a_place_that_cannot_be_written_is_said_and_the_next_run_goes_on() {
    let bench = Bench::quick_done();
    let right = bench.results();
    let tables = bench.root().join("reports/tables");
    std::fs::remove_dir_all(&tables).unwrap();
    // A file where a folder should be fails for everybody, root included.
    std::fs::write(&tables, b"in the way").unwrap();
    let said = bench.run(&RUN);
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("reports/tables"), "{}", said.err);
    std::fs::remove_file(&tables).unwrap();
    assert!(bench.start(&RUN).wait().unwrap().success());
    assert_eq!(bench.results(), right);
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;

    #[test]
    #[ignore = "long: 220 runs, 200 of them killed"]
    fn two_hundred_killed_runs_leave_nothing_that_the_next_does_not_mend() {
        let bench = Bench::quick();
        let began = Instant::now();
        assert!(bench.start(&RUN).wait().unwrap().success());
        let whole = began.elapsed();
        let right = bench.results();
        let mut stream = Stream::new(1, &["kill"]);
        let mut cut = 0;
        for k in 0..KILLED {
            // From nothing, from half a cache, or with one stage to do: killed at any moment of it.
            match k % 4 {
                0 => remove(&bench, "derived"),
                1 => {
                    for (n, object) in files(&bench.root().join("derived/cache"))
                        .iter()
                        .enumerate()
                    {
                        if n % 2 == 0 && !object.ends_with("lock") {
                            std::fs::remove_file(object).unwrap();
                        }
                    }
                }
                2 => remove(&bench, "reports"),
                _ => {}
            }
            let mut child = bench.start(&RUN);
            std::thread::sleep(whole.mul_f64(stream.uniform()));
            cut += usize::from(child.try_wait().unwrap().is_none());
            let _ = child.kill();
            child.wait().unwrap();
            // Whatever stands where people look is whole: old or new, never a part.
            let begun =
                |name: &String| name.contains("/.writing-") || name.starts_with(".writing-");
            for (name, bytes) in bench.results().into_iter().filter(|(n, _)| !begun(n)) {
                assert!(right.get(&name) == Some(&bytes), "after kill {k}: {name}");
            }
            if k % 10 == 9 {
                assert!(bench.start(&RUN).wait().unwrap().success());
                assert_eq!(bench.results(), right, "after kill {k}");
            }
        }
        assert!(cut > KILLED / 4, "only {cut} runs were cut short");
        let said = bench.run(&["status", "--config", FAST]);
        assert_eq!(said.code, 0, "{}", said.out);
    }
}
