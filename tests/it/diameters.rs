//! Actuators of a diameter of which nothing is published.

use crate::support::{Bench, FAST, files};

#[test]
fn the_new_model_is_fitted_with_a_law_of_length_and_published_models_have_no_answer() {
    let bench = Bench::quick();
    for file in files(&bench.raw()) {
        if file.extension().is_some_and(|e| e == "toml") {
            let text = std::fs::read_to_string(&file).unwrap();
            let text = text.replace("diameter_mm = 10", "diameter_mm = 15");
            std::fs::write(&file, text).unwrap();
        }
    }
    bench.age();
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    let joint = bench.table("coefficients");
    let mut joint = joint
        .iter()
        .filter(|r| r["equation"] == "F(eps*, P*, l_rest)");
    let b2 = joint.find(|r| r["coefficient"] == "b2").unwrap();
    assert_eq!(b2["diameter_mm"], "15");
    // The truth is that of 10 mm, 19.03 1/m, less what an l_0 of 7.5 mm takes.
    let b2: f64 = b2["value"].parse().unwrap();
    assert!((10.0..30.0).contains(&b2), "{b2}");
    // What the base law fits itself is no effect.
    let tested = bench.table("tested");
    assert!(tested.iter().any(|r| r["diameter_mm"] == "15"));
    assert!(tested.iter().all(|r| r["id"] != "rest_length_scaling"));
    let models = bench.table("model_comparison");
    let answers = models.iter().filter(|r| r["n"] != "0");
    let others: Vec<&String> = answers
        .map(|r| &r["model"])
        .filter(|m| *m != "new")
        .collect();
    assert!(others.is_empty(), "{others:?}");
    let asked = [
        "predict",
        "--config",
        FAST,
        "--diameter",
        "16",
        "--rest-length",
        "182mm",
        "--contraction-620",
        "16%",
        "--contraction",
        "5%",
        "--pressure",
        "3bar",
    ];
    let said = bench.run(&asked);
    assert_eq!(said.code, 2);
    said.warns_of(&["no fit for 16 mm", "pipeline run"]);
}
