//! Columns of words: carried through every stage as labels, and searched where they name groups of sessions.

use crate::support::{Bench, files};
use pipeline::base::frame::{Frame, Values};
use pipeline::simulate;

/// Points of 6 specimens at 4 contractions: 24 sessions.
const TRUTH: &str = r#"
schema = "bpa-truth/1"
campaign = "cells"
seed = 21
date = "2026-01"
diameter_mm = 10
coefficients = "published"
contractions = [0, 0.25, 0.5, 0.75]
runs = [8]
run_speed = [1]
sampling = "points"
pressures_kpa = [100, 200, 300, 400, 500, 620]
"#;
const LENGTHS_MM: [u32; 6] = [83, 112, 182, 257, 382, 455];
/// The second load cell reads this much more.
const GAIN: f64 = 1.06;

/// The campaign with a column `load_cell` of words; every other session was measured with the cell that reads too much.
fn campaign() -> Bench {
    let specimens = LENGTHS_MM.map(|l| {
        format!("[[specimen]]\nid = \"l{l}\"\nrest_length_mm = {l}\ncontraction_max = 0.166\n")
    });
    let truth = simulate::read_truth("cells.toml", &format!("{TRUTH}{}", specimens.concat()))
        .unwrap_or_else(|d| panic!("{d:?}"));
    let bench = Bench::empty();
    let made = simulate::simulate(&truth);
    simulate::write(&made, &bench.raw().join("cells"), None, false).unwrap();
    for (k, session) in made.sessions.iter().enumerate() {
        let number: usize = k % 4 + k / 4;
        let folder = format!("cells/{}", session.folder);
        for (name, bytes) in &session.files {
            let text = String::from_utf8(bytes.clone()).unwrap();
            let text = if name == "session.toml" {
                text.replace(
                    "[columns]\n",
                    "[columns]\nload_cell = { name = \"load_cell\" }\n",
                )
                .replace("[setup]\n", "[setup]\noperator = \"Ines\"\n")
            } else {
                with_cell(&text, number % 2 == 1)
            };
            bench.write(&format!("{folder}/{name}"), text);
        }
    }
    bench.age();
    bench
}

/// A log of points with the name of its cell.
fn with_cell(log: &str, reads_more: bool) -> String {
    let cell = if reads_more { "cell B" } else { "cell A" };
    let mut lines = log.lines();
    let mut text = format!("{},load_cell\n", lines.next().unwrap());
    for line in lines {
        let fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
        let force = if reads_more {
            GAIN * fields[1]
        } else {
            fields[1]
        };
        text.push_str(&format!("{},{force},{cell}\n", fields[0]));
    }
    text
}

#[test]
fn a_load_cell_that_reads_too_much_is_found_by_the_column_of_words_that_names_it() {
    let bench = campaign();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(!said.err.contains("not a finite number"), "{}", said.err);
    let json = std::fs::read(bench.root().join("reports/findings.json")).unwrap();
    let findings: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let found = &findings["campaigns"][0];
    assert_eq!(found["verdict"], "effect_found", "{found}");
    let effects = found["effects"].as_array().unwrap();
    let gain = effects
        .iter()
        .find(|e| e["id"] == "force_gain")
        .unwrap_or_else(|| panic!("{found}"));
    assert_eq!(gain["acts_on"], "levels", "{gain}");
    assert_eq!(gain["column"], "load_cell", "{gain}");
    // One gain is the other's inverse where the other cell is the one that all are compared with.
    let values = gain["parameters"].as_array().unwrap();
    let value = values[0]["value"].as_f64().unwrap();
    assert!(
        (value - GAIN).abs() < 0.01 || (value - 1.0 / GAIN).abs() < 0.01,
        "{gain}"
    );

    let plateaus = bench.table("plateaus");
    assert!(plateaus.iter().all(|r| r["operator"] == "Ines"));
    assert!(plateaus.iter().any(|r| r["load_cell"] == "cell B"));
    let rows = std::fs::read(bench.root().join("derived/rows.parquet")).unwrap();
    let rows = Frame::from_parquet(&rows).unwrap();
    let words = rows.texts("load_cell").unwrap();
    assert!(words.contains(&Some("cell A".to_owned())));
    let logs = files(&bench.root().join("derived/sessions"));
    let log = logs.iter().find(|f| f.parent().unwrap().ends_with("logs"));
    let log = Frame::from_parquet(&std::fs::read(log.unwrap()).unwrap()).unwrap();
    let is_words = |(name, values): &(String, Values)| {
        name == "load_cell" && matches!(values, Values::Text(_))
    };
    assert!(log.columns.iter().any(is_words));
}

const SESSION: &str = r#"
schema = "bpa-session/1"
id = "words"
kind = "isometric"
sampling = "points"
campaign = "words"

[specimen]
id = "l182"
diameter_mm = 10
rest_length_mm = 182
contracted_length_mm = 152

[setup]
length_mm = 182

[columns]
pressure = { name = "p", unit = "kPa" }
force = { name = "f", unit = "N" }
humidity = { name = "rh", unit = "%" }
bench = { name = "bench" }
"#;

fn words(session: &str, log: &str) -> Bench {
    let bench = Bench::small_done();
    let session = format!("{session}\n[[log]]\nfile = \"points.csv\"\n");
    bench.write("words/session.toml", session);
    bench.write("words/points.csv", log);
    bench.age();
    bench
}

#[test]
fn a_cell_that_is_no_number_says_what_becomes_of_its_row() {
    let log = "p,f,rh,bench\n100,40,50,A\n200,90,dry,A\n300,150,,B\nhigh,200,51,B\n";
    let bench = words(SESSION, log);
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    for part in [
        "points.csv:3",
        "\"dry\"",
        "the row stays, without a value of humidity (2 such cells",
        "text = true",
        "points.csv:5",
        "\"high\"",
        "the row is left out (1 such cell",
    ] {
        assert!(said.err.contains(part), "{part}: {}", said.err);
    }
    let plateaus = bench.table("plateaus");
    let own: Vec<_> = plateaus
        .iter()
        .filter(|r| r["session"] == "words")
        .collect();
    let cells = |name: &str| own.iter().map(|r| r[name].as_str()).collect::<Vec<&str>>();
    assert_eq!(cells("bench"), ["A", "A", "B"]);
    assert_eq!(cells("humidity"), ["50", "", ""]);
}

#[test]
fn words_of_several_kinds_in_one_column_are_one_warning() {
    let log = "p,f,rh,bench\n100,40,50,A\n200,OVR,51,A\n300,150,52,B\n400,low,53,B\n500,OVR,54,B\n";
    let bench = words(SESSION, log);
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let of_log: Vec<&str> = { said.err.lines() }
        .filter(|l| l.contains("points.csv"))
        .collect();
    assert_eq!(of_log.len(), 1, "{}", said.err);
    for part in ["points.csv:3", "\"OVR\", \"low\"", "(3 such cells"] {
        assert!(of_log[0].contains(part), "{part}: {}", of_log[0]);
    }
}

#[test]
fn numbers_that_name_something_are_words_where_the_session_says_so() {
    let session = SESSION.replace("\"bench\" }", "\"bench\", text = true }");
    let log = "p,f,rh,bench\n100,40,50,007\n200,90,50,007\n300,150,50,007\n";
    let bench = words(&session, log);
    assert_eq!(bench.run(&["run"]).code, 0);
    let plateaus = bench.table("plateaus");
    let own = plateaus.iter().filter(|r| r["session"] == "words");
    assert!(own.clone().count() == 3 && own.clone().all(|r| r["bench"] == "007"));

    let session = SESSION.replace("unit = \"%\"", "unit = \"%\", text = true");
    let said = words(&session, log).run(&["run"]);
    assert!(
        said.err.contains("`text = true` without `unit`"),
        "{}",
        said.err
    );
}

/// A time series whose logger writes who watches: the word that most of a plateau's rows have.
#[test]
fn a_plateau_has_the_label_of_most_of_its_rows() {
    use pipeline::config::CleanOptions;
    use pipeline::formats::session_toml;
    use pipeline::stages::{clean::clean, ingest::ingest};
    let truth = TRUTH.replace("sampling = \"points\"", "sampling = \"timeseries\"");
    let truth = truth.replace("pressures_kpa = [100, 200, 300, 400, 500, 620]", "");
    let specimen = "[[specimen]]\nid = \"l182\"\nrest_length_mm = 182\ncontraction_max = 0.166\n";
    let rig = "[rig]\nrows = 4000\nzero_rows = 400\n";
    let truth = simulate::read_truth("t", &format!("{truth}{specimen}{rig}"))
        .unwrap_or_else(|d| panic!("{d:?}"));
    let made = simulate::simulate(&truth);
    let files = &made.sessions[0].files;
    let toml = String::from_utf8(files[0].1.clone()).unwrap();
    let toml = toml.replace("[columns]\n", "[columns]\nwatch = { index = 4 }\n");
    let session = session_toml::read("t", &toml).unwrap_or_else(|d| panic!("{d:?}"));
    let with_watch = |log: &[u8]| {
        let watch = |(k, line): (usize, &str)| {
            let who = match k {
                _ if k % 50 == 7 => "",
                _ if k % 9 == 0 || k < 1000 => "Ines",
                _ => "Juan",
            };
            format!("{line},{who}\n")
        };
        let text = std::str::from_utf8(log).unwrap();
        text.lines().enumerate().map(watch).collect::<String>()
    };
    let logs = files[1..]
        .iter()
        .map(|(_, log)| Ok(with_watch(log).into_bytes()));
    let ingested = ingest(&session, "t", logs.collect());
    assert!(
        ingested.header.diagnostics.is_empty(),
        "{:?}",
        ingested.header.diagnostics
    );
    let readings = clean(&session, &ingested.logs, &CleanOptions::default()).readings;
    assert!(readings.len() > 5);
    for reading in &readings {
        let who = if reading.last_row < 1000 {
            "Ines"
        } else {
            "Juan"
        };
        let over_the_change = reading.first_row < 1000 && reading.last_row >= 1000;
        assert!(
            over_the_change || reading.labels["watch"] == who,
            "{reading:?}"
        );
    }
}
