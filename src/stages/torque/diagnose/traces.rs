//! What the design can show: the trace that every effect leaves in the torques, after the chosen sizes have been fitted anew.

use super::refit::{Reading, Sizes};
use super::search::effective;
use crate::numerics::distributions::student_t_quantile;
use crate::numerics::matrix::{dot, norm};

/// Cosine from which two effects cannot be told apart.
pub const ALIKE: f64 = 0.9;
/// Visible share below which an effect cannot be measured.
pub const VISIBLE: f64 = 0.05;

/// The traces at a fit.
pub struct Traces {
    of: Vec<Vec<f64>>,
    chosen: Vec<usize>,
    /// Standard deviation of what is left, as if readings were independent but inflated by how much they are not, N.m.
    noise_nm: f64,
    units: f64,
}

impl Traces {
    /// Of readings, at a fit to them.
    pub fn new(readings: &[Reading], sizes: &Sizes) -> Self {
        let left = sizes.residuals(readings);
        let n = left.len() as f64;
        let inflated = n / effective(readings, &left);
        let freedom = (n - sizes.terms.len() as f64).max(1.0);
        let units: std::collections::BTreeSet<usize> = readings.iter().map(|r| r.unit).collect();
        Self {
            of: sizes.traces(readings),
            chosen: sizes.terms.clone(),
            noise_nm: (dot(&left, &left) / freedom * inflated).sqrt(),
            units: units.len() as f64,
        }
    }

    /// A trace less what the chosen terms but `without` can take up.
    fn projected(&self, term: usize, without: &[usize]) -> Vec<f64> {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let others = self.chosen.iter().filter(|t| !without.contains(t));
        for other in others.filter(|t| **t != term) {
            let mut direction = self.of[*other].clone();
            reduce(&mut direction, &basis);
            let length = norm(&direction);
            if length > 0.0 {
                direction.iter_mut().for_each(|x| *x /= length);
                basis.push(direction);
            }
        }
        let mut trace = self.of[term].clone();
        reduce(&mut trace, &basis);
        trace
    }

    /// The share of a trace that the refit leaves.
    pub fn visible(&self, term: usize) -> f64 {
        norm(&self.projected(term, &[])) / norm(&self.of[term])
    }

    /// The smallest size that would be significant among so many candidates; not finite where there is no trace.
    pub fn smallest(&self, term: usize, candidates: usize) -> f64 {
        let tail = 0.025 / candidates as f64;
        let t = student_t_quantile(1.0 - tail, (self.units - 1.0).max(1.0));
        t * self.noise_nm / norm(&self.projected(term, &[]))
    }

    /// Cosine between the traces of two terms, the other chosen terms refitted.
    pub fn cosine(&self, a: usize, b: usize) -> f64 {
        let (x, y) = (self.projected(a, &[b]), self.projected(b, &[a]));
        dot(&x, &y) / (norm(&x) * norm(&y))
    }
}

fn reduce(vector: &mut [f64], basis: &[Vec<f64>]) {
    for direction in basis {
        let along = dot(vector, direction);
        vector
            .iter_mut()
            .zip(direction)
            .for_each(|(v, d)| *v -= along * d);
    }
}
