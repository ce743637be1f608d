//! `pipeline export model`: every language against the points, on models of a run and on the published ones, and which effects go with them.
//!
//! The programs in `tests/scripts/portable/` print the number of points and the largest difference as a multiple of what is allowed, 1e-9 of the
//! value or 1e-9 in its unit.

use crate::support::{Bench, Said, files, outside_program};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

const POINTS: f64 = 500.0;

/// Places of arguments of `export model` for a run of [`Bench::quick_done`] and for published models, with the folder.
const SOURCES: [(&str, &[&str]); 4] = [
    ("mixed", &["--campaign", "small"]),
    ("plain", &["--campaign", "small", "--least-squares"]),
    ("new20", &["--published", "new", "--diameter", "20"]),
    ("knee40", &["--published", "knee_paper", "--diameter", "40"]),
];

fn export(bench: &Bench, out: &str, source: &[&str]) -> Said {
    bench.run(&[&["export", "model", "--out", out], source].concat())
}

/// A run, and a folder for each of [`SOURCES`].
fn exported() -> (Bench, Vec<PathBuf>) {
    let bench = Bench::quick_done();
    let mut folders = Vec::new();
    for (out, source) in SOURCES {
        let said = export(&bench, out, source);
        assert_eq!(said.code, 0, "{}", said.err);
        folders.push(bench.root().join(out));
    }
    (bench, folders)
}

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/scripts/portable")
        .join(name)
}

/// The numbers that a program prints.
fn numbers(command: &mut Command) -> Vec<f64> {
    let output = command.output().unwrap();
    let (out, err) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success(), "{out}{err}");
    let numbers = out
        .split_whitespace()
        .map(|w| w.parse().unwrap_or(f64::NAN));
    numbers.collect()
}

/// Every point within what is allowed.
fn agrees(found: &[f64], points: f64) {
    assert!(found[0] >= points && found[1] < 1.0, "{found:?}");
}

#[test]
fn c_gives_the_forces_and_derivatives_of_the_points() {
    let (_bench, folders) = exported();
    for folder in folders {
        let program = folder.join("check");
        let output = Command::new("cc")
            .args([
                "-std=c99",
                "-Wall",
                "-Wextra",
                "-Wpedantic",
                "-Werror",
                "-O2",
            ])
            .arg("-I")
            .arg(&folder)
            .arg("-o")
            .arg(&program)
            .args([script("check.c"), folder.join("bpa_model.c")])
            .arg("-lm")
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
        let found = numbers(Command::new(program).arg(folder.join("golden_vectors.csv")));
        agrees(&found, POINTS);
    }
}

#[test]
fn the_same_model_is_the_same_bytes_and_another_one_is_not_overwritten() {
    let bench = Bench::quick_done();
    let source = SOURCES[0].1;
    assert_eq!(export(&bench, "model", source).code, 0);
    let first = bench.snapshot("model");
    assert_eq!(first.len(), 11);
    assert_eq!(export(&bench, "model", source).code, 0);
    assert_eq!(bench.snapshot("model"), first);
    let other = SOURCES[2].1;
    let refused = export(&bench, "model", other);
    assert_eq!(refused.code, 2);
    refused.warns_of(&["bpa_model.h", "--replace"]);
    assert_eq!(bench.snapshot("model"), first);
    assert_eq!(
        export(&bench, "model", &[other, &["--replace"]].concat()).code,
        0
    );
    assert_ne!(bench.snapshot("model"), first);
}

#[test]
fn the_head_of_a_file_says_what_a_user_has_to_know() {
    let (_bench, folders) = exported();
    for (folder, (_, source)) in folders.iter().zip(SOURCES) {
        let fitted = source.contains(&"--campaign");
        for file in files(folder)
            .iter()
            .filter(|f| f.extension().is_some_and(|e| e != "csv"))
        {
            let text = std::fs::read_to_string(file).unwrap();
            let short = ["bpa_domain.m", "bpa_force_gradient.m", "bpa_model.c"];
            if short.iter().any(|name| file.ends_with(name)) {
                continue;
            }
            for part in ["tension is positive", "continuation", "eps* ="] {
                assert!(text.contains(part), "{part} is not in {}", file.display());
            }
            assert_eq!(text.contains("Box of the readings fitted:"), fitted);
            assert_ne!(text.contains("nothing was fitted here"), fitted);
            assert_eq!(
                text.contains("b1 = ") && text.contains("raw files: sha256:"),
                fitted
            );
            assert_eq!(text.contains("simulated data"), fitted);
        }
    }
}

#[test]
fn what_cannot_be_exported_says_what_to_do() {
    let bench = Bench::quick_done();
    let says = |source: &[&str], parts: &[&str]| {
        let said = export(&bench, "model", source);
        assert_eq!(said.code, 2, "{}", said.err);
        said.warns_of(parts);
        assert!(!bench.root().join("model").exists());
    };
    says(
        &["--campaign", "smal"],
        &["no fit of a campaign smal", "small (10 mm)"],
    );
    says(
        &["--campaign", "small", "--diameter", "20"],
        &["and 20 mm", "small (10 mm)"],
    );
    says(&["--published", "new"], &["--diameter"]);
    says(
        &["--published", "new", "--diameter", "30"],
        &["30 mm", "[10, 20, 40]"],
    );
    says(
        &["--campaign", "small", "--derived", "nowhere"],
        &["there are no fits in nowhere", "--published"],
    );
    says(
        &["--campaign", "small", "--alias", "bladder_threshold"],
        &["--alias bladder_threshold", "there is no such set"],
    );
    says(&[], &["--campaign", "--published"]);
}

/// The findings of a run with other effects in the place of those of its campaign.
fn with_effects(bench: &Bench, effects: &[Value]) {
    let path = bench.root().join("reports/findings.json");
    let mut findings: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    findings["campaigns"][0]["effects"] = json!(effects);
    std::fs::remove_file(&path).unwrap();
    std::fs::write(path, findings.to_string()).unwrap();
}

fn effect(id: &str, class: &[&str], form: &str, size: f64) -> Value {
    json!({
        "id": id, "class": class, "acts_on": "all", "column": null, "from": null,
        "parameters": [{ "name": "p", "value": size, "ci_low": null, "ci_high": null, "unit": "kPa" }],
        "form": form, "equation": "an equation", "p_familywise": 0.001, "log_likelihood_gain": 20.0, "found_in_folds": 1.0,
        "negligible": false, "rms": 5.0, "by_specimen": {}, "profile": [], "free_form": null, "in_its_place": [], "explained_as_well_by": [],
        "measurement": "raise the pressure in steps", "source": "nobody",
    })
}

/// Number of points and of forces that are not zero among those of an export.
fn pressures_that_pull(folder: &Path) -> (f64, f64) {
    let rows = crate::support::read_table(&folder.join("bpa_lookup.csv"));
    let pulling = rows
        .iter()
        .filter(|r| r["force_n"] != "0" && r["contraction_rel"] == "0");
    let pressures = pulling.map(|r| r["pressure_kpa"].parse::<f64>().unwrap());
    pressures.fold((f64::INFINITY, 0.0), |(low, high), p| {
        (low.min(p), high.max(p))
    })
}

/// The force of `predict` by a model at the first point of an export that pulls, and that of the point.
fn predicted_beside(bench: &Bench, folder: &Path, model: &str) -> [f64; 2] {
    let points = crate::support::read_table(&folder.join("golden_vectors.csv"));
    let number = |text: &str| text.parse::<f64>().unwrap();
    let is_pulling =
        |r: &&BTreeMap<String, String>| r["inside"] == "1" && number(&r["force_n"]) > 20.0;
    let point = points.iter().find(is_pulling).unwrap();
    let state = [
        ("--rest-length", "rest_length_m", "m"),
        ("--contracted-length", "contracted_length_m", "m"),
        ("--length", "length_m", "m"),
        ("--pressure", "pressure_kpa", "kPa"),
    ]
    .map(|(option, column, unit)| format!("{option}={}{unit}", point[column]));
    let state: Vec<&str> = state.iter().map(String::as_str).collect();
    let asked = ["predict", "--diameter", "10", "--json", "--model", model];
    let said = bench.run(&[&asked, &state[..]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    let value: Value = serde_json::from_str(&said.out).unwrap();
    [
        value["answer"]["force_n"].as_f64().unwrap(),
        number(&point["force_n"]),
    ]
}

#[test]
fn predict_has_the_force_of_the_exported_model() {
    let bench = Bench::quick_done();
    let said = export(&bench, "plain", &["--campaign", "small", "--least-squares"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let plain = bench.root().join("plain");
    let [force, expected] = predicted_beside(&bench, &plain, "new_least_squares");
    assert!((force - expected).abs() < 1e-6, "{force} {expected}");
    // But for the smooth misfit, of a law that is right.
    let said = export(&bench, "mixed", &["--campaign", "small"]);
    assert!(!said.out.contains("WARNING"), "{}", said.out);
    let mixed = bench.root().join("mixed");
    let [force, expected] = predicted_beside(&bench, &mixed, "new");
    assert!((force / expected - 1.0).abs() < 0.01, "{force} {expected}");
}

#[test]
fn effects_of_the_actuator_go_with_the_model_and_those_of_the_rig_stay() {
    let bench = Bench::quick_done();
    let effects = [
        effect("bladder_threshold", &["bladder_threshold"], "sharp", 60.0),
        effect("series_compliance", &["series_compliance"], "linear", 8.0),
        effect("hysteresis", &["hysteresis"], "constant", 3.0),
        effect(
            "specimen_variation",
            &["specimen_variation"],
            "specimen gain",
            0.04,
        ),
    ];
    with_effects(&bench, &effects);
    let source = ["--campaign", "small"];
    let said = export(&bench, "model", &source);
    assert_eq!(said.code, 0, "{}", said.err);
    for part in [
        "threshold pressure of the bladder (bladder_threshold): 60 kPa in an equation",
        "(series_compliance), which is of the rig",
        "(hysteresis), which depends on more than lengths and pressure",
        "(specimen_variation), which is the scatter of muscles",
    ] {
        assert!(said.out.contains(part), "{part} is not in\n{}", said.out);
    }
    // These effects are not those of the readings: the export says that it does worse.
    assert!(
        said.out
            .contains("WARNING: larger than that of least squares"),
        "{}",
        said.out
    );
    let header = std::fs::read_to_string(bench.root().join("model/bpa_model.h")).unwrap();
    assert!(header.contains("which is of the rig"));
    let source = std::fs::read_to_string(bench.root().join("model/bpa_model.c")).unwrap();
    assert!(source.contains("P1 = 60.0, P2 = 0.0;"));
    let (lowest, _) = pressures_that_pull(&bench.root().join("model"));
    assert!((60.0..90.0).contains(&lowest), "{lowest}");
}

#[test]
fn an_alias_set_of_actuator_and_rig_is_refused_until_one_is_named() {
    let bench = Bench::quick_done();
    let class = ["pressure_zero_offset", "bladder_threshold"];
    with_effects(&bench, &[effect(class[0], &class, "constant", 25.0)]);
    let source = ["--campaign", "small"];
    let refused = export(&bench, "model", &source);
    assert_eq!(refused.code, 2);
    refused.warns_of(&[
        "cannot tell pressure_zero_offset and bladder_threshold apart",
        "--alias bladder_threshold puts it into the function",
        "--alias pressure_zero_offset leaves it out",
        "raise the pressure in steps",
    ]);
    for (named, threshold) in [(class[0], "P1 = 0.0"), (class[1], "P1 = 25.0")] {
        let said = export(&bench, named, &[&source[..], &["--alias", named]].concat());
        assert_eq!(said.code, 0, "{}", said.err);
        let source = std::fs::read_to_string(bench.root().join(named).join("bpa_model.c")).unwrap();
        assert!(source.contains(threshold), "{named}");
    }
    // A set of which the function could hold no member needs no choice.
    let class = ["hysteresis", "force_drift"];
    with_effects(&bench, &[effect(class[0], &class, "constant", 3.0)]);
    let said = export(&bench, "neither", &source);
    assert_eq!(said.code, 0, "{}", said.err);
    // No size of a gradual thing follows from that of another one.
    let class = ["force_gain", "rest_length_scaling"];
    with_effects(&bench, &[effect(class[0], &class, "gain", 0.1)]);
    let said = export(
        &bench,
        "other",
        &[&source[..], &["--alias", class[1]]].concat(),
    );
    assert_eq!(said.code, 2);
    said.warns_of(&[
        "the size of force_gain alone",
        "--alias force_gain leaves it out",
    ]);
}

/// With programs that are no part of a Rust machine: run by `.ci/run`, which installs them.
mod outside {
    use super::*;

    #[test]
    #[ignore = "needs Python with numpy"]
    fn python_gives_the_forces_and_derivatives_of_the_points() {
        let python = outside_program("PYTHON", "python3", &["-c", "import numpy"]);
        let (_bench, folders) = exported();
        for folder in folders {
            let found = numbers(Command::new(&python).arg(script("check.py")).arg(folder));
            agrees(&found, POINTS);
        }
    }

    #[test]
    #[ignore = "needs Python with mujoco and numpy"]
    fn a_muscle_in_mujoco_has_the_forces_of_the_points_and_lifts_its_load() {
        let python = outside_program("PYTHON", "python3", &["-c", "import mujoco, numpy"]);
        let (_bench, folders) = exported();
        for folder in folders {
            let found = numbers(
                Command::new(&python)
                    .arg(script("check_mujoco.py"))
                    .arg(folder),
            );
            // Without states that have no tendon: a length of nothing, no numbers.
            agrees(&found, POINTS - 50.0);
            let [_, _, steps, smallest, largest, off_balance] = found[..] else {
                panic!("{found:?}");
            };
            assert!(
                steps > 1000.0 && smallest >= 0.0 && largest < 6500.0,
                "{found:?}"
            );
            assert!(off_balance < 1e-4, "{found:?}");
        }
    }
}

/// With Octave, which no registry of `.ci/run` has: where it is installed.
mod octave {
    use super::*;

    #[test]
    #[ignore = "needs Octave"]
    fn matlab_gives_the_forces_and_derivatives_of_the_points() {
        let octave = outside_program("OCTAVE", "octave-cli", &["--version"]);
        let (_bench, folders) = exported();
        for folder in folders {
            let mut command = Command::new(&octave);
            command.args(["--norc", "--quiet"]);
            let found = numbers(command.arg(script("check.m")).arg(folder));
            agrees(&found, POINTS);
        }
    }
}
