//! The linear mixed model at a point: its free variables, its columns, its response.

use super::Setting;
use crate::gram::{Design, Gram, Square};
use crate::problem::{Linearised, Point};
use crate::system::dot;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::Matrix;
use std::sync::Arc;

/// A free variable of the fixed part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// A coefficient.
    Coefficient(usize),
    /// A value of a term in the model: place among [`Point::terms`], number of the value.
    Value(usize, usize),
}

impl Setting<'_> {
    pub(super) fn free(&self, point: &Point, held: &[Free]) -> Vec<Free> {
        let coefficients = self.problem.coefficients().iter().enumerate();
        let mut free: Vec<Free> = coefficients
            .filter(|(_, c)| c.free)
            .map(|(k, _)| Free::Coefficient(k))
            .collect();
        for (t, (_, values)) in point.terms.iter().enumerate() {
            free.extend((0..values.len()).map(|k| Free::Value(t, k)));
        }
        free.retain(|f| !held.contains(f) && !self.pinned.contains(f));
        free
    }

    /// The linear mixed model at a point; takes the columns of the random effects.
    pub(super) fn design(&self, point: &Point, linear: &mut Linearised, free: &[Free]) -> Design {
        let problem = self.problem;
        let tree = problem.tree();
        let nonlinear = self.nonlinear_columns();
        let paths: Vec<Vec<usize>> = (0..tree.len()).map(|n| tree.path_numbers(n)).collect();
        let y = (0..linear.predicted.len())
            .map(|i| {
                let path = &paths[problem.node()[i]];
                let own: f64 = path
                    .iter()
                    .zip(&linear.random[i])
                    .filter(|(c, _)| nonlinear[**c])
                    .map(|(c, z)| z * point.random[*c])
                    .sum();
                problem.observed()[i] - linear.predicted[i] + own
            })
            .collect();
        Design {
            tree: tree.clone(),
            node: problem.node().to_vec(),
            class: problem.class().to_vec(),
            classes: problem.noise().len(),
            z: Arc::new(std::mem::take(&mut linear.random)),
            x: free
                .iter()
                .map(|f| column(point, linear, *f).to_vec())
                .collect(),
            y,
        }
    }

    /// The sums over the active nodes.
    pub fn sums(&self, design: &Design) -> Gram {
        design.gram_of(|n| self.active[n])
    }

    /// For each column of the tree whether the forward model is nonlinear in it.
    pub fn nonlinear_columns(&self) -> Vec<bool> {
        let tree = self.problem.tree();
        let components = self.problem.components();
        (0..tree.len())
            .flat_map(|n| tree.components_of(n))
            .map(|c| !components[c].linear)
            .collect()
    }
}

fn column<'l>(point: &Point, linear: &'l Linearised, free: Free) -> &'l [f64] {
    match free {
        Free::Coefficient(k) => &linear.by_coefficients[k],
        Free::Value(t, k) => {
            let before: usize = point.terms[..t].iter().map(|(_, v)| v.len()).sum();
            &linear.by_terms[before + k]
        }
    }
}

/// By how much the log-likelihood at a point is below that of its linear model, whose estimates are `step` away: nothing at a fixed point.
pub(super) fn short_of(covariance: &Square, step: &[f64]) -> f64 {
    let n = step.len();
    if n == 0 {
        return 0.0;
    }
    let mut matrix = Matrix::zeros(n, n);
    for j in 0..n {
        for (i, x) in matrix.column_mut(j).iter_mut().enumerate() {
            *x = covariance.at(i, j);
        }
    }
    0.5 * dot(step, &Cholesky::new(&matrix).solve(step))
}
