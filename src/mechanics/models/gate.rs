//! The gate that a model passes before it is compared: it reproduces what its authors published.
//!
//! A model gives its own [`Reference`]s, measured maps or check values, with the miss that is allowed; [`gate`] evaluates the model at them.
//! A model without any is compared all the same and the report says that nothing could be checked; one that misses its own numbers is not.

use super::{ForceModel, State, published};

/// What a model has to reproduce.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// What the numbers are and how the model was set up for them.
    pub against: &'static str,
    /// States with the published force, N.
    pub points: Vec<(State, f64)>,
    /// The largest miss that the authors claim, a fraction of the largest force.
    pub claimed: Option<f64>,
    /// The largest miss that is allowed, a fraction of the largest force.
    pub allowed: f64,
}

/// The outcome for one reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// Model id.
    pub model: &'static str,
    /// Model title.
    pub title: &'static str,
    /// Nominal diameter, mm; 0 where the model has no reference.
    pub diameter_mm: u32,
    /// What was reproduced; empty where there is nothing.
    pub against: &'static str,
    /// Number of values.
    pub values: usize,
    /// Largest miss, a fraction of the largest force; states without an answer count as a miss of 1.
    pub miss: f64,
    /// The authors' claim.
    pub claimed: Option<f64>,
    /// The largest miss allowed.
    pub allowed: f64,
    /// Where the model holds.
    pub domain: &'static str,
}

impl Gate {
    /// Whether the model may be compared.
    pub fn passes(&self) -> bool {
        self.values == 0 || self.miss <= self.allowed
    }
}

/// Every published model at its references.
pub fn gate() -> Vec<Gate> {
    published().into_iter().flat_map(of_model).collect()
}

/// Whether a model reproduces all of its references for a diameter.
pub fn passes(model: &dyn ForceModel, diameter_mm: u32) -> bool {
    of_model(model)
        .iter()
        .filter(|g| g.diameter_mm == diameter_mm)
        .all(Gate::passes)
}

fn of_model(model: &dyn ForceModel) -> Vec<Gate> {
    let entry = |reference: Option<&Reference>| Gate {
        model: model.id(),
        title: model.title(),
        diameter_mm: reference.map_or(0, |r| r.diameter_mm),
        against: reference.map_or("", |r| r.against),
        values: reference.map_or(0, |r| r.points.len()),
        miss: reference.map_or(f64::NAN, |r| largest_miss(model, &r.points)),
        claimed: reference.and_then(|r| r.claimed),
        allowed: reference.map_or(f64::NAN, |r| r.allowed),
        domain: model.domain(),
    };
    let references = model.references();
    if references.is_empty() {
        return vec![entry(None)];
    }
    references.iter().map(|r| entry(Some(r))).collect()
}

fn largest_miss(model: &dyn ForceModel, points: &[(State, f64)]) -> f64 {
    let largest = points.iter().fold(0.0, |m: f64, p| m.max(p.1));
    points.iter().fold(0.0, |worst: f64, (state, force)| {
        let miss = model
            .predict(state)
            .force_n()
            .map_or(1.0, |found| (found - force).abs() / largest);
        worst.max(miss)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_that_has_references_reproduces_them() {
        for gate in gate() {
            assert!(gate.passes(), "{gate:?}");
        }
    }

    #[test]
    fn a_wrong_value_is_a_miss_and_no_answer_is_the_largest() {
        let model = published()[0];
        let state = State::relative(10, 0.182, 0.17, 0.5, 620.0);
        let force = model.predict(&state).force_n().unwrap();
        let miss = largest_miss(model, &[(state, 2.0 * force)]);
        assert!((miss - 0.5).abs() < 1e-12);
        let stretched = State::relative(10, 0.182, f64::NAN, 0.5, 620.0);
        assert_eq!(largest_miss(model, &[(stretched, force)]), 1.0);
    }
}
