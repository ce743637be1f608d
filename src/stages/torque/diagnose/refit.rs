//! Readings of one joint, and least squares of any set of terms on any part of them.

use super::operator::{At, Joint};
use super::terms::{ALL, TERMS};
use crate::numerics::dual_problem::DualProblem;
use crate::numerics::fit::{Options, ParameterState, fit};
use crate::numerics::real::{Dual, Real};

/// A reading of torque.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The joint.
    pub joint: Joint<'a>,
    /// Angle and pressure.
    pub at: At,
    /// Measured torque, N.m.
    pub torque_nm: f64,
    /// Which actuator, test and unit of resampling.
    pub actuator: usize,
    /// See `actuator`.
    pub test: usize,
    /// See `actuator`: the test, or a stretch of angles where there are too few tests.
    pub unit: usize,
}

/// Sizes of a set of terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Places of the terms in [`ALL`], ascending.
    pub terms: Vec<usize>,
    /// One a term of [`ALL`]; 0 for those that are not in the set.
    pub values: [f64; TERMS],
    /// Whether every size lies inside its bounds and is determined.
    pub inside: bool,
    /// Sum of squares of what was fitted, (N.m)^2.
    pub sse: f64,
}

impl Sizes {
    /// The rigid leg.
    pub fn rigid(readings: &[Reading]) -> Self {
        let mut rigid = Self {
            terms: Vec::new(),
            values: [0.0; TERMS],
            inside: true,
            sse: 0.0,
        };
        rigid.sse = rigid.residuals(readings).iter().map(|r| r * r).sum();
        rigid
    }

    /// The least-squares sizes of `terms`, a descent from each of their starts or from `from`.
    pub fn of(terms: &[usize], readings: &[Reading], from: Option<&Sizes>) -> Self {
        if terms.is_empty() {
            return Self::rigid(readings);
        }
        let measured: Vec<f64> = readings.iter().map(|r| r.torque_nm).collect();
        let mut held = [Some(0.0); TERMS];
        terms.iter().for_each(|t| held[*t] = None);
        let model = |k: usize, p: &[Dual<TERMS>; TERMS]| {
            let reading = &readings[k];
            reading.joint.torque(&reading.at, p).0
        };
        let problem = DualProblem::new(&measured, model).with_held(held);
        let options = Options {
            bounds: Some(terms.iter().map(|t| ALL[*t].bounds).collect()),
            max_iterations: 60,
            tolerance: 1e-7,
            polish: false,
            ..Options::default()
        };
        let known = |t: &usize| from.map(|f| f.values[*t]).filter(|v| *v != 0.0);
        let start: Vec<f64> = terms
            .iter()
            .map(|t| known(t).unwrap_or(ALL[*t].start))
            .collect();
        let found = fit(&problem, &start, &options);
        let mut values = [0.0; TERMS];
        for (t, value) in terms.iter().zip(&found.parameters) {
            values[*t] = *value;
        }
        let determined = |s: &ParameterState| *s == ParameterState::Ok;
        Self {
            terms: terms.to_vec(),
            values,
            inside: found.states.iter().all(determined),
            sse: if found.sse.is_finite() {
                found.sse
            } else {
                f64::INFINITY
            },
        }
    }

    /// Predicted torque and arm of a reading, N.m and m.
    pub fn predict(&self, reading: &Reading) -> (f64, f64) {
        reading.joint.torque(&reading.at, &self.values)
    }

    /// Measured less predicted, N.m.
    pub fn residuals(&self, readings: &[Reading]) -> Vec<f64> {
        let residual = |r: &Reading| r.torque_nm - self.predict(r).0;
        readings.iter().map(residual).collect()
    }

    /// The derivative of every reading's torque by the size of every term, here: one list a term.
    pub fn traces(&self, readings: &[Reading]) -> Vec<Vec<f64>> {
        let seeded: [Dual<TERMS>; TERMS] =
            std::array::from_fn(|t| Dual::variable(self.values[t], t));
        let all: Vec<Dual<TERMS>> = readings
            .iter()
            .map(|r| r.joint.torque(&r.at, &seeded).0)
            .collect();
        let of = |t: usize| all.iter().map(|d| d.gradient[t]).collect();
        (0..TERMS).map(of).collect()
    }
}

/// Whether every derivative and value of a reading is a number: others take no part.
pub fn is_answered(reading: &Reading) -> bool {
    let rigid = [0.0; TERMS].map(<f64 as Real>::constant);
    reading.torque_nm.is_finite() && reading.joint.torque(&reading.at, &rigid).0.is_finite()
}
