//! How strong a direction has to be to be found.
//!
//! A search compares likelihoods with the variances estimated again. Without the direction they grow until they take it up in part, the more so the
//! fewer values there are from which they are estimated. With a likelihood ratio r at known variances and n independent values of one variance
//! what is left is n ln(1 + r/n), as in Student's test. Where several variances take part, n follows from the second order: a direction of unit
//! length has the score s by the logarithms of the standard deviations, these have the curvature H, and the ratio falls by r^2 s'H^-1 s.
//!
//! The coefficients of a nonlinear law take up more than its tangent says. [`strength`] puts a term into the readings and fits the model without
//! it again.

use crate::decisions::POWER_80;
use crate::fit::{Fitted, Setting};
use crate::problem::{Coefficient, Component, Direction, Linearised, Point, Problem, Term};
use crate::system::{Likelihood, dot};
use crate::tree::Tree;
use crate::variance::{Maximiser, Scale};
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::Matrix;

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
        let left = wanted(ratio);
        needed(left * left, self.values(column, length)).sqrt() / length
    }
}

/// By how many standard errors a term would show, were it in the readings with some values: the model without it is fitted again to readings that
/// hold it. With values of either sign, what the readings as they are show by chance cancels.
pub fn strength(setting: &Setting, model: &Fitted, term: usize, values: &[Vec<f64>]) -> f64 {
    let lost: f64 = values.iter().map(|v| lost(setting, model, term, v)).sum();
    (lost / values.len() as f64).max(0.0).sqrt()
}

/// Twice what a term gains over a model without it, if it is put into the readings. Both are fitted to these: a term that changes the scale of the
/// forces changes the likelihood of everything else as well.
fn lost(setting: &Setting, model: &Fitted, term: usize, values: &[f64]) -> f64 {
    let problem = setting.problem;
    let mut with = model.point.clone();
    with.terms.push((term, values.to_vec()));
    let changed = problem.predict(&with).into_iter().zip(&model.predicted);
    let readings = problem.observed().iter().zip(changed);
    let altered = Altered {
        observed: readings
            .map(|(y, (with, without))| y + with - without)
            .collect(),
        problem,
    };
    let there = Setting {
        problem: &altered,
        ..setting.clone()
    };
    let starts = [model.variances.clone(), setting.widened(&model.variances)];
    let without = there.glance(&model.point, &starts);
    // Where it starts it is nearly right.
    let with = there.glance(&with, &starts[..1]);
    2.0 * (with.log_likelihood - without.log_likelihood)
}

/// A problem with other readings.
struct Altered<'a> {
    problem: &'a dyn Problem,
    observed: Vec<f64>,
}

impl Problem for Altered<'_> {
    fn tree(&self) -> &Tree {
        self.problem.tree()
    }
    fn node(&self) -> &[usize] {
        self.problem.node()
    }
    fn class(&self) -> &[usize] {
        self.problem.class()
    }
    fn noise(&self) -> &[Scale] {
        self.problem.noise()
    }
    fn observed(&self) -> &[f64] {
        &self.observed
    }
    fn components(&self) -> &[Component] {
        self.problem.components()
    }
    fn coefficients(&self) -> &[Coefficient] {
        self.problem.coefficients()
    }
    fn terms(&self) -> &[Term] {
        self.problem.terms()
    }
    fn predict(&self, point: &Point) -> Vec<f64> {
        self.problem.predict(point)
    }
    fn linearise(&self, point: &Point) -> Linearised {
        self.problem.linearise(point)
    }
    fn directions(&self, point: &Point) -> Vec<Direction> {
        self.problem.directions(point)
    }
    fn bends(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        self.problem.bends(point, term)
    }
}

/// How many standard errors a term must show to be found with a probability of 80%, where likelihood ratios from `ratio` on are accepted.
pub fn wanted(ratio: f64) -> f64 {
    ratio.sqrt() + POWER_80
}

/// Size of a direction that is found with a probability of 80% where the variances are known.
pub fn at_known_variances(ratio: f64, length: f64) -> f64 {
    wanted(ratio) / length
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
