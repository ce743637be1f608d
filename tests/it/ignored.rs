//! What the README's test command shows as ignored is run by `.ci/run` all the same, or is known not to be reached. The module says which
//! (CONTRIBUTING.md).

use std::process::Command;

/// Kinds of ignored tests that `.ci/run` runs, and the one that nobody runs.
const RUN: [&str; 6] = ["browser", "latex", "long", "octave", "outside", "rig"];
const NOT_RUN: &str = "not_reached";

/// Names of the tests of this binary.
fn tests(which: &[&str]) -> Vec<String> {
    let own = std::env::current_exe().unwrap();
    let output = Command::new(own).arg("--list").args(which).output();
    let list = String::from_utf8(output.unwrap().stdout).unwrap();
    let names = list.lines().filter_map(|l| l.strip_suffix(": test"));
    names.map(str::to_owned).collect()
}

fn is_of_a_kind(test: &str) -> bool {
    let mut modules = test.split("::");
    modules.any(|m| RUN.contains(&m) || m == NOT_RUN)
}

#[test]
fn a_test_is_ignored_if_its_module_says_why_and_only_then() {
    let ignored = tests(&["--ignored"]);
    assert!(!ignored.is_empty());
    let mut of_a_kind = tests(&[]);
    of_a_kind.retain(|test| is_of_a_kind(test));
    assert_eq!(ignored, of_a_kind);
}

#[test]
fn every_kind_of_ignored_tests_is_run_by_ci_but_what_is_not_reached() {
    let ci = include_str!("../../.ci/run");
    let lines = ci.lines().map(str::trim_start);
    let run: Vec<&str> = lines.filter(|l| l.starts_with("ignored ")).collect();
    for kind in RUN.map(|kind| format!("{kind}::")) {
        let is_run = run.iter().any(|line| line.split(' ').any(|k| k == kind));
        assert!(is_run, "{kind}");
    }
    assert!(!ci.contains(NOT_RUN));
}
