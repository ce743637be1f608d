//! What goes into a fit and what comes out of it.

use std::fmt;

use super::loss::Loss;
use super::matrix::Matrix;

/// What to minimise, where, and how hard to try.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The loss of a scaled residual.
    pub loss: Loss,
    /// Scale of the residuals for a robust loss, in their unit; `None` estimates it anew at every pass. Least squares ignores it.
    pub scale: Option<f64>,
    /// Lower and upper bound of each parameter; infinite where there is none.
    pub bounds: Option<Vec<(f64, f64)>>,
    /// Largest number of trial points of one descent.
    pub max_iterations: usize,
    /// Relative change of the sum of squares or the parameters that ends a descent, before it is polished.
    pub tolerance: f64,
    /// Whether the end of a descent is polished to machine precision.
    pub polish: bool,
    /// Largest number of reweighted passes of a robust fit.
    pub max_passes: usize,
    /// Relative change of every parameter that ends the passes.
    pub pass_tolerance: f64,
}

impl Default for Options {
    /// Least squares without bounds, to machine precision.
    fn default() -> Self {
        Self {
            loss: Loss::LeastSquares,
            scale: None,
            bounds: None,
            max_iterations: 2000,
            tolerance: f64::EPSILON,
            polish: true,
            max_passes: 500,
            pass_tolerance: 1e-8,
        }
    }
}

/// How a fit ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Status {
    /// At a minimum that determines every parameter that is not at a bound.
    Converged,
    /// At a minimum, but the rows do not determine these parameters (indices, ascending).
    Singular {
        /// The parameters without a covariance.
        parameters: Vec<usize>,
    },
    /// No step helps although the gradient is not zero.
    Stalled,
    /// The limit on the iterations or passes was reached first.
    MaxIterations,
    /// The model or its derivatives are not finite at the starting point.
    NotFinite,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Status::Converged => f.write_str("converged"),
            Status::Singular { parameters } => {
                write!(
                    f,
                    "parameters {parameters:?} are not determined by the data"
                )
            }
            Status::Stalled => {
                f.write_str("stalled: no step helps although the gradient is not zero")
            }
            Status::MaxIterations => f.write_str("not converged within the iterations allowed"),
            Status::NotFinite => f.write_str("model not finite at the starting point"),
        }
    }
}

/// What became of one parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterState {
    /// Determined by the data, with a standard error.
    Ok,
    /// On its lower bound; held there by the covariance, hence without a standard error.
    AtLowerBound,
    /// On its upper bound; held there by the covariance, hence without a standard error.
    AtUpperBound,
    /// The data do not determine it; without a standard error.
    NotIdentified,
    /// Exactly where it started, although free.
    Unmoved,
}

/// A fit and all that a report wants to know of it. `m` rows, `n` parameters.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The estimates, `n`.
    pub parameters: Vec<f64>,
    /// What became of each, `n`.
    pub states: Vec<ParameterState>,
    /// Data minus model, `m`; with the problem's own row weights, without those of the robust loss.
    pub residuals: Vec<f64>,
    /// Derivatives of the model, `m` x `n`, weighted like the residuals.
    pub jacobian: Matrix,
    /// Sum of the squared residuals.
    pub sse: f64,
    /// Least squares: `sqrt(sse/(m-n))`, NaN unless `m > n`. Robust losses: the scale that the weights were made with.
    pub scale: f64,
    /// Weights of the robust loss at the end, `m`; all 1 for least squares.
    pub weights: Vec<f64>,
    /// `(J^T J)^-1`, `n` x `n`; NaN in the rows and columns of parameters at a bound or not identified.
    pub covariance_factor: Matrix,
    /// Points at which the model was evaluated, over all passes.
    pub iterations: usize,
    /// Reweighted passes; 0 for least squares.
    pub passes: usize,
    /// How it ended.
    pub status: Status,
}

impl Fit {
    /// Linearised standard errors `scale sqrt(diag (J^T J)^-1)`, `n`; NaN where the covariance is.
    pub fn standard_errors(&self) -> Vec<f64> {
        (0..self.parameters.len())
            .map(|j| self.scale * self.covariance_factor[(j, j)].sqrt())
            .collect()
    }
}
