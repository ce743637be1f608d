//! Readings of one joint, and least squares of any set of terms on any part of them.

use super::nuisance::{Nuisance, Spreads};
use super::operator::{At, Joint};
use super::terms::{ALL, MOST, TERMS, place};
use crate::numerics::fit::{Options, ParameterState, fit};
use crate::numerics::levenberg_marquardt::LeastSquaresProblem;
use crate::numerics::matrix::Matrix;
use crate::numerics::real::{Dual, Real};
use crate::numerics::statistics::sum_of_squares;
use std::cell::RefCell;

/// A reading of torque.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The joint.
    pub joint: Joint<'a>,
    /// Angle, pressure and how the joint came there.
    pub at: At,
    /// Measured torque, N.m.
    pub torque_nm: f64,
    /// Which actuator, test and unit of resampling.
    pub actuator: usize,
    /// See `actuator`.
    pub test: usize,
    /// See `actuator`: a stretch of the angles of one test.
    pub unit: usize,
    /// Torque for a millimetre of the test's own length (N.m/mm), and for the actuator's own strength (N.m): see [`super::nuisance`].
    pub own: [f64; 2],
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
    /// The same after tests and actuators have been given what is their own, with what that costs, (N.m)^2.
    pub left: f64,
}

impl Sizes {
    /// The rigid leg.
    pub fn rigid(readings: &[Reading], spreads: &Spreads) -> Self {
        let rigid = Self {
            terms: Vec::new(),
            values: [0.0; TERMS],
            inside: true,
            sse: 0.0,
            left: 0.0,
        };
        rigid.judged(readings, spreads)
    }

    /// The sizes of `terms` that leave least, a descent from `from` or from the terms' starts.
    pub fn of(
        terms: &[usize],
        readings: &[Reading],
        spreads: &Spreads,
        from: Option<&Sizes>,
    ) -> Self {
        if terms.is_empty() {
            return Self::rigid(readings, spreads);
        }
        let problem = Problem {
            terms,
            readings,
            nuisance: Nuisance::of(readings, spreads),
            last: RefCell::new(None),
        };
        let options = Options {
            bounds: Some(terms.iter().map(|t| ALL[*t].bounds).collect()),
            max_iterations: 60,
            tolerance: 1e-6,
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
        let sizes = Self {
            terms: terms.to_vec(),
            values,
            inside: found.states.iter().all(determined),
            sse: 0.0,
            left: 0.0,
        };
        sizes.judged(readings, spreads)
    }

    /// With the sums of squares that it leaves.
    fn judged(mut self, readings: &[Reading], spreads: &Spreads) -> Self {
        let residuals = self.residuals(readings);
        let finite = |x: f64| if x.is_finite() { x } else { f64::INFINITY };
        self.sse = finite(sum_of_squares(&residuals));
        let left = Nuisance::of(readings, spreads).left(&residuals);
        self.left = finite(sum_of_squares(&left));
        self
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

    /// The readings with what a test's own length and an actuator's own strength give to them, here.
    pub fn with_own<'a>(&self, readings: &[Reading<'a>]) -> Vec<Reading<'a>> {
        let traces = self.traces(readings);
        let own = |k: usize| [traces[place::LENGTH][k], traces[place::GAIN][k]];
        let numbered = readings.iter().enumerate();
        numbered
            .map(|(k, r)| Reading { own: own(k), ..*r })
            .collect()
    }
}

/// The sizes of some terms on some readings.
struct Problem<'r, 'a> {
    terms: &'r [usize],
    readings: &'r [Reading<'a>],
    nuisance: Nuisance,
    /// The last point with its predictions: a descent asks for values and derivatives at the same one.
    last: RefCell<Option<(Vec<f64>, Vec<Dual<MOST>>)>>,
}

impl Problem<'_, '_> {
    fn predicted(&self, p: &[f64]) -> Vec<Dual<MOST>> {
        let mut sizes = [Dual::<MOST>::constant(0.0); TERMS];
        for (k, t) in self.terms.iter().enumerate() {
            sizes[*t] = Dual::variable(p[k], k);
        }
        let all = self.readings.iter();
        all.map(|r| r.joint.torque(&r.at, &sizes).0).collect()
    }
}

impl LeastSquaresProblem for Problem<'_, '_> {
    fn parameters(&self) -> usize {
        self.terms.len()
    }

    fn observations(&self) -> usize {
        self.readings.len() + self.nuisance.effects()
    }

    fn residuals(&self, p: &[f64], r: &mut [f64]) {
        let predicted = self.predicted(p);
        let pairs = self.readings.iter().zip(&predicted);
        let residuals: Vec<f64> = pairs.map(|(o, d)| o.torque_nm - d.value).collect();
        r.copy_from_slice(&self.nuisance.left(&residuals));
        *self.last.borrow_mut() = Some((p.to_vec(), predicted));
    }

    fn jacobian(&self, p: &[f64], j: &mut Matrix) {
        let last = self.last.borrow();
        let known = last.as_ref().filter(|(at, _)| at == p);
        let fresh = known.is_none().then(|| self.predicted(p));
        let predicted = known.map(|(_, d)| d).or(fresh.as_ref());
        for k in 0..p.len() {
            let of = predicted.into_iter().flatten();
            let trace: Vec<f64> = of.map(|d| d.gradient[k]).collect();
            j.column_mut(k).copy_from_slice(&self.nuisance.left(&trace));
        }
    }
}

/// Whether every derivative and value of a reading is a number: others take no part.
pub fn is_answered(reading: &Reading) -> bool {
    let rigid = [0.0; TERMS].map(<f64 as Real>::constant);
    reading.torque_nm.is_finite() && reading.joint.torque(&reading.at, &rigid).0.is_finite()
}
