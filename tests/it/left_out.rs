//! A figure or document that cannot be built is left out, counted and named, and takes nothing else with it.

use crate::support::{Bench, FAST, Said};
use pipeline::config::Config;
use pipeline::run::{RunOptions, Silent};
use std::collections::{BTreeMap, BTreeSet};

/// The exit code of a run that left a figure or document out.
const LEFT_OUT: i32 = 5;
/// A resolution at which no figure can be drawn; no configuration may ask for it.
const HUGE_DPI: f64 = 1e9;

fn run(bench: &Bench) -> Said {
    bench.run(&["run", "--config", FAST])
}

/// Everything but documents and what was measured of them, figures, the summary and the list of raw files.
fn data(bench: &Bench) -> BTreeMap<String, Vec<u8>> {
    let mut all = bench.results();
    all.retain(|name, _| {
        let of_pages = name.ends_with(".pdf") || name.starts_with("figures/");
        !of_pages && !["summary.json", "provenance.json", "layout.json"].contains(&name.as_str())
    });
    all
}

fn documents(bench: &Bench) -> BTreeSet<String> {
    let names = bench.snapshot("reports").into_keys();
    names
        .filter(|n| n.ends_with(".pdf") && !n.contains('/'))
        .collect()
}

/// Part, name and task of everything that the summary says was left out.
fn summary(bench: &Bench) -> Vec<[String; 3]> {
    let file = bench.root().join("reports/summary.json");
    let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    let entry = |l: &serde_json::Value| {
        ["part", "name", "task"].map(|key| l[key].as_str().unwrap().to_owned())
    };
    let all = summary["left_out"].as_array().unwrap();
    all.iter().map(entry).collect()
}

/// Gives a session a reason of exclusion with a control character, which cannot be typeset.
fn write_what_cannot_be_typeset(bench: &Bench) -> std::path::PathBuf {
    let session = bench.raw().join("small/a/c00/session.toml");
    let text = std::fs::read_to_string(&session).unwrap();
    let with = "exclude = \"slack \\u0007\"\n\n[specimen]";
    std::fs::write(&session, text.replacen("[specimen]", with, 1)).unwrap();
    session
}

#[test]
fn a_document_that_fails_takes_nothing_else_with_it() {
    let bench = Bench::quick_done();
    let (whole, sound) = (documents(&bench), bench.snapshot("reports"));
    assert!(summary(&bench).is_empty());
    let session = bench.raw().join("small/a/c00/session.toml");
    let before = std::fs::read(&session).unwrap();
    write_what_cannot_be_typeset(&bench);
    let said = run(&bench);
    assert_eq!(said.code, LEFT_OUT, "{}{}", said.out, said.err);
    // Both name the sessions that are excluded.
    let failed = ["force.pdf", "supplement.pdf"];
    for line in failed.map(|name| format!("left out: document {name}: ")) {
        assert!(said.err.contains(&line), "{}", said.err);
    }
    assert!(said.err.contains("\n2 documents left out"), "{}", said.err);
    let named = failed.map(|name| ["document", name, "typesetting"].map(str::to_owned));
    assert_eq!(summary(&bench), named);
    let mut others = whole.clone();
    for name in failed {
        assert!(others.remove(name), "the last {name} does not stay");
    }
    assert_eq!(documents(&bench), others);
    assert_eq!(bench.snapshot("reports").len(), sound.len() - 2);
    // The next run has nothing to do and says the same.
    let again = run(&bench);
    assert_eq!((again.code, &again.err), (LEFT_OUT, &said.err));
    assert!(again.out.contains("\nnothing to do"), "{}", again.out);
    std::fs::write(&session, before).unwrap();
    assert_eq!(run(&bench).code, 0);
    assert_eq!(bench.snapshot("reports"), sound);
}

#[test]
fn figures_that_fail_take_nothing_else_with_them() {
    let bench = Bench::quick_done();
    let (whole, sound) = (documents(&bench), data(&bench));
    // SVG, PDF, PNG and CSV of each.
    let figures = bench.snapshot("reports/figures").len() / 4;
    let without = Bench::quick();
    let mut config = Config::load(Some(&without.root().join(FAST))).unwrap();
    config.report.png_dpi = HUGE_DPI;
    let options = RunOptions {
        raw: vec![without.raw()],
        config,
        ..RunOptions::below(without.root())
    };
    let outcome = pipeline::run::run(&options, &Silent).unwrap();
    assert_eq!(outcome.left_out.len(), figures);
    let left_out = summary(&without);
    assert_eq!(left_out.len(), figures);
    let is_conversion = |l: &[String; 3]| l[0] == "figure" && l[2] == "converting";
    assert!(left_out.iter().all(is_conversion), "{left_out:?}");
    assert!(left_out.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(documents(&without), whole);
    assert!(data(&without) == sound, "other tables or findings");
    let again = pipeline::run::run(&options, &Silent).unwrap();
    assert!(again.work.is_empty() && again.left_out == outcome.left_out);
}

#[test]
fn tables_and_findings_are_in_place_before_any_page() {
    let bench = Bench::quick();
    // A folder in the place of the document ends the run when the pages are put in place.
    bench.write("../reports/force.pdf/mine", "");
    let said = run(&bench);
    assert_eq!(said.code, 2, "{}{}", said.out, said.err);
    let made = bench.snapshot("reports");
    for name in [
        "tables/coefficients.csv",
        "findings.json",
        "provenance.json",
    ] {
        assert!(made.contains_key(name), "{name}: {:?}", made.keys());
    }
    assert!(!made.contains_key("summary.json"));
    std::fs::remove_dir_all(bench.root().join("reports/force.pdf")).unwrap();
    assert_eq!(run(&bench).code, 0);
    assert!(bench.results() == Bench::quick_done().results());
}
