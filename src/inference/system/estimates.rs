//! Means and covariances of fixed and random effects, by substitution from the root down.

use super::Factor;
use super::kernels::{add_times, dot};
use super::triangular::{back_substitute, forward};
use crate::gram::Square;

/// Means of fixed and random effects given the readings.
#[derive(Clone, Debug)]
pub struct Estimates {
    /// Fixed effects.
    pub fixed: Vec<f64>,
    /// Random effects, all columns, in units of their component (not scaled).
    pub random: Vec<f64>,
}

impl Factor<'_> {
    /// The fixed effects by generalised least squares; 0 where a column is spanned by others.
    pub fn fixed(&self) -> Vec<f64> {
        back_substitute(&self.fixed_lower, &self.fixed_response)
    }

    /// (X'V^-1 X)^-1.
    pub fn fixed_covariance(&self) -> Square {
        let n = self.gram.fixed;
        let mut inverse = Square::zeros(n);
        for j in 0..n {
            if self.fixed_lower.at(j, j) == 0.0 {
                continue;
            }
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let half = forward(&self.fixed_lower, &unit);
            for (i, v) in back_substitute(&self.fixed_lower, &half)
                .into_iter()
                .enumerate()
            {
                *inverse.at_mut(i, j) = v;
            }
        }
        inverse
    }

    /// Means alone, given the variances.
    pub fn estimates(&self) -> Estimates {
        let tree = self.tree;
        let fixed = self.fixed();
        let mut random = vec![0.0; tree.columns()];
        // For each node e of its path, see [`Self::gradient`].
        let mut known: Vec<Vec<f64>> = Vec::with_capacity(tree.len());
        let at_root: Vec<f64> = fixed.iter().copied().chain([-1.0]).collect();
        for node in 0..tree.len() {
            let above = if node == 0 {
                &at_root
            } else {
                &known[tree.parent(node)]
            };
            let rows = self.solved(node, above.len());
            let own = rows.chunks_exact(above.len()).map(|row| -dot(row, above));
            let first = tree.above(node);
            let here: Vec<f64> = above[..first].iter().copied().chain(own).collect();
            for (k, c) in tree.components_of(node).enumerate() {
                random[tree.first_column(node) + k] =
                    here[first + k] * self.variances.components[c];
            }
            let here = here.into_iter().chain(above[first..].iter().copied());
            known.push(here.collect());
        }
        Estimates { fixed, random }
    }

    /// Covariance of the random effects of the root, in units of their component, and of the fixed effects, given the readings.
    pub fn covariance_at_root(&self) -> Square {
        let fixed = self.fixed_covariance();
        let (n, width) = (fixed.n, self.tree.width(0));
        // Nothing is open of the response.
        let mut above = Square::zeros(n + 1);
        for i in 0..n {
            above.a[i * (n + 1)..i * (n + 1) + n].copy_from_slice(&fixed.a[i * n..(i + 1) * n]);
        }
        let open = self.own_effects(0).expected(&above, 0);
        let components = self.tree.components_of(0);
        let mut scales: Vec<f64> = components.map(|c| self.variances.components[c]).collect();
        scales.resize(width + n, 1.0);
        let mut covariance = Square::zeros(width + n);
        for i in 0..width + n {
            for j in 0..width + n {
                *covariance.at_mut(i, j) = scales[i] * scales[j] * open.at(i, j);
            }
        }
        covariance
    }

    /// L^-T times what a node's rows hold beside it: columns above, fixed effects, response.
    pub(super) fn solved(&self, node: usize, stride: usize) -> Vec<f64> {
        let eliminated = &self.nodes[node];
        let width = self.tree.width(node);
        if eliminated.idle {
            return vec![0.0; width * stride];
        }
        let mut a = eliminated.rest.clone();
        for k in (0..width).rev() {
            let (head, below) = a.split_at_mut((k + 1) * stride);
            let row = &mut head[k * stride..];
            for l in k + 1..width {
                let known = &below[(l - k - 1) * stride..(l - k) * stride];
                add_times(row, -eliminated.lower.at(l, k), known);
            }
            let pivot = 1.0 / eliminated.lower.at(k, k);
            for v in row {
                *v *= pivot;
            }
        }
        a
    }
}
