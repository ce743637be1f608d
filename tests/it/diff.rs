//! `diff`: campaigns that are alike, that are not, and that cannot be compared.

use crate::support::{Bench, FAST};
use pipeline::simulate;
use serde_json::Value;

/// A campaign of five specimens and a few readings each.
fn truth(campaign: &str, seed: u32, coefficients: &str) -> String {
    let specimens = [83, 112, 182, 257, 382].map(|length| {
        format!("[[specimen]]\nid = \"{campaign}-{length}\"\nrest_length_mm = {length}\ncontraction_max = 0.165\n")
    });
    format!(
        "schema = \"bpa-truth/1\"\ncampaign = \"{campaign}\"\nseed = {seed}\ndate = \"2026-01\"\ndiameter_mm = 10\n\
         coefficients = {coefficients}\ncontractions = [0, 0.25, 0.5, 0.75]\nruns = [1]\nsampling = \"points\"\n\
         pressures_kpa = [100, 300, 620]\ndirections = \"up-down\"\ndwell_s = [2]\n{}",
        specimens.concat()
    )
}

/// Three campaigns after a run: two of one law, and one of actuators that are stronger by 30%.
fn bench() -> Bench {
    let bench = Bench::quick();
    std::fs::remove_dir_all(bench.raw().join("small")).unwrap();
    let stronger =
        "{ b1 = 394.55, b2 = 19.03, l_0 = 0.0075, c0 = 0.5682, c1 = 4.254, c2 = 0.5597 }";
    for (campaign, seed, coefficients) in [
        ("one", 11, "\"published\""),
        ("again", 12, "\"published\""),
        ("stronger", 13, stronger),
    ] {
        let text = truth(campaign, seed, coefficients);
        let truth = simulate::read_truth(campaign, &text).unwrap_or_else(|d| panic!("{d:?}"));
        let to = bench.raw().join(campaign);
        simulate::write(&simulate::simulate(&truth), &to, None, false).unwrap();
    }
    bench.age();
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    bench
}

#[test]
fn campaigns_of_one_law_are_equivalent_and_a_stronger_one_is_not() {
    let bench = bench();
    let of = |a: &str, b: &str| -> (i32, Value) {
        let said = bench.run(&["diff", a, b, "--json"]);
        let value = serde_json::from_str(&said.out);
        let value: Value = value.unwrap_or_else(|e| panic!("{e}: {}{}", said.out, said.err));
        (said.code, value[0]["force"].clone())
    };
    let (code, alike) = of("one", "again");
    assert_eq!(
        (code, alike["outcome"].as_str()),
        (0, Some("equivalent")),
        "{alike}"
    );
    let share = |d: &Value| d["largest"]["share"].as_f64().unwrap();
    assert!(share(&alike).abs() < 0.05, "{alike}");
    assert_eq!(alike["shared"], 0);

    let (code, stronger) = of("one", "stronger");
    assert_eq!(
        (code, stronger["outcome"].as_str()),
        (1, Some("different")),
        "{stronger}"
    );
    // 30% of the first is 26% of the mean of the two.
    assert!((share(&stronger) - 0.26).abs() < 0.05, "{stronger}");
    assert!((share(&stronger) + share(&of("stronger", "one").1)).abs() < 1e-12);
}

#[test]
fn a_run_is_equivalent_to_itself_and_what_is_not_there_is_named() {
    let bench = Bench::quick_done();
    let said = bench.run(&["diff", ".", ".", "--markdown", "--margin", "1%"]);
    assert_eq!(said.code, 0, "{}", said.err);
    for part in [
        "Equivalent at a margin of 1%",
        "### Coefficients",
        "| b1 |",
        "| verdict |",
    ] {
        assert!(said.out.contains(part), "{part} is not in\n{}", said.out);
    }
    for (a, b, parts) in [
        (
            "small",
            "other",
            &["other is not a campaign", "there are small"][..],
        ),
        ("small", "raw", &["there are no fits in raw/derived"]),
    ] {
        let said = bench.run(&["diff", a, b]);
        assert_eq!(said.code, 2, "{}", said.out);
        said.warns_of(parts);
    }
    assert_eq!(
        bench.run(&["diff", "small", "small", "--margin", "x"]).code,
        2
    );
    let wide = bench.run(&["diff", "small", "small", "--margin", "50"]);
    assert_eq!(wide.code, 2);
    wide.warns_of(&["write 10%"]);
}

/// A project with one specimen of the small campaign.
fn of_one_specimen(specimen: &str) -> Bench {
    let bench = Bench::quick();
    for other in ["a", "b", "c"].iter().filter(|s| **s != specimen) {
        std::fs::remove_dir_all(bench.raw().join("small").join(other)).unwrap();
    }
    bench.age();
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    bench
}

#[test]
fn why_single_specimens_are_not_compared_or_not_tested_is_said() {
    let [short, long] = ["a", "c"].map(of_one_specimen);
    let long = long.root().to_str().unwrap();
    let said = short.run(&["diff", ".", long]);
    assert_eq!(said.code, 1, "{}", said.err);
    for part in [
        "The forces are not compared: the resting lengths that were measured do not overlap",
        "112.0 mm",
        "382.0 mm",
    ] {
        assert!(said.out.contains(part), "{part} is not in\n{}", said.out);
    }
    let values: Value =
        serde_json::from_str(&short.run(&["diff", ".", long, "--json"]).out).unwrap();
    assert_eq!(values[0]["force"], Value::Null);
    assert_eq!(values[0]["not_compared"]["why"], "apart");
    assert_eq!(values[0]["not_compared"]["quantity"], "rest_length");
    let itself = short.run(&["diff", ".", "."]);
    assert_eq!(itself.code, 1);
    let part = "There is no test, because .:small has 1 specimen";
    assert!(itself.out.contains(part), "{}", itself.out);
}
