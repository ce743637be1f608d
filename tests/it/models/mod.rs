//! Tests of the force models: the published check values, agreement with an independent implementation, and what holds for every
//! model of the list.

mod conformance;
mod martens_maps;
mod published_values;
mod reference_implementation;
mod structure;

use pipeline::models::{Direction, ForceModel, Prediction, State, published};

/// An isometric state by its relative numbers.
pub fn state(
    diameter_mm: f64,
    rest_length_m: f64,
    eps_620: f64,
    eps: f64,
    pressure_kpa: f64,
) -> State {
    State {
        diameter_mm,
        rest_length_m,
        contracted_length_m: rest_length_m * (1.0 - eps_620),
        length_m: rest_length_m * (1.0 - eps),
        pressure_kpa,
        direction: Direction::Isometric,
    }
}

/// The model of the list with this id.
pub fn model(id: &str) -> &'static dyn ForceModel {
    let found = published().into_iter().find(|m| m.id() == id);
    found.unwrap_or_else(|| panic!("no model {id}"))
}

/// The force a model predicts, extrapolated or not.
pub fn force(id: &str, state: &State) -> f64 {
    match model(id).predict(state) {
        Prediction::OutsideDomain { why } => panic!("{id} at {state:?}: {why}"),
        answer => answer.force_n().unwrap(),
    }
}

/// Asserts agreement within half a unit of the last printed digit.
pub fn assert_printed(found: f64, printed: &str) {
    let digits = printed.split('.').nth(1).map_or(0, str::len);
    let expected: f64 = printed.parse().unwrap();
    let half: f64 = format!("0.5e-{digits}").parse().unwrap();
    assert!(
        (found - expected).abs() <= half + 1e-12,
        "{found} is not {printed}"
    );
}
