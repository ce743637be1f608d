//! Agreement with `scripts/model_checks.py`, which computes the same forces with SciPy and other methods.

use std::collections::BTreeMap;

use super::model;
use pipeline::models::{Direction, State, published};

const CHECKS: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/data/model_checks.csv"
));

fn direction(name: &str) -> Direction {
    match name {
        "shortening" => Direction::Shortening,
        "lengthening" => Direction::Lengthening,
        "isometric" => Direction::Isometric,
        other => panic!("direction {other}"),
    }
}

#[test]
fn every_model_agrees_with_scipy() {
    let mut states: BTreeMap<&str, usize> = BTreeMap::new();
    for line in CHECKS.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        let state = State {
            diameter_mm: number(1),
            rest_length_m: number(2),
            contracted_length_m: number(3),
            length_m: number(4),
            pressure_kpa: number(5),
            direction: direction(fields[6]),
        };
        let found = model(fields[0]).predict(&state).force_n();
        let found = found.unwrap_or_else(|| panic!("{line}: no force"));
        let expected = number(7);
        assert!(
            (found - expected).abs() <= 1e-8 * (1.0 + expected),
            "{line}: {found}"
        );
        *states.entry(fields[0]).or_default() += 1;
    }
    for model in published() {
        let count = states.get(model.id()).copied().unwrap_or(0);
        assert!(count >= 40, "{}: {count} states", model.id());
    }
}
