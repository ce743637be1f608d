//! A look at a log that nobody has described: the guess, the files, and a run with what it wrote.

use crate::formats::fixture;
use crate::support::Bench;
use serde_json::Value;

/// The lines that a person fills in, for the simulated specimen of the small campaign.
fn corrected(session: &str) -> String {
    session
        .lines()
        .map(|line| match line.split(" = ").next() {
            Some("rest_length_mm") => "rest_length_mm = 112".to_owned(),
            Some("contracted_length_mm") => "contracted_length_mm = 94.08".to_owned(),
            Some("length_mm") => "length_mm = 112".to_owned(),
            _ => line.replace("FILL IN", ""),
        })
        .collect::<Vec<String>>()
        .join("\n")
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn what_it_writes_is_read_back_and_once_corrected_runs() {
    let bench = Bench::small();
    let before = bench.snapshot("raw");
    let log = before
        .keys()
        .find(|f| f.ends_with("test8.csv"))
        .expect("a log")
        .clone();
    let said = bench.run(&[
        "new-session",
        &format!("raw/{log}"),
        "--out",
        "look",
        "--json",
    ]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(
        bench.snapshot("raw"),
        before,
        "nothing below raw/ is written"
    );
    let said = json(&said.out);
    assert_eq!(
        (said["sampling"].as_str(), said["rows"].as_u64()),
        (Some("timeseries"), Some(4000))
    );
    let quantities: Vec<&str> = said["columns"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|c| c["quantity"].as_str())
        .collect();
    assert_eq!(quantities, ["force", "pressure", "time", "phase"]);
    let look = bench.snapshot("look");
    assert!(look["log.svg"].starts_with(b"<") && look["log.png"].starts_with(b"\x89PNG"));
    let session = String::from_utf8(look["session.toml"].clone()).unwrap();
    let run = Bench::empty();
    run.write("new/session.toml", &session);
    run.write("new/test8.csv", &before[&log]);
    let said = run.run(&["run"]);
    assert_eq!(said.code, 2, "what is still to be filled in keeps the session out");
    for (k, line) in session.lines().enumerate().filter(|(_, l)| l.contains("FILL IN")) {
        let place = format!("new/session.toml:{}", k + 1);
        assert!(said.err.contains(&place), "{place}: {line}: {}", said.err);
    }
    run.write("new/session.toml", corrected(&session));
    let said = run.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(run.table("plateaus").len() > 10, "{}", said.err);
}

#[test]
fn nothing_is_overwritten_without_force() {
    let bench = Bench::empty();
    bench.write("points.csv", fixture("points.csv"));
    let look = ["new-session", "raw/points.csv"];
    assert_eq!(bench.run(&look).code, 0);
    let session = bench.root().join("points/session.toml");
    std::fs::write(&session, "mine").unwrap();
    let said = bench.run(&look);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("--force"), "{}", said.err);
    assert_eq!(std::fs::read_to_string(&session).unwrap(), "mine");
    assert_eq!(
        bench
            .run(&["new-session", "raw/points.csv", "--force"])
            .code,
        0
    );
}

#[test]
fn every_format_gives_the_same_guess() {
    let bench = Bench::empty();
    let guess = |file: &str, part: &[&str]| {
        bench.write(file, fixture(file));
        let path = format!("raw/{file}");
        let arguments = [&["new-session", &path, "--out", file, "--json"], part].concat();
        let said = bench.run(&arguments);
        assert_eq!(said.code, 0, "{file}: {}", said.err);
        json(&said.out)["columns"].clone()
    };
    let reference = guess("points.csv", &[]);
    let units: Vec<&str> = reference
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|c| c["unit"].as_str())
        .collect();
    assert_eq!(units, ["mm", "kPa", "N"]);
    for (file, part) in [
        ("semicolon.csv.gz", &[][..]),
        ("tab.txt", &[]),
        ("workbook.xlsx", &["--sheet", "Run 8"]),
        ("vectors.mat", &[]),
        ("structure.mat", &["--variable", "log"]),
        ("frame.parquet", &[]),
    ] {
        assert_eq!(guess(file, part), reference, "{file}");
    }
}

#[test]
fn a_file_that_is_no_log_is_refused_with_what_to_do() {
    let bench = Bench::empty();
    bench.write("log", [0xfe_u8; 100]);
    let said = bench.run(&["new-session", "raw/log"]);
    assert_eq!(said.code, 2);
    assert!(
        said.err.contains("expected") && !bench.root().join("log").exists(),
        "{}",
        said.err
    );
}
