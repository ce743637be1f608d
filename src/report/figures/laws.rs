//! What several figures draw: the laws of the force paper with published and fitted coefficients, the Festo tool, and the band of a fit.

use crate::figures::formatting::symbol;
use crate::wording::name::coefficient_state;
use pipeline_fit::engine::{CoefficientState, EquationFit};
use pipeline_mechanics::models::{Direction, ForceModel, Prediction, State, festo_tool::FestoTool};
use pipeline_numerics::jackknife;

/// The state of an actuator that is held at a contraction (fraction) and gauge pressure in kPa; lengths in m.
pub fn state(
    diameter_mm: u32,
    rest_length_m: f64,
    contraction_620: f64,
    contraction: f64,
    pressure_kpa: f64,
) -> State {
    State {
        diameter_mm: f64::from(diameter_mm),
        rest_length_m,
        contracted_length_m: rest_length_m * (1.0 - contraction_620),
        length_m: rest_length_m * (1.0 - contraction),
        pressure_kpa,
        direction: Direction::Isometric,
    }
}

/// The force of the Festo tool at a contraction (fraction), N; NaN beyond its tables.
pub fn festo(diameter_mm: u32, contraction: f64, pressure_kpa: f64) -> f64 {
    // Any actuator will do: the tool has one table for all lengths.
    let state = state(diameter_mm, 0.3, 0.2, contraction, pressure_kpa);
    match FestoTool.predict(&state) {
        Prediction::Force(force) => force,
        _ => f64::NAN,
    }
}

/// Why the curve of a fit would mislead, in words with Typst markup; `None` where every coefficient was found inside its bounds.
///
/// A coefficient at a bound or held is no result: with `b_2` at its upper bound the law of length is a step.
pub fn misleading(fit: &EquationFit) -> Option<String> {
    let of = fit.coefficients.iter().find(|c| c.state.is_no_result())?;
    let state = coefficient_state(&of.state);
    Some(format!("{} is {state}", symbol(&of.symbol)))
}

/// Whether all coefficients have an interval from the refits: none is open and no refit held one.
pub fn has_band(fit: &EquationFit) -> bool {
    fit.folds.len() >= jackknife::FEWEST_GROUPS
        && fit.folds.iter().all(|f| f.held.is_empty())
        && fit
            .coefficients
            .iter()
            .all(|c| matches!(c.state, CoefficientState::Ok | CoefficientState::Unmoved))
}

/// A band: `x`, lower and upper value.
pub type Band = Vec<(f64, f64, f64)>;

/// The band of a fit's curve from its refits without each specimen. Empty where there is none.
pub fn band(
    fit: &EquationFit,
    places: &[f64],
    confidence: f64,
    curve: impl Fn(&[f64], f64) -> f64,
) -> Band {
    if !has_band(fit) {
        return Vec::new();
    }
    let values = fit.values();
    let at = |x: &f64| {
        let refits: Vec<f64> = fit
            .folds
            .iter()
            .map(|f| curve(&f.coefficients, *x))
            .collect();
        let middle = curve(&values, *x);
        let half = jackknife::half_width(middle, &refits, confidence)?;
        Some((*x, middle - half, middle + half))
    };
    places.iter().filter_map(at).collect()
}

/// Equally spaced places from `low` to `high`, both among them.
pub fn places(low: f64, high: f64, steps: u32) -> Vec<f64> {
    (0..=steps)
        .map(|k| low + (high - low) * f64::from(k) / f64::from(steps))
        .collect()
}
