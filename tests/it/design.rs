//! `pipeline design`, and the inverse of `pipeline predict`.

use crate::support::{Bench, Said};
use serde_json::Value;

/// A run, beside a curve.
fn bench(curve: &str) -> Bench {
    let bench = Bench::quick_done();
    std::fs::write(bench.root().join("curve.csv"), curve).unwrap();
    bench
}

fn json(said: &Said) -> Value {
    assert_eq!(said.code, 0, "{}", said.err);
    serde_json::from_str(&said.out).unwrap()
}

const MUSCLE: [&str; 7] = [
    "predict",
    "--diameter",
    "10",
    "--rest-length",
    "233mm",
    "--contraction-620",
    "17%",
];

fn predict(bench: &Bench, options: &[&str]) -> Said {
    bench.run(&[&MUSCLE, options].concat())
}

#[test]
fn the_pressure_for_a_force_has_that_force() {
    let bench = bench("");
    let options = ["--contraction", "4%", "--pressure-for", "120N", "--json"];
    let found = &json(&predict(&bench, &options))["solved"];
    let number = |at: &str| found.pointer(at).and_then(Value::as_f64).unwrap();
    assert!((number("/answer/force_n") - 120.0).abs() < 1e-6);
    let kpa = format!("{}kPa", number("/answer/pressure_kpa"));
    let again = json(&predict(
        &bench,
        &["--contraction", "4%", "--pressure", &kpa, "--json"],
    ));
    let force = again.pointer("/answer/force_n").and_then(Value::as_f64);
    assert!((force.unwrap() - 120.0).abs() < 1e-6);
    // A weak muscle takes more pressure, and a strong one less.
    assert!(number("/strongest/pressure_kpa") < number("/answer/pressure_kpa"));
    assert!((number("/strongest/interval/high_n") - 120.0).abs() < 1e-6);
    assert!(number("/weakest/pressure_kpa") > number("/answer/pressure_kpa"));
    assert!((number("/weakest/interval/low_n") - 120.0).abs() < 1e-6);
}

/// What the rig reads of a slack muscle reaches above so small a force, for its noise: no pressure is the lower end of that for it. The muscle itself has
/// no force there.
#[test]
fn a_force_within_the_interval_of_a_slack_muscle_has_no_strongest_one() {
    let bench = bench("");
    let force = ["--contraction", "4%", "--pressure-for", "0.01N"];
    let own = json(&predict(&bench, &[&force[..], &["--json"]].concat()));
    assert!(own["solved"]["strongest"]["pressure_kpa"].as_f64() > Some(0.0));
    let options = [&force[..], &["--as-read"]].concat();
    let found = &json(&predict(&bench, &[&options[..], &["--json"]].concat()))["solved"];
    assert!(found["strongest"].is_null(), "{found}");
    assert!(found["answer"]["pressure_kpa"].as_f64().unwrap() > 0.0);
    let said = predict(&bench, &options);
    assert!(
        said.out.contains("no lower end (a strong one)"),
        "{}",
        said.out
    );
}

#[test]
fn the_length_for_a_force_has_that_force() {
    let bench = bench("");
    let found = json(&predict(
        &bench,
        &["--pressure", "500kPa", "--length-for", "0.1kN", "--json"],
    ));
    let found = &found["solved"];
    let number = |at: &str| found.pointer(at).and_then(Value::as_f64).unwrap();
    assert!((number("/answer/force_n") - 100.0).abs() < 1e-6);
    assert!(number("/weakest/length_m") > number("/answer/length_m"));
    assert!(number("/strongest/length_m") < number("/answer/length_m"));
    let said = predict(&bench, &["--pressure", "500kPa", "--length-for", "100N"]);
    assert!(
        said.out.contains("length for 100.0 N at 500.0 kPa"),
        "{}",
        said.out
    );
}

#[test]
fn a_force_that_no_state_has_is_refused() {
    let bench = bench("");
    let says = |options: &[&str], part: &str| {
        let said = predict(&bench, options);
        assert_eq!(said.code, 2, "{}", said.out);
        said.warns_of(&[part]);
    };
    says(
        &["--contraction", "4%", "--pressure-for", "900N"],
        "does not reach 900.0 N",
    );
    says(
        &["--pressure", "100kPa", "--length-for", "300N"],
        "at its resting length it has",
    );
    says(
        &["--pressure", "100kPa", "--length-for", "0N"],
        "above zero",
    );
    for option in [
        ["--contraction", "4%", "--pressure-for", "-5N"],
        ["--pressure", "100kPa", "--length-for", "-5N"],
    ] {
        says(&option, "a force of -5 N would push");
    }
    says(&["--pressure-for", "100N"], "contraction");
    says(&["--length-for", "100N"], "pressure");
}

#[test]
fn the_shortest_muscle_meets_the_curve_and_one_millimetre_less_does_not() {
    let bench = bench("travel_mm,force_n\n0,180\n10,120\n20,60\n");
    let found = json(&bench.run(&["design", "curve.csv", "--json"]));
    let chosen = &found["designs"][0];
    assert_eq!(found["shortest"], 0);
    assert_eq!(chosen["meets"], true);
    let rest = chosen["rest_length_m"].as_f64().unwrap();
    let margins = |rest: f64| -> f64 {
        let mut smallest = f64::INFINITY;
        for (travel, needed) in [(0.0, 180.0), (0.010, 120.0), (0.020, 60.0)] {
            let (rest, length) = (format!("{rest}m"), format!("{}m", rest - travel));
            let options = [
                "predict",
                "--diameter",
                "10",
                "--rest-length",
                &rest,
                "--length",
                &length,
                "--pressure",
                "620kPa",
                "--json",
            ];
            let answer = json(&bench.run(&options));
            let low = answer
                .pointer("/answer/interval/low_n")
                .and_then(Value::as_f64);
            smallest = smallest.min(low.unwrap() - needed);
        }
        smallest
    };
    let margin = chosen["margin"].as_f64().unwrap();
    assert!(margin >= 0.0 && (margins(rest) - margin).abs() < 1e-6);
    assert!(margins(rest - 0.001) < 0.0);
    let nominal = json(&bench.run(&["design", "curve.csv", "--nominal", "--json"]));
    assert!(nominal["designs"][0]["rest_length_m"].as_f64().unwrap() < rest);
}

#[test]
fn a_curve_that_no_muscle_meets_has_the_one_that_comes_closest() {
    let bench = bench("contraction,force_n\n0.0,900\n0.1,100\n");
    let said = bench.run(&[
        "design",
        "curve.csv",
        "--csv",
        "met.csv",
        "--plot",
        "met.svg",
    ]);
    assert_eq!(said.code, 1, "no muscle meets it: {}", said.err);
    for part in ["falls short", "tightest at", "no measured length"] {
        assert!(said.out.contains(part), "{part} is not in\n{}", said.out);
    }
    let rows = crate::support::read_table(&bench.root().join("met.csv"));
    assert_eq!(rows.len(), 2);
    assert!(rows[0]["margin"].parse::<f64>().unwrap() < 0.0);
    assert!(bench.root().join("met.svg").exists());
}

#[test]
fn a_torque_has_the_sign_of_its_route() {
    let bench = bench("angle_deg,torque_nm\n-60,-2\n-50,-2\n");
    let leg = [
        "design",
        "curve.csv",
        "--knee",
        "pinned",
        "--tendon",
        "80mm",
    ];
    let on =
        |route: &str, more: &[&str]| bench.run(&[&leg[..], &["--route", route], more].concat());
    let said = on("flexor", &["--json", "--nominal"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let found: Value = serde_json::from_str(&said.out).unwrap();
    for point in found["designs"][0]["points"].as_array().unwrap() {
        let of = |name: &str| point[name].as_f64().unwrap();
        assert!(of("available") <= -2.0, "{point}");
        assert!(
            of("low") < of("available") && of("available") < of("high"),
            "{point}"
        );
    }
    // By the interval the weaker end counts, which is the upper one of a negative torque.
    let said = on("flexor", &["--json"]);
    let found: Value = serde_json::from_str(&said.out).unwrap();
    let design = &found["designs"][0];
    let points = design["points"].as_array().unwrap().iter();
    let margins = points.map(|p| -p["high"].as_f64().unwrap() - 2.0);
    let smallest = margins.fold(f64::INFINITY, f64::min);
    assert!(
        (design["margin"].as_f64().unwrap() - smallest).abs() < 1e-9,
        "{design}"
    );
    let opposite = "has the sign of the curve";
    assert!(!on("flexor", &[]).out.contains(opposite));
    assert!(on("extensor", &[]).out.contains(opposite));
}

#[test]
fn a_torque_takes_a_leg() {
    let bench = bench("angle_deg,torque_nm\n-60,-2\n-20,-4\n");
    let without = bench.run(&["design", "curve.csv"]);
    assert_eq!(without.code, 2);
    without.warns_of(&["give --knee"]);
    let leg = [
        "design",
        "curve.csv",
        "--knee",
        "pinned",
        "--route",
        "flexor",
        "--json",
    ];
    let said = bench.run(&leg);
    let found: Value = serde_json::from_str(&said.out).unwrap();
    let meets = found.pointer("/designs/0/meets").and_then(Value::as_bool);
    assert_eq!(said.code, i32::from(meets == Some(false)), "{found}");
    let points = found
        .pointer("/designs/0/points")
        .and_then(Value::as_array)
        .unwrap();
    assert_eq!(points.len(), 2);
    for point in points {
        // Nothing here pulls with more than 450 N on an arm of 70 mm, however far a law would go on.
        assert!(point["available"].as_f64().unwrap().abs() < 32.0, "{point}");
    }
    let beyond = bench.root().join("curve.csv");
    std::fs::write(beyond, "angle_deg,torque_nm\n-400,-2\n").unwrap();
    let said = bench.run(&leg);
    assert_eq!(said.code, 2);
    said.warns_of(&["-400 degrees", "the joint goes from"]);
}

#[test]
fn curves_that_are_none_say_what_is_expected() {
    for (curve, parts) in [
        (
            "force,length\n1,2\n",
            &["curve.csv:1", "travel_mm,force_n"][..],
        ),
        (
            "travel_mm,force_n\n1,2\n3\n",
            &["curve.csv:3", "two numbers"],
        ),
        (
            "travel_mm,force_n\n1,-2\n",
            &["curve.csv:2", "a muscle cannot push"],
        ),
        ("travel_mm,force_n\n1,0\n", &["requires nothing"]),
        ("", &["curve.csv:1"]),
    ] {
        let said = bench(curve).run(&["design", "curve.csv"]);
        assert_eq!(said.code, 2, "{curve}");
        said.warns_of(parts);
    }
}
