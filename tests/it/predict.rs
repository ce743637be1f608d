//! `pipeline predict` as a user sees it.

use crate::support::{Bench, FAST, Said, read_table};
use pipeline::models::published;
use serde_json::Value;

const MUSCLE: [&str; 7] = [
    "predict",
    "--diameter",
    "10",
    "--rest-length",
    "182mm",
    "--contracted-length",
    "152mm",
];

fn predict(bench: &Bench, more: &[&str]) -> Said {
    let all: Vec<&str> = MUSCLE.iter().chain(more).copied().collect();
    bench.run(&all)
}

fn json(said: &Said) -> Value {
    assert_eq!(said.code, 0, "{}", said.err);
    serde_json::from_str(&said.out).unwrap_or_else(|e| panic!("{e}\n{}", said.out))
}

/// The values of the models' specification, to its printed digits.
#[test]
fn published_coefficients_give_the_check_values() {
    let bench = Bench::empty();
    for (diameter, rest, free, pressure, relative, force) in [
        ("10", "182mm", "0.165", "620kPa", "0.5", 143.139),
        ("10mm", "18.2cm", "16.5%", "3bar", "25%", 36.936),
        ("10", "0.455m", "0.165", "0.5MPa", "0.75", 19.336),
        ("20", "397mm", "0.24", "400kPa", "0.3", 455.375),
    ] {
        let said = bench.run(&[
            "predict",
            "--diameter",
            diameter,
            "--rest-length",
            rest,
            "--contraction-620",
            free,
            "--pressure",
            pressure,
            "--relative-contraction",
            relative,
            "--json",
        ]);
        let value = json(&said);
        let found = value["answer"]["force_n"].as_f64().unwrap();
        assert!((found - force).abs() < 6e-4, "{found} {force}");
        assert_eq!(value["model"], "new_published");
        let why = value["chosen_because"].as_str().unwrap();
        assert!(why.contains("there is no fit"), "{why}");
        assert!(value["answer"]["interval"].is_null());
    }
}

#[test]
fn a_fit_answers_with_interval_ranges_and_every_other_model() {
    let bench = Bench::small_done();
    let state = ["--pressure", "300kPa", "--contraction", "2%"];
    let said = predict(&bench, &state);
    assert_eq!(said.code, 0, "{}", said.err);
    for text in [
        "mixed-model fit to small (simulated data)",
        "the only fit for 10 mm",
        "95% interval",
        "gauge pressure",
        "tondu_lopez",
    ] {
        assert!(said.out.contains(text), "{text}\n{}", said.out);
    }
    assert!(!said.out.contains("warning"), "{}", said.out);
    let value = json(&predict(&bench, &[&state[..], &["--json"]].concat()));
    let answer = &value["answer"];
    let number = |v: &Value| v.as_f64().unwrap();
    let force = number(&answer["force_n"]);
    for (k, (model, close)) in [("new_least_squares", 0.05), ("new_published", 0.1)]
        .into_iter()
        .enumerate()
    {
        let other = number(&answer["others"][k]["force_n"]);
        assert_eq!(answer["others"][k]["model"], model);
        assert!((force / other - 1.0).abs() < close, "{force} {other}");
    }
    let interval = &answer["interval"];
    assert!(number(&interval["low_n"]) < force && force < number(&interval["high_n"]));
    assert!((1.0..=100.0).contains(&number(&interval["freedom"])));
    let others = answer["others"].as_array().unwrap().iter();
    let others: Vec<&str> = others.map(|o| o["model"].as_str().unwrap()).collect();
    let published = published().into_iter().map(|m| m.id());
    let all: Vec<&str> = ["new_least_squares"].into_iter().chain(published).collect();
    assert_eq!(others, all);
    let measured = answer["measured"].as_array().unwrap();
    for quantity in [
        "resting length",
        "gauge pressure",
        "relative contraction",
        "contraction at 620 kPa",
    ] {
        let range = measured.iter().find(|m| m["quantity"] == quantity);
        let range = range.unwrap_or_else(|| panic!("{quantity}: {measured:?}"));
        assert!(number(&range["low"]) < number(&range["high"]), "{range}");
    }
}

#[test]
fn what_was_not_measured_is_warned_of() {
    let bench = Bench::small_done();
    for (more, warning) in [
        (
            &["--pressure", "850kPa", "--contraction", "0"][..],
            "gauge pressure 850 kPa is outside the measured range",
        ),
        (
            &["--pressure", "850kPa", "--contraction", "0"],
            "850 kPa is above the manufacturer's limit of 800 kPa for 10 mm",
        ),
        (
            &["--pressure", "6bar", "--relative-contraction", "0.9"],
            "relative contraction 0.900 is outside the measured range",
        ),
    ] {
        let said = predict(&bench, more);
        assert_eq!(said.code, 0, "{}", said.err);
        assert!(
            said.out.contains(&format!("warning: {warning}")),
            "{}",
            said.out
        );
    }
    let short = bench.run(&[
        "predict",
        "--diameter",
        "10",
        "--rest-length",
        "60mm",
        "--contraction-620",
        "0.25",
        "--pressure",
        "3bar",
        "--contraction",
        "1%",
    ]);
    assert!(
        short
            .out
            .contains("resting length 60 mm is outside the measured range 112 to 382 mm"),
        "{}",
        short.out
    );
    assert!(
        short
            .out
            .contains("contraction at 620 kPa 0.250 is outside the measured range"),
        "{}",
        short.out
    );
    let slack = predict(
        &bench,
        &["--pressure", "1bar", "--relative-contraction", "0.9"],
    );
    assert!(
        !slack.out.contains("warning"),
        "a slack muscle stays slack\n{}",
        slack.out
    );
}

/// The unknown eps_620 is the mean of the specimens, and the interval is wider for it; a published model takes the mean too, or asks.
#[test]
fn an_eps_620_that_is_not_given_is_assumed_and_said_so_or_asked_for() {
    let bench = Bench::small_done();
    let muscle = ["predict", "--diameter", "10", "--rest-length", "182mm"];
    let state = ["--pressure", "500kPa", "--contraction", "5%"];
    let said = bench.run(&[&muscle[..], &state].concat());
    assert!(
        said.out.contains("16.7%, the mean of 3 specimens"),
        "{}",
        said.out
    );
    let width = |free: &[&str]| {
        let value = json(&bench.run(&[&muscle[..], &state, free, &["--json"]].concat()));
        let interval = &value["answer"]["interval"];
        interval["high_n"].as_f64().unwrap() - interval["low_n"].as_f64().unwrap()
    };
    assert!(width(&[]) > width(&["--contraction-620", "0.16667"]));
    let published = |id: &str| bench.run(&[&muscle[..], &state, &["--model", id]].concat());
    let hunt = published("hunt2017");
    assert_eq!(hunt.code, 0, "{}", hunt.err);
    assert!(
        hunt.out.contains("16.7%, the mean of 3 specimens"),
        "{}",
        hunt.out
    );
    assert_eq!(published("festo_tool").code, 0);
    // Without fitted specimens there is no mean to take.
    let none = Bench::empty();
    let asked = none.run(&[&muscle[..], &state, &["--model", "hunt2017"]].concat());
    assert_eq!(asked.code, 2);
    assert!(asked.err.contains("--contraction-620"), "{}", asked.err);
}

#[test]
fn senseless_input_exits_with_2_and_says_what_to_do() {
    let bench = Bench::empty();
    for (more, says) in [
        (
            &["--pressure", "300", "--contraction", "5%"][..],
            "kPa, Pa, MPa, bar, psi",
        ),
        (
            &["--pressure", "300psia", "--contraction", "5%"],
            "did you mean psi?",
        ),
        (
            &["--pressure", "-3bar", "--contraction", "5%"],
            "never negative",
        ),
        (&["--pressure", "3bar", "--contraction", "5"], "5% or 0.05"),
        (
            &["--pressure", "3bar", "--length", "1.8m"],
            "check both lengths",
        ),
        (&["--pressure", "3bar"], "--contraction"),
        (&["--contraction", "5%"], "--pressure"),
        (
            &[
                "--pressure",
                "3bar",
                "--contraction",
                "5%",
                "--length",
                "170mm",
            ],
            "cannot be used with",
        ),
        (
            &[
                "--pressure",
                "3bar",
                "--contraction",
                "5%",
                "--model",
                "hunt2018",
            ],
            "did you mean hunt2017?",
        ),
        (
            &[
                "--pressure",
                "3bar",
                "--contraction",
                "5%",
                "--campaign",
                "x",
            ],
            "pipeline run",
        ),
        (
            &[
                "--pressure",
                "3bar",
                "--contraction",
                "5%",
                "--plot",
                "x.svg",
            ],
            "--sweep or --table",
        ),
        (&["--sweep", "contraction"], "--pressure is missing"),
        (&["--table", "--plot", "x.gif"], ".svg, .pdf or .png"),
    ] {
        let said = predict(&bench, more);
        assert_eq!(said.code, 2, "{more:?}\n{}{}", said.out, said.err);
        assert!(said.err.contains(says), "{more:?}\n{}", said.err);
    }
    let swapped = bench.run(&[
        "predict",
        "--diameter",
        "10",
        "--rest-length",
        "152mm",
        "--contracted-length",
        "182mm",
        "--pressure",
        "3bar",
        "--contraction",
        "5%",
    ]);
    assert!(
        swapped.code == 2 && swapped.err.contains("swapped"),
        "{}",
        swapped.err
    );
}

#[test]
fn no_force_is_predicted_of_a_muscle_that_is_stretched_beyond_what_a_braid_bears() {
    let bench = Bench::small_done();
    let at = |contraction: &str| {
        predict(
            &bench,
            &["--pressure", "3bar", "--contraction", contraction],
        )
    };
    let refused = at("-5.1%");
    assert_eq!(refused.code, 2, "{}", refused.out);
    refused.warns_of(&["a braid bears no more than 5%"]);
    assert_eq!(at("-5%").code, 0);
}

#[test]
fn what_a_sweep_varies_is_not_given_and_a_length_is_asked_for_in_mm() {
    let bench = Bench::small_done();
    let sweep = ["--contraction", "2%", "--sweep", "pressure"];
    let said = predict(&bench, &[&sweep[..], &["--pressure", "3bar"]].concat());
    assert_eq!(said.code, 2, "{}", said.out);
    said.warns_of(&["--pressure is what the sweep varies"]);
    let said = bench.run(&["predict", "--diameter", "10", "--rest-length", "221"]);
    assert_eq!(said.code, 2, "{}", said.out);
    said.warns_of(&["as in --rest-length 221mm"]);
}

#[test]
fn sweeps_and_the_table_are_printed_written_and_drawn() {
    let bench = Bench::small_done();
    let said = predict(
        &bench,
        &[
            "--contraction",
            "2%",
            "--sweep",
            "pressure",
            "--from",
            "1bar",
            "--to",
            "6bar",
            "--step",
            "100kPa",
            "--csv",
            "s.csv",
            "--plot",
            "s.svg",
        ],
    );
    assert_eq!(said.code, 0, "{}", said.err);
    let drawn = std::fs::read_to_string(bench.root().join("s.svg")).unwrap();
    assert!(
        !drawn.contains("hunt2017"),
        "names of models, not their ids"
    );
    let rows = read_table(&bench.root().join("s.csv"));
    let number = |row: usize, name: &str| rows[row][name].parse::<f64>().unwrap();
    assert_eq!(rows.len(), 6);
    assert_eq!(
        (number(0, "pressure_kpa"), number(5, "pressure_kpa")),
        (100.0, 600.0)
    );
    for k in 1..6 {
        assert!(number(k, "force_n") > number(k - 1, "force_n"));
        assert!(number(k, "interval_n_low") < number(k, "force_n"));
    }
    let svg = std::fs::read_to_string(bench.root().join("s.svg")).unwrap();
    assert!(
        svg.starts_with("<svg") && svg.contains("simulated data"),
        "{}",
        &svg[..200]
    );
    for file in ["t.pdf", "t.png"] {
        let said = predict(&bench, &["--table", "--csv", "t.csv", "--plot", file]);
        assert_eq!(said.code, 0, "{}", said.err);
        assert!(said.out.contains("620 kPa"), "{}", said.out);
        assert!(bench.root().join(file).metadata().unwrap().len() > 5000);
    }
    assert_eq!(read_table(&bench.root().join("t.csv")).len(), 8 * 7);
    let value = json(&predict(
        &bench,
        &[
            "--contraction",
            "1%",
            "--pressure",
            "3bar",
            "--sweep",
            "rest-length",
            "--json",
        ],
    ));
    assert_eq!(value["sweep"]["along"], "rest-length");
    let answers = value["sweep"]["answers"].as_array().unwrap();
    let first = answers[0]["muscle"]["rest_length_m"].as_f64().unwrap();
    assert!((first - 0.112).abs() < 1e-12);
}

/// The laws of mixed models are read with care: without them there is no interval, and damaged ones are told.
#[test]
fn laws_of_mixed_models_that_are_missing_or_damaged_are_said() {
    let bench = Bench::quick_done();
    let state = ["--pressure", "300kPa", "--contraction", "2%"];
    let own = json(&predict(&bench, &[&state[..], &["--json"]].concat()));
    let read = json(&predict(
        &bench,
        &[&state[..], &["--as-read", "--json"]].concat(),
    ));
    let noise = |v: &Value| v["answer"]["interval"]["noise_n"].as_f64().unwrap();
    assert!(noise(&own) == 0.0 && noise(&read) > 0.0);
    for option in [&["--as-read"][..], &["--length-sd", "0.2mm"]] {
        for model in ["new_published", "new_least_squares"] {
            let said = predict(&bench, &[&state[..], option, &["--model", model]].concat());
            assert_eq!(said.code, 2, "{}", said.out);
            said.warns_of(&[option[0], "mixed model"]);
        }
    }
    let path = bench.root().join("derived/mixed_laws.json");
    let laws = std::fs::read_to_string(&path).unwrap();
    let replaced = |text: &str| {
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, text).unwrap();
        predict(&bench, &state)
    };
    let mut short: Value = serde_json::from_str(&laws).unwrap();
    short[0]["root"].as_array_mut().unwrap().pop();
    for damaged in [short.to_string(), laws[..laws.len() / 2].to_owned()] {
        let said = replaced(&damaged);
        assert_eq!(said.code, 2, "{}", said.out);
        said.warns_of(&["mixed_laws.json", "pipeline run"]);
    }
    std::fs::remove_file(&path).unwrap();
    let said = predict(&bench, &state);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.out.contains("mixed_laws.json, which has the scatter"),
        "{}",
        said.out
    );
    // The next run puts it back as it was.
    let again = bench.run(&["run", "--config", FAST]);
    assert_eq!(again.code, 0, "{}", again.err);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), laws);
}

/// With Python and NumPy: run by `.ci/run`.
mod outside {
    use crate::support::outside_program;
    use std::path::Path;
    use std::process::Command;

    /// Two minutes: `tests/scripts/mixed_law.py` simulates campaigns, runs them and predicts by their mixed models with a dense covariance.
    #[test]
    #[ignore = "needs Python with numpy"]
    fn numpy_predicts_the_same_by_the_mixed_models() {
        let python = outside_program("PYTHON", "python3", &["-c", "import numpy"]);
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/mixed_law.py");
        let mut command = Command::new(python);
        let output = command
            .arg(script)
            .arg(env!("CARGO_BIN_EXE_pipeline"))
            .output();
        let output = output.unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        let failed = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}{failed}");
        assert!(said.contains("; 0 differences are too large"), "{said}");
    }
}
