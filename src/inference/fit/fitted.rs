//! A fitted model, and what follows from it at once.

use super::{Free, Setting};
use crate::gram::{Design, Gram, Square};
use crate::problem::Point;
use crate::system::{Factor, Likelihood, Variances};
use crate::variance::{Effort, Prior, Scale};

/// A fitted model; everything else is a query of it.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Coefficients, terms and random effects.
    pub point: Point,
    /// Standard deviations (full likelihood).
    pub variances: Variances,
    /// Marginal log-likelihood with the priors of the misfit.
    pub log_likelihood: f64,
    /// The linear model of the last iteration: response less predictions, with the random effects added back.
    pub design: Design,
    /// Its sums over the active nodes.
    pub gram: Gram,
    /// The fixed effects of the design.
    pub free: Vec<Free>,
    /// Inverse curvature of the likelihood in the logarithms of the standard deviations.
    pub inverse: Vec<f64>,
    /// Predictions at the point, linear components left out.
    pub predicted: Vec<f64>,
    /// Whether the iteration ended by itself.
    pub converged: bool,
    /// Whether a coefficient ended at a bound.
    pub at_bound: Vec<bool>,
}

impl Fitted {
    /// The factor at the estimates.
    pub fn factor(&self) -> Factor<'_> {
        Factor::new(&self.design.tree, &self.gram, &self.variances)
    }

    /// The place among the fixed effects of a term's value.
    pub fn place(&self, term: usize, value: usize) -> Option<usize> {
        let t = self.point.terms.iter().position(|(k, _)| *k == term)?;
        self.free.iter().position(|f| *f == Free::Value(t, value))
    }

    /// The values of a term in the model.
    pub fn values(&self, term: usize) -> Option<&[f64]> {
        let found = self.point.terms.iter().find(|(k, _)| *k == term);
        found.map(|(_, values)| values.as_slice())
    }

    /// Where a fit without some groups starts: their random effects are 0.
    pub fn cleared(&self, setting: &Setting) -> Point {
        let tree = setting.problem.tree();
        let mut point = self.point.clone();
        for node in (0..tree.len()).filter(|n| !setting.active[*n]) {
            let first = tree.first_column(node);
            point.random[first..first + tree.width(node)].fill(0.0);
        }
        point
    }

    /// Variances by the restricted likelihood, from those of the full one.
    pub fn restricted(&self, setting: &Setting) -> Variances {
        self.estimated(setting, &setting.scales())
    }

    /// The same for draws and predictions: how groups of their own differ is never estimated as nothing ([`Prior::Away`]).
    pub fn predictive(&self, setting: &Setting) -> Variances {
        let mut scales = setting.scales();
        for (scale, component) in scales.iter_mut().zip(setting.problem.components()) {
            if let (true, Prior::HalfNormal(s)) = (component.calibrates, scale.prior) {
                scale.prior = Prior::Away(s);
            }
        }
        self.estimated(setting, &scales)
    }

    fn estimated(&self, setting: &Setting, scales: &[Scale]) -> Variances {
        // A component that has faded to nothing does not grow by itself.
        let starts = [self.variances.clone(), setting.widened(&self.variances)];
        setting
            .maximiser(scales, Likelihood::Restricted)
            .best(&self.gram, &starts, Effort::FULL)
            .variances
    }

    /// Covariance of the fixed effects at some variances.
    pub fn covariance(&self, variances: &Variances) -> Square {
        Factor::new(&self.design.tree, &self.gram, variances).fixed_covariance()
    }
}
