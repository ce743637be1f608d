//! `predict --calibrate` and `--specimen`: what readings of a muscle say of it.

use crate::support::{Bench, FAST, Said};
use pipeline::simulate;
use serde_json::Value;
use std::path::Path;

const FORCE_STATE: [&str; 4] = ["--contraction", "4%", "--pressure", "500kPa"];

fn simulated(campaign: &str, b1: f64, specimens: &[u32], contractions: &str, to: &Path) {
    let specimens = specimens.iter().map(|length| {
        format!("[[specimen]]\nid = \"{campaign}-{length}\"\nrest_length_mm = {length}\ncontraction_max = 0.165\n")
    });
    let text = format!(
        "schema = \"bpa-truth/1\"\ncampaign = \"{campaign}\"\nseed = 21\ndate = \"2026-01\"\ndiameter_mm = 10\n\
         coefficients = {{ b1 = {b1}, b2 = 19.03, l_0 = 0.0075, c0 = 0.5682, c1 = 4.254, c2 = 0.5597 }}\n\
         contractions = {contractions}\nruns = [1]\nsampling = \"points\"\npressures_kpa = [200, 400, 620]\n\
         directions = \"up-down\"\ndwell_s = [2]\n{}\
         [[effect]]\nid = \"specimen_variation\"\nform = \"normal\"\nsd = 0.05\n",
        specimens.collect::<String>()
    );
    let truth = simulate::read_truth(campaign, &text).unwrap_or_else(|d| panic!("{d:?}"));
    simulate::write(&simulate::simulate(&truth), to, None, false).unwrap();
}

/// A run on actuators whose gains scatter by 5%, and beside the raw directory one session of one that is of a law 12% stronger.
fn bench() -> Bench {
    let bench = Bench::quick();
    std::fs::remove_dir_all(bench.raw().join("small")).unwrap();
    let lengths = [83, 112, 182, 257, 300, 382, 455];
    simulated(
        "others",
        303.5,
        &lengths,
        "[0, 0.25, 0.5, 0.75]",
        &bench.raw().join("others"),
    );
    simulated("own", 340.0, &[233], "[0.25]", &bench.root().join("own"));
    bench.age();
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    bench
}

fn json(said: &Said) -> Value {
    assert_eq!(said.code, 0, "{}", said.err);
    serde_json::from_str(&said.out).unwrap()
}

fn number(value: &Value, at: &str) -> f64 {
    let found = value.pointer(at).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("{at} in {value}"))
}

#[test]
fn a_few_readings_of_a_muscle_move_and_narrow_its_force() {
    let bench = bench();
    let predict =
        |own: &[&str]| json(&bench.run(&[&["predict"], own, &FORCE_STATE, &["--json"]].concat()));
    let known = predict(&["--calibrate", "own"]);
    let described = predict(&[
        "--diameter",
        "10",
        "--rest-length",
        "233mm",
        "--contraction-620",
        "16.5%",
    ]);
    // Before the readings it is any muscle.
    // Its contracted length stands in the session to a tenth of a millimetre.
    let before = number(&known, "/answer/uncalibrated/0");
    assert!((before - number(&described, "/answer/force_n")).abs() < 0.5);
    let width = |v: &Value, at: &str| {
        number(v, &format!("{at}/high_n")) - number(v, &format!("{at}/low_n"))
    };
    assert!(
        width(&known, "/answer/interval") < 0.6 * width(&described, "/answer/interval"),
        "{known}"
    );
    // The readings are as strong as they are: nearer to them than to the mean, and not beyond them.
    let ratio = number(&known, "/answer/force_n") / number(&described, "/answer/force_n");
    let gain = number(&known, "/calibration/specimen_gain/value");
    assert!(ratio > 1.03 && gain > 0.03, "{known}");
    assert!(
        number(&known, "/calibration/specimen_gain/sd")
            < number(&known, "/calibration/specimen_gain/sd_before")
    );
    assert!(number(&known, "/calibration/percentile") > 60.0);
    assert_eq!(known["calibration"]["sessions"], 1);
    let next = |end: &str| number(&known, &format!("/calibration/next/{end}"));
    assert!(next("sd_after_n") < next("sd_before_n"), "{known}");
    // The same session twice says no more than once.
    let twice = predict(&["--calibrate", "own", "--calibrate", "own"]);
    assert_eq!(twice["calibration"], known["calibration"]);
    // A length that is noted wrongly by 12 mm is not taken for a weak muscle without a word.
    let description = bench.root().join("own/own-233/c25/session.toml");
    let text = std::fs::read_to_string(&description).unwrap();
    let noted = text.lines().find(|l| l.starts_with("length_mm")).unwrap();
    let length: f64 = noted.split('=').nth(1).unwrap().trim().parse().unwrap();
    let wrong = text.replace(noted, &format!("length_mm = {}", length + 12.0));
    std::fs::write(&description, wrong).unwrap();
    let doubtful = predict(&["--calibrate", "own"]);
    let doubts = doubtful["calibration"]["doubts"].as_array().unwrap();
    assert!(
        doubts[0].as_str().unwrap().contains("check-session"),
        "{doubtful}"
    );
    // Nor is one that is more than twice as strong as the others taken as it is.
    let far = bench.root().join("far");
    simulated("far", 800.0, &[233], "[0.25]", &far);
    let strong = predict(&["--calibrate", "far"]);
    let doubts = strong["calibration"]["doubts"].as_array().unwrap();
    let contradicts = |d: &Value| d.as_str().unwrap().contains("not to be relied on");
    assert!(doubts.iter().any(contradicts), "{strong}");
    let of_own = known["calibration"]["doubts"].as_array().unwrap();
    assert!(!of_own.iter().any(contradicts), "{known}");
}

#[test]
fn a_specimen_of_the_run_is_predicted_by_the_mixed_model_and_its_own_readings() {
    let bench = bench();
    let said = bench.run(&[&["predict", "--specimen", "others-182"], &FORCE_STATE[..]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    for part in [
        "readings",
        "percentile",
        "for this muscle",
        "before",
        "next",
        "than noted, by that law",
        "it is one of the 7 specimens of the mixed model",
    ] {
        assert!(said.out.contains(part), "{part} is not in\n{}", said.out);
    }
    for (options, parts) in [
        (&["--specimen", "nobody"][..], &["nobody", "others-182"][..]),
        (&["--calibrate", "raw/others"], &["more than one muscle"]),
        (
            &["--calibrate", "reports"],
            &["there is no session", "check-session"],
        ),
        (
            &["--specimen", "others-182", "--model", "hunt2017"],
            &["leave out --model"],
        ),
        (
            &["--specimen", "others-182", "--diameter", "10"],
            &["cannot be used with"],
        ),
        (&["--diameter", "10"], &["--rest-length"]),
    ] {
        let said = bench.run(&[&["predict"], options, &FORCE_STATE].concat());
        assert_eq!(said.code, 2, "{options:?}: {}", said.out);
        said.warns_of(parts);
    }
    let swept = [
        "predict",
        "--specimen",
        "others-182",
        "--contraction",
        "4%",
        "--pressure",
        "500kPa",
        "--sweep",
        "rest-length",
    ];
    let said = bench.run(&swept);
    assert_eq!(said.code, 2);
    said.warns_of(&["another length"]);
}
