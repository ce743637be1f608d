//! The commands as a user sees them: help, exit codes, messages.

use crate::support::Bench;
use std::path::Path;

#[test]
fn every_command_has_help_with_an_example() {
    let bench = Bench::empty();
    for command in [
        &["--help"][..],
        &["run", "--help"],
        &["status", "--help"],
        &["check", "--help"],
        &["init", "--help"],
        &["summary", "--help"],
        &["predict", "--help"],
        &["simulate", "--help"],
        &["new-session", "--help"],
        &["config", "--help"],
        &["export", "--help"],
        &["completions", "--help"],
        &["man", "--help"],
    ] {
        let said = bench.run(command);
        assert_eq!(said.code, 0, "{command:?}");
        assert!(said.out.contains("Example"), "{command:?}\n{}", said.out);
    }
}

#[test]
fn usage_mistakes_exit_with_2_and_say_what_to_do() {
    let bench = Bench::empty();
    for (arguments, says) in [
        (&["rum"][..], "run"),
        (&["run", "--raw", "nowhere"], "--raw DIR"),
        (&["run"], "no session.toml below raw"),
        (&["run", "--force", "fits"], "fit"),
        (&["run", "--config", "no.toml"], "no.toml"),
        (
            &["simulate", "no-truth.toml", "--out", "x"],
            "no-truth.toml",
        ),
    ] {
        let said = bench.run(arguments);
        assert_eq!(said.code, 2, "{arguments:?}\n{}", said.err);
        assert!(said.err.contains(says), "{arguments:?}\n{}", said.err);
    }
    std::fs::write(bench.root().join("pipeline.toml"), "[claen]\n").unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("did you mean `clean`?"), "{}", said.err);
}

#[test]
fn config_prints_what_can_be_read_back() {
    let bench = Bench::small();
    let said = bench.run(&["config"]);
    assert_eq!(said.code, 0);
    std::fs::write(bench.root().join("pipeline.toml"), &said.out).unwrap();
    assert_eq!(
        bench.run(&["status"]).code,
        1,
        "everything is still to do, so the configuration was read"
    );
}

#[test]
fn a_dry_run_says_what_would_run_and_writes_nothing() {
    let bench = Bench::small();
    let said = bench.run(&["run", "--dry-run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.out.contains("ingest small-a-c00: no earlier result"),
        "{}",
        said.out
    );
    assert!(
        said.out.contains("clean small-a-c00: waits for ingest"),
        "{}",
        said.out
    );
    assert!(!bench.root().join("derived").exists() && !bench.root().join("reports").exists());
}

#[test]
fn json_output_is_json() {
    let bench = Bench::small();
    for arguments in [
        &["status", "--json"][..],
        &["run", "--json"],
        &["status", "--json"],
    ] {
        let said = bench.run(arguments);
        let value: serde_json::Value =
            serde_json::from_str(&said.out).unwrap_or_else(|e| panic!("{e}\n{}", said.out));
        assert!(value.is_object());
    }
}

#[test]
fn simulate_refuses_to_overwrite_and_labels_what_it_writes() {
    let bench = Bench::empty();
    let truth = concat!(env!("CARGO_MANIFEST_DIR"), "/truths/simulated-10mm.toml");
    assert_eq!(bench.run(&["simulate", truth, "--out", "raw/c"]).code, 0);
    let again = bench.run(&["simulate", truth, "--out", "raw/c"]);
    assert_ne!(again.code, 0);
    assert!(
        again.err.contains("--replace") || again.err.contains("replace"),
        "{}",
        again.err
    );
    let session =
        std::fs::read_to_string(bench.raw().join("c/sim10-l83/c00/session.toml")).unwrap();
    assert!(session.contains("notes = \"simulated"));
}

#[test]
fn strict_turns_rejected_sessions_into_exit_code_3() {
    let bench = Bench::small_done();
    bench.write("broken/session.toml", "schema = \"bpa-session/1\"\n");
    assert_eq!(bench.run(&["run"]).code, 0);
    let said = bench.run(&["run", "--strict"]);
    assert_eq!(said.code, 3);
    assert!(
        said.out.contains("left out: 1 of 7 sessions"),
        "{}",
        said.out
    );
    assert!(said.err.contains("broken/session.toml"), "{}", said.err);
}

/// The commands, as the help lists them.
fn commands(bench: &Bench) -> Vec<String> {
    let help = bench.run(&["--help"]).out;
    let list = help.split("Commands:").nth(1).unwrap();
    let lines = list.lines().skip(1).take_while(|l| !l.trim().is_empty());
    let first = |line: &str| line.split_whitespace().next().map(ToOwned::to_owned);
    // Where a line is broken its second half is indented further.
    let own = lines.filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    own.filter_map(first).collect()
}

#[test]
fn completions_manual_pages_and_readme_cover_every_command() {
    let bench = Bench::empty();
    let commands = commands(&bench);
    assert!(commands.len() > 10, "{commands:?}");
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(readme).unwrap();
    for command in commands.iter().filter(|c| *c != "help") {
        assert!(
            readme.contains(&format!("`pipeline {command}")),
            "{command}"
        );
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let said = bench.run(&["completions", shell]);
        assert_eq!(said.code, 0, "{}", said.err);
        for command in &commands {
            assert!(said.out.contains(command.as_str()), "{shell}: {command}");
        }
        assert!(said.out.contains("dry-run"), "{shell}: options too");
    }
    let page = bench.run(&["man"]).out;
    assert_eq!(bench.run(&["man", "--out", "man"]).code, 0);
    for command in commands.iter().filter(|c| *c != "help") {
        assert!(
            page.contains(&format!("pipeline-{command}(1)").replace('-', "\\-")),
            "{command}"
        );
        let own = bench.root().join(format!("man/pipeline-{command}.1"));
        let own = std::fs::read_to_string(own).unwrap();
        assert!(
            own.contains(".SH SYNOPSIS") && own.contains("Example"),
            "{command}"
        );
    }
    assert!(bench.root().join("man/pipeline.1").exists());
}
