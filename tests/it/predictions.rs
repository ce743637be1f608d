//! `rows.parquet` holds what every model and the residual search expect of a reading: errors computed from it are those of the tables.

use crate::support::Bench;
use pipeline::base::frame::Frame;

/// Measured less predicted of the readings of one split that a column has an answer for.
fn errors(rows: &Frame, column: &str, split: &str) -> Vec<f64> {
    let (measured, predicted) = (rows.numbers("force_n"), rows.numbers(column));
    let (measured, predicted) = (measured.unwrap(), predicted.unwrap());
    let (roles, excluded) = (
        rows.texts("role").unwrap(),
        rows.integers("excluded").unwrap(),
    );
    let takes_part = |k: &usize| {
        let is_fitted = matches!(roles[*k].as_deref(), None | Some("train"));
        excluded[*k] == Some(0) && (is_fitted || split == "all")
    };
    let errors = (0..rows.height()).filter(takes_part);
    let errors = errors.map(|k| measured[k] - predicted[k]);
    errors.filter(|e| !e.is_nan()).collect()
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b.abs().max(1.0)
}

fn rows_of(bench: &Bench) -> Frame {
    let bytes = std::fs::read(bench.root().join("derived/rows.parquet")).unwrap();
    Frame::from_parquet(&bytes).unwrap()
}

#[test]
fn errors_of_the_models_are_those_of_the_comparison() {
    let bench = Bench::quick_done();
    let rows = rows_of(&bench);
    let mut seen = 0;
    for line in bench.table("model_comparison") {
        let (model, split) = (line["model"].as_str(), line["split"].as_str());
        let column = match (model, split) {
            (_, "common" | "rows_train" | "rows_validation") => continue,
            ("new", "loso") => "predicted_new_unseen_n".to_owned(),
            _ => format!("predicted_{model}_n"),
        };
        let errors = errors(&rows, &column, split);
        let number = |name: &str| line[name].parse::<f64>().unwrap();
        assert_eq!(errors.len() as f64, number("n"), "{column} {split}");
        if errors.is_empty() {
            continue;
        }
        let largest = errors.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        let bias = errors.iter().sum::<f64>() / errors.len() as f64;
        let what = format!("{column} {split}: {largest} {bias}");
        assert!(is_same(largest, number("max_abs_error")), "{what}");
        assert!(is_same(bias, number("bias")), "{what}");
        // Where a fit has seen the readings, its error has their number less that of its coefficients below.
        if line["fitted_here"] == "false" || split == "loso" {
            assert!(is_same(rms(&errors), number("rmse")), "{what}");
        }
        seen += 1;
    }
    assert!(seen > 8, "{seen}");
}

#[test]
fn errors_of_the_residual_search_are_those_of_the_findings() {
    let bench = Bench::quick_done();
    let rows = rows_of(&bench);
    let text = std::fs::read_to_string(bench.root().join("reports/findings.json")).unwrap();
    let findings: serde_json::Value = serde_json::from_str(&text).unwrap();
    let campaign = &findings["campaigns"][0];
    for side in ["before", "after"] {
        let errors = errors(&rows, &format!("predicted_loop_{side}_n"), "train");
        let expected = campaign[side]["rmse_train"].as_f64().unwrap();
        assert!(is_same(rms(&errors), expected), "{side} {expected}");
    }
    for (column, side) in [("unseen_before", "before"), ("unseen", "after")] {
        let errors = errors(&rows, &format!("predicted_loop_{column}_n"), "train");
        let expected = campaign[side]["rmse_heldout"].as_f64().unwrap();
        assert!(is_same(rms(&errors), expected), "{column} {expected}");
    }
    let steps = ["effects", "unexplained"].map(|of| campaign[of].as_array().unwrap().len());
    let column = |k: usize| format!("predicted_loop_after_{k}_n");
    let last: usize = steps.iter().sum();
    assert!(rows.numbers(&column(last + 1)).is_none());
    if last > 0 {
        let pair = [&column(last), "predicted_loop_after_n"].map(|c| rows.numbers(c).unwrap());
        let same = pair[0].iter().zip(pair[1]);
        assert!({ same }.all(|(a, b)| a.to_bits() == b.to_bits()));
    }
    let conditional = errors(&rows, "predicted_loop_conditional_n", "train");
    let after = errors(&rows, "predicted_loop_after_n", "train");
    assert!(rms(&conditional) < rms(&after));
}
