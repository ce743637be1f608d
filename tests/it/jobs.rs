//! The work of a run as jobs of several processes on one cache, by hand and by Snakemake.

use crate::support::{Bench, FAST, files};
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// The quick campaign, and torque of a leg.
fn bench() -> Bench {
    let bench = Bench::quick();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("raw/simulated-knee");
    for file in files(&shipped) {
        let relative = file.strip_prefix(&shipped).unwrap().display().to_string();
        let place = format!("a leg's \"torque\"/{relative}");
        bench.write(&place, std::fs::read(&file).unwrap());
    }
    bench.age();
    bench
}

fn tasks(bench: &Bench) -> Vec<Value> {
    let said = bench.run(&["export", "snakemake", "--json", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    let plan: Value = serde_json::from_str(&said.out).unwrap();
    plan["tasks"].as_array().unwrap().clone()
}

fn start(bench: &Bench, task: &Value) -> Child {
    Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .args(["run", "--jobs", "1", "--config", FAST, "--only"])
        .arg(task["only"].as_str().unwrap())
        .current_dir(bench.root())
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// Results of a whole run; cache and results are taken away again.
fn of_one_run(bench: &Bench) -> std::collections::BTreeMap<String, Vec<u8>> {
    assert_eq!(bench.run(&["run", "--config", FAST]).code, 0);
    let results = bench.results();
    for folder in ["derived", "reports"] {
        std::fs::remove_dir_all(bench.root().join(folder)).unwrap();
    }
    results
}

fn computed(said: &str) -> Vec<String> {
    let outcome: Value = serde_json::from_str(said).unwrap();
    let work = outcome["computed"].as_array().unwrap();
    work.iter()
        .map(|w| {
            format!(
                "{} {}",
                w["stage"].as_str().unwrap(),
                w["unit"].as_str().unwrap()
            )
        })
        .collect()
}

#[test]
fn a_job_computes_what_it_needs_and_keeps_the_last_run_in_mind() {
    let bench = Bench::quick();
    let job = ["run", "--json", "--config", FAST, "--only"];
    let only = |name: &str| bench.run(&[&job[..], &[name]].concat());
    let compare = computed(&only("compare:small 10 mm").out);
    assert_eq!(compare.len(), 6 * 3 + 2, "{compare:?}");
    assert!(compare.contains(&"fit small 10 mm".to_owned()));
    assert!(computed(&only("fit:small 10 mm").out).is_empty());
    assert!(
        bench.run(&["graph"]).err.contains("nothing has been run"),
        "a job is no run"
    );
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    let before = bench.run(&["graph", "--units"]).out;
    assert!(computed(&only("fit:small 10 mm").out).is_empty());
    assert_eq!(bench.run(&["graph", "--units"]).out, before);
    let said = only("fit:smal 10 mm");
    assert_eq!(said.code, 2);
    assert!(
        said.err.contains("did you mean \"fit:small 10 mm\"?"),
        "{}",
        said.err
    );
}

#[test]
fn a_session_of_which_nothing_can_be_used_does_not_fail_its_job() {
    let bench = Bench::quick();
    bench.write("small/small-a/c00/test8.csv", "");
    let task = tasks(&bench).remove(0);
    assert!(start(&bench, &task).wait().unwrap().success(), "{task}");
}

#[test]
fn paths_that_snakemake_cannot_have_are_refused() {
    let bench = Bench::quick();
    let said = bench.run(&["export", "snakemake", "--derived", "{unit}"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("--derived"), "{}", said.err);
}

/// With programs that are no part of a Rust machine: run by `.ci/run`, which installs them.
#[cfg(unix)]
mod outside {
    use super::*;
    use crate::support::outside_program;
    use std::os::unix::fs::PermissionsExt;

    /// Stands for the program; the first diagnosis is killed while it works.
    const KILLING: &str = r#"#!/bin/sh
case "$*" in
  *diagnose:*)
    if [ ! -e killed ]; then
      touch killed
      "$PIPELINE" "$@" & sleep 0.05; kill -9 $!; wait $!; exit
    fi;;
esac
exec "$PIPELINE" "$@"
"#;

    #[test]
    #[ignore = "needs Snakemake"]
    fn snakemake_gives_what_one_run_gives_though_a_job_is_killed() {
        let snakemake = outside_program("SNAKEMAKE", "snakemake", &["--version"]);
        let bench = bench();
        let right = of_one_run(&bench);
        let workflow = bench.run(&["export", "snakemake", "--config", FAST]);
        std::fs::write(bench.root().join("Snakefile"), &workflow.out).unwrap();
        let program = bench.root().join("killing");
        std::fs::write(&program, KILLING).unwrap();
        std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
        let run = || {
            let output = Command::new(&snakemake)
                .args(["--cores", "2", "--config", "pipeline=./killing"])
                .env("PIPELINE", env!("CARGO_BIN_EXE_pipeline"))
                .current_dir(bench.root())
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            (output.status.success(), said)
        };
        let (success, said) = run();
        assert!(!success && bench.root().join("killed").exists(), "{said}");
        assert!(!bench.root().join("reports").exists(), "{said}");
        let (success, said) = run();
        assert!(success, "{said}");
        assert!(
            bench.results() == right,
            "other results than those of one run"
        );
        let (success, said) = run();
        assert!(success && said.contains("Nothing to be done"), "{said}");
    }
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;

    #[test]
    #[ignore = "long: 15 s of processor time"]
    fn jobs_side_by_side_leave_a_run_the_report_alone() {
        let bench = bench();
        let right = of_one_run(&bench);
        let tasks = tasks(&bench);
        let stages = |stage: &str| tasks.iter().filter(|t| t["stage"] == stage).count();
        assert_eq!(
            ["normalize", "fit", "compare", "diagnose", "torque"].map(stages),
            [6 + 10, 1, 1, 1, 2]
        );
        // All jobs of a stage at once, each of them twice, one killed in the middle of it.
        // In the order in which they need each other, whatever stages there are.
        let mut order: Vec<&str> = tasks.iter().filter_map(|t| t["stage"].as_str()).collect();
        order.dedup();
        order.retain(|stage| *stage != "report");
        for stage in order {
            let of_stage = tasks.iter().filter(|t| t["stage"] == stage);
            let mut children: Vec<Child> = of_stage
                .flat_map(|task| [start(&bench, task), start(&bench, task)])
                .collect();
            std::thread::sleep(Duration::from_millis(20));
            children[0].kill().unwrap();
            children[0].wait().unwrap();
            for child in &mut children[1..] {
                assert!(child.wait().unwrap().success());
            }
        }
        assert!(
            !bench.root().join("reports").exists(),
            "jobs fill the cache only"
        );
        let said = bench.run(&["run", "--json", "--config", FAST]);
        let left = computed(&said.out);
        assert!(left.contains(&"report reports".to_owned()), "{left:?}");
        let drawn = |unit: &String| unit.starts_with("report ");
        assert!(left.iter().all(drawn), "{left:?}");
        assert!(
            bench.results() == right,
            "other results than those of one run"
        );
        assert_eq!(bench.run(&["status", "--config", FAST]).code, 0);
    }
}
