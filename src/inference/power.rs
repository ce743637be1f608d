//! How strong a direction has to be to be found.
//!
//! A search compares likelihoods with the variances estimated again. Without the direction they grow until they take it up in part, the more so the
//! fewer values there are from which they are estimated. With a likelihood ratio r at known variances and n independent values of one variance
//! what is left is n ln(1 + r/n), as in Student's test. Where several variances take part, n follows from the second order: a direction of unit
//! length has the score s by the logarithms of the standard deviations, these have the curvature H, and the ratio falls by r^2 s'H^-1 s.

use crate::fit::{Fitted, Setting};
use crate::system::{Likelihood, dot};
use crate::variance::Maximiser;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::Matrix;

/// Normal deviate of a power of 80%.
const POWER: f64 = 0.841_621_233_572_914;
/// Step of a logarithm by which curvatures are differences of slopes.
const STEP: f64 = 1e-3;

/// The strength that directions beside a model must have.
pub struct Power<'a> {
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    curvature: Cholesky,
    /// Slopes of the log-likelihood of a response of nothing.
    of_nothing: Vec<f64>,
}

impl<'a> Power<'a> {
    /// Beside a fitted model.
    pub fn new(setting: &'a Setting<'a>, model: &'a Fitted) -> Self {
        let scales = setting.scales();
        let maximiser = setting.maximiser(&scales, Likelihood::Full);
        let at = maximiser.variables(&model.variances);
        let slopes = |k: usize, step: f64| {
            let mut there = at.clone();
            there[k] += step;
            maximiser.value_and_gradient(&model.gram, &there).1
        };
        let mut curvature = Matrix::zeros(at.len(), at.len());
        for k in 0..at.len() {
            let (below, above) = (slopes(k, -STEP), slopes(k, STEP));
            for j in 0..at.len() {
                let by_both = 0.5 * (below[j] - above[j]) / (2.0 * STEP);
                curvature[(j, k)] += by_both;
                curvature[(k, j)] += by_both;
            }
        }
        Self {
            of_nothing: slopes_of(&maximiser, model, &vec![0.0; model.design.y.len()]),
            curvature: Cholesky::new(&curvature),
            setting,
            model,
        }
    }

    /// From how many independent values the variances are estimated that could take a direction up, given its length at known variances.
    fn values(&self, column: &[f64], length: f64) -> f64 {
        let unit: Vec<f64> = column.iter().map(|x| x / length).collect();
        let scales = self.setting.scales();
        let maximiser = self.setting.maximiser(&scales, Likelihood::Full);
        let slopes = slopes_of(&maximiser, self.model, &unit);
        let score: Vec<f64> = slopes
            .iter()
            .zip(&self.of_nothing)
            .map(|(with, without)| with - without)
            .collect();
        let whitened = self.curvature.forward(&score);
        0.5 / dot(&whitened, &whitened)
    }

    /// Size of a direction that is found with a probability of 80%, where likelihood ratios from `ratio` on are accepted. `length` is that of
    /// its whitened column after projection, per unit of size.
    pub fn smallest(&self, column: &[f64], length: f64, ratio: f64) -> f64 {
        let left = at_known_variances(ratio, 1.0);
        needed(left * left, self.values(column, length)).sqrt() / length
    }
}

/// Size of a direction that is found with a probability of 80% where the variances are known.
pub fn at_known_variances(ratio: f64, length: f64) -> f64 {
    (ratio.sqrt() + POWER) / length
}

/// The likelihood ratio at known variances of which `left` is left with variances from `values` independent values.
fn needed(left: f64, values: f64) -> f64 {
    if values.is_finite() {
        values * libm::expm1(left / values)
    } else {
        left
    }
}

/// Slopes of the log-likelihood by the logarithms of the standard deviations, for another response.
fn slopes_of(maximiser: &Maximiser, model: &Fitted, response: &[f64]) -> Vec<f64> {
    let gram = model.design.with_response_of(&model.gram, &[], response);
    let at = maximiser.variables(&model.variances);
    maximiser.value_and_gradient(&gram, &at).1
}
