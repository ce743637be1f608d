//! What the design can show: the trace that every effect leaves in the torques, after the chosen sizes, and what tests and actuators have of their
//! own, have been fitted anew.

use super::nuisance::{FINEST_NM, Nuisance, WORTH, reduce};
use super::refit::Sizes;
use super::search::Sample;
use super::terms::TERMS;
use crate::numerics::distributions::student_t_quantile;
use crate::numerics::matrix::{dot, norm};
use std::collections::BTreeSet;

/// Cosine from which two effects cannot be told apart.
pub const ALIKE: f64 = 0.9;
/// Visible share below which an effect cannot be measured.
pub const VISIBLE: f64 = 0.05;
/// Share of the cases in which the smallest detectable size is found.
const POWER: f64 = 0.8;

/// The traces at a fit.
pub struct Traces {
    /// As they are, one a term.
    plain: Vec<Vec<f64>>,
    /// Less what is their tests' and actuators' own.
    of: Vec<Vec<f64>>,
    chosen: Vec<usize>,
    /// Standard deviation of what is left, inflated by how much readings of one stretch are alike, N.m.
    noise_nm: f64,
    /// Degrees of freedom of that noise: of the effective number of readings, and at least of the stretches.
    freedom_of_readings: f64,
    tests: f64,
}

impl Traces {
    /// Of readings, at a fit to them.
    pub fn new(sample: &Sample, sizes: &Sizes) -> Self {
        let readings = sample.readings;
        let n = readings.len() as f64;
        let effective = sample.effective(sizes);
        let terms = sizes.terms.len() as f64;
        let inflated = n / effective;
        let freedom = (n - terms).max(1.0);
        let plain = sizes.traces(readings);
        let nuisance = Nuisance::of(readings, sample.spreads);
        let units: BTreeSet<usize> = readings.iter().map(|r| r.unit).collect();
        let tests: BTreeSet<usize> = readings.iter().map(|r| r.test).collect();
        Self {
            of: plain.iter().map(|t| nuisance.left(t)).collect(),
            plain,
            chosen: sizes.terms.clone(),
            noise_nm: (sizes.left / freedom * inflated).sqrt().max(FINEST_NM),
            freedom_of_readings: (effective - terms).max(units.len() as f64 - 1.0).max(1.0),
            tests: tests.len() as f64,
        }
    }

    /// A trace less what the chosen terms but `without` can take up.
    fn projected(&self, of: &[Vec<f64>], term: usize, without: &[usize]) -> Vec<f64> {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let others = self.chosen.iter().filter(|t| !without.contains(t));
        for other in others.filter(|t| **t != term) {
            let mut direction = of[*other].clone();
            reduce(&mut direction, &basis);
            let length = norm(&direction);
            if length > 0.0 {
                direction.iter_mut().for_each(|x| *x /= length);
                basis.push(direction);
            }
        }
        let mut trace = of[term].clone();
        reduce(&mut trace, &basis);
        trace
    }

    /// The share of a trace that the refit leaves.
    pub fn visible(&self, term: usize) -> f64 {
        norm(&self.projected(&self.of, term, &[])) / norm(&self.of[term])
    }

    /// Standard error of a size.
    pub fn error(&self, term: usize) -> f64 {
        self.noise_nm / norm(&self.projected(&self.of, term, &[]))
    }

    /// Degrees of freedom of a standard error of this size (Satterthwaite): that part of it which tests and actuators bring in is known from
    /// as many of them as there are, the rest from the effective number of readings.
    pub fn freedom(&self, term: usize, error: f64) -> f64 {
        let alone = self.noise_nm / norm(&self.projected(&self.plain, term, &[]));
        let of_readings = (alone / error).min(1.0);
        let readings = of_readings * of_readings;
        let own = 1.0 - readings;
        let sum =
            readings * readings / self.freedom_of_readings + own * own / (WORTH + self.tests - 1.0);
        1.0 / sum
    }

    /// The smallest size that would be significant among so many candidates in 80 of 100 cases; not finite where there is no trace.
    pub fn smallest(&self, term: usize, candidates: usize) -> f64 {
        let tail = 0.025 / candidates as f64;
        let error = self.error(term);
        let quantile = |p: f64| student_t_quantile(p, self.freedom(term, error));
        (quantile(1.0 - tail) + quantile(POWER)) * error
    }

    /// Whether a term changes any of the readings.
    pub fn is_there(&self, term: usize) -> bool {
        norm(&self.plain[term]) > 0.0
    }

    /// Cosine between the traces of two terms, the other chosen terms refitted; as the torques have them, whatever is their tests' own.
    pub fn cosine(&self, a: usize, b: usize) -> f64 {
        let (x, y) = (
            self.projected(&self.plain, a, &[b]),
            self.projected(&self.plain, b, &[a]),
        );
        dot(&x, &y) / (norm(&x) * norm(&y))
    }

    /// The cosines of a term with all others.
    pub fn alike(&self, term: usize) -> [bool; TERMS] {
        std::array::from_fn(|other| other == term || self.cosine(term, other).abs() > ALIKE)
    }
}
