//! The statistics that the papers printed: a robust fit whose scale is Street's, mixed with that of the ordinary fit.
//!
//! These stand beside the honest statistics ([`super::statistics::GoodnessOfFit`]) under their own name and are never mixed with
//! them: the printed RMSE is not the root mean square of the residuals. With LAR weights the robust scale is nearly zero, and
//! what is left is `s_ols p/sqrt(p^2 + n)`, however good or bad the robust fit.
//!
//! Sources: DuMouchel and O'Brien 1989 (leverage adjustment, the mixed scale); Holland and Welsch 1977 (reweighting); Street,
//! Carroll and Ruppert, *The American Statistician* 42, 1988, pp. 152-154 (the scale).

use std::fmt;

use super::bounds::Bounds;
use super::covariance::identify;
use super::distributions::student_t_quantile;
use super::fit::largest_relative_move;
pub use super::lar_scale::{TUNING, Weighting, printed_scale, street_scale};
use super::levenberg_marquardt::{LeastSquaresProblem, Limits, Minimum, Outcome, minimise};
use super::matrix::Matrix;
use super::qr::PivotedQr;
use super::statistics::{
    residual_mad_scale, standard_deviation, sum_of_squares, sum_of_squares_about_mean,
};

const LARGEST_LEVERAGE: f64 = 0.9999;
/// Floor of the robust scale in units of the standard deviation of the observations.
const SCALE_FLOOR: f64 = 1e-6;
/// Relative move of every coefficient below which the passes end.
const PASS_TOLERANCE: f64 = 1e-6;
const LIMITS: Limits = Limits {
    max_iterations: 2000,
    tolerance: f64::EPSILON,
    polish: true,
};

/// How to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct LarOptions {
    /// The robust weight.
    pub weighting: Weighting,
    /// Level of the confidence intervals, between 0 and 1.
    pub confidence_level: f64,
    /// Lower and upper bound of each coefficient; infinite where there is none.
    pub bounds: Option<Vec<(f64, f64)>>,
    /// Largest number of reweighted passes.
    pub max_passes: usize,
}

impl Default for LarOptions {
    /// LAR weights, 95 % intervals, no bounds.
    fn default() -> Self {
        Self {
            weighting: Weighting::Lar,
            confidence_level: 0.95,
            bounds: None,
            max_passes: 1000,
        }
    }
}

/// Why there are no LAR-compatible statistics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LarError {
    /// The statistics divide by `n - p`.
    TooFewRows {
        /// Rows given.
        rows: usize,
        /// Coefficients to be fitted.
        parameters: usize,
    },
    /// The ordinary fit did not converge.
    OrdinaryFit(Outcome),
}

impl fmt::Display for LarError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LarError::TooFewRows { rows, parameters } => write!(
                f,
                "{rows} rows for {parameters} coefficients; LAR-compatible statistics need more rows than coefficients"
            ),
            LarError::OrdinaryFit(outcome) => {
                write!(
                    f,
                    "the ordinary fit before the robust one failed ({outcome:?})"
                )
            }
        }
    }
}

impl std::error::Error for LarError {}

/// A robust fit with the statistics that are printed for it. `n` rows, `p` coefficients.
#[derive(Clone, Debug)]
pub struct LarFit {
    /// Coefficients of the ordinary fit, `p`.
    pub ordinary_parameters: Vec<f64>,
    /// Coefficients of the robust fit, `p`.
    pub parameters: Vec<f64>,
    /// Observed minus predicted of the robust fit, `n`.
    pub residuals: Vec<f64>,
    /// Robust weights of the last pass, `n`.
    pub weights: Vec<f64>,
    /// `sqrt(sse/(n - p))` of the ordinary fit.
    pub s_ols: f64,
    /// Scale of the robust residuals by their median.
    pub sigma: f64,
    /// Street's scale.
    pub s_rob: f64,
    /// The printed RMSE, [`printed_scale`].
    pub rmse: f64,
    /// The printed SSE, `(n - p) rmse^2`.
    pub sse: f64,
    /// The printed R2, `1 - sse/sst`; NaN where the observations do not vary.
    pub r2: f64,
    /// The printed adjusted R2, `1 - (1 - r2)(n - 1)/(n - p)`.
    pub adjusted_r2: f64,
    /// `rmse sqrt(diag (J^T J)^-1)` of the unweighted Jacobian, `p`; NaN at a bound or if not identified.
    pub standard_errors: Vec<f64>,
    /// Printed confidence intervals, by Student's t with `n - p` degrees of freedom, `p`.
    pub confidence: Vec<(f64, f64)>,
    /// Reweighted passes.
    pub passes: usize,
    /// Whether the coefficients settled within the passes allowed.
    pub converged: bool,
}

/// Fits `problem` robustly from `start`; `observed` holds the data that its residuals are made of (`n`, unweighted).
///
/// # Errors
/// If there are not more rows than coefficients, or the ordinary fit fails.
///
/// # Panics
/// If `observed` has not one entry a row, or `start` or the bounds have not one a coefficient.
pub fn fit_lar<P: LeastSquaresProblem + ?Sized>(
    problem: &P,
    observed: &[f64],
    start: &[f64],
    options: &LarOptions,
) -> Result<LarFit, LarError> {
    let (rows, parameters) = (problem.observations(), problem.parameters());
    assert_eq!(observed.len(), rows, "one observation a row");
    if rows <= parameters {
        return Err(LarError::TooFewRows { rows, parameters });
    }
    let fitter = LarFitter {
        problem,
        options,
        bounds: Bounds::new(options.bounds.as_deref(), parameters),
        scale_floor: SCALE_FLOOR * standard_deviation(observed),
    };
    let ordinary = fitter.refit(start, &vec![1.0; rows]);
    if ordinary.outcome != Outcome::Converged {
        return Err(LarError::OrdinaryFit(ordinary.outcome));
    }
    let leverages = fitter.leverages(&ordinary.parameters);
    let passes = fitter.reweight(&ordinary.parameters, &leverages);
    Ok(fitter.report(observed, ordinary.parameters, &leverages, passes))
}

struct LarFitter<'a, P: ?Sized> {
    problem: &'a P,
    options: &'a LarOptions,
    bounds: Bounds,
    scale_floor: f64,
}

/// The end of the reweighted passes.
struct Passes {
    parameters: Vec<f64>,
    weights: Vec<f64>,
    count: usize,
    converged: bool,
}

impl<P: LeastSquaresProblem + ?Sized> LarFitter<'_, P> {
    fn refit(&self, start: &[f64], weights: &[f64]) -> Minimum {
        let row_factors: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
        minimise(self.problem, start, &row_factors, &self.bounds, LIMITS)
    }

    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        let mut r = vec![0.0; self.problem.observations()];
        self.problem.residuals(parameters, &mut r);
        r
    }

    fn jacobian(&self, parameters: &[f64]) -> Matrix {
        let mut j = Matrix::zeros(self.problem.observations(), parameters.len());
        self.problem.jacobian(parameters, &mut j);
        j
    }

    fn leverages(&self, parameters: &[f64]) -> Vec<f64> {
        let mut jacobian = self.jacobian(parameters);
        jacobian.normalise_columns();
        let qr = PivotedQr::new(jacobian);
        let leverages = qr.leverages(qr.rank(qr.default_tolerance()));
        leverages
            .into_iter()
            .map(|h| h.min(LARGEST_LEVERAGE))
            .collect()
    }

    fn sigma(&self, residuals: &[f64]) -> f64 {
        residual_mad_scale(residuals, self.problem.parameters()).max(self.scale_floor)
    }

    /// Steps 2 to 4: weights from residuals, adjusted for leverage in the first pass only, until no coefficient moves.
    fn reweight(&self, ordinary: &[f64], leverages: &[f64]) -> Passes {
        let mut adjusted: Vec<f64> = self.residuals(ordinary);
        for (r, h) in adjusted.iter_mut().zip(leverages) {
            *r /= (1.0 - h).sqrt();
        }
        let mut passes = Passes {
            parameters: ordinary.to_vec(),
            weights: Vec::new(),
            count: 0,
            converged: false,
        };
        while passes.count < self.options.max_passes && !passes.converged {
            let scale = TUNING * self.sigma(&adjusted);
            let weight = |r: &f64| self.options.weighting.weight(r / scale);
            passes.weights = adjusted.iter().map(weight).collect();
            let next = self.refit(&passes.parameters, &passes.weights).parameters;
            passes.converged = largest_relative_move(&passes.parameters, &next) < PASS_TOLERANCE;
            adjusted = self.residuals(&next);
            passes.parameters = next;
            passes.count += 1;
        }
        passes
    }

    /// Steps 5 and 6: the scales and what is printed from them.
    fn report(
        &self,
        observed: &[f64],
        ordinary: Vec<f64>,
        leverages: &[f64],
        passes: Passes,
    ) -> LarFit {
        let (n, p) = (observed.len(), ordinary.len());
        let freedom = (n - p) as f64;
        let residuals = self.residuals(&passes.parameters);
        let sigma = self.sigma(&residuals);
        let s_ols = (sum_of_squares(&self.residuals(&ordinary)) / freedom).sqrt();
        let s_rob = street_scale(self.options.weighting, &residuals, leverages, sigma, p);
        let rmse = printed_scale(s_ols, s_rob, n, p);
        let sse = freedom * rmse * rmse;
        let sst = sum_of_squares_about_mean(observed);
        let r2 = if sst > 0.0 { 1.0 - sse / sst } else { f64::NAN };
        let standard_errors = self.standard_errors(&passes.parameters, rmse);
        let level = 0.5 + 0.5 * self.options.confidence_level;
        let t = student_t_quantile(level, freedom);
        let estimates = passes.parameters.iter().zip(&standard_errors);
        LarFit {
            confidence: estimates.map(|(c, e)| (c - t * e, c + t * e)).collect(),
            ordinary_parameters: ordinary,
            parameters: passes.parameters,
            residuals,
            weights: passes.weights,
            s_ols,
            sigma,
            s_rob,
            rmse,
            sse,
            r2,
            adjusted_r2: 1.0 - (1.0 - r2) * (n - 1) as f64 / freedom,
            standard_errors,
            passes: passes.count,
            converged: passes.converged,
        }
    }

    fn standard_errors(&self, parameters: &[f64], scale: f64) -> Vec<f64> {
        let inside: Vec<usize> = (0..parameters.len())
            .filter(|&j| {
                !self.bounds.at_lower(parameters, j) && !self.bounds.at_upper(parameters, j)
            })
            .collect();
        let factor = identify(&self.jacobian(parameters), &inside).covariance_factor;
        (0..parameters.len())
            .map(|j| scale * factor[(j, j)].sqrt())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual_problem::DualProblem;
    use crate::real::Dual;

    #[test]
    fn too_few_rows_and_undefined_models_are_errors() {
        let y = [1.0, 2.0, 4.0];
        let line = |i: usize, p: &[Dual<2>; 2]| p[0] + p[1] * (i as f64);
        let short = DualProblem::new(&y[..2], line);
        let refused = fit_lar(&short, &y[..2], &[0.0, 0.0], &LarOptions::default());
        let expected = LarError::TooFewRows {
            rows: 2,
            parameters: 2,
        };
        assert_eq!(refused.unwrap_err(), expected);
        let undefined = |_: usize, p: &[Dual<2>; 2]| p[0] + f64::NAN;
        let problem = DualProblem::new(&y, undefined);
        let refused = fit_lar(&problem, &y, &[0.0, 0.0], &LarOptions::default());
        let expected = LarError::OrdinaryFit(Outcome::NotFinite);
        assert_eq!(refused.unwrap_err(), expected);
    }

    #[test]
    fn constant_data_have_no_r2_and_a_gross_error_has_no_pull() {
        let mut y = [2.0; 9];
        y[4] = 50.0;
        let constant = |_: usize, p: &[Dual<1>; 1]| p[0];
        for weighting in [Weighting::Lar, Weighting::Bisquare] {
            let options = LarOptions {
                weighting,
                ..LarOptions::default()
            };
            let fit = fit_lar(&DualProblem::new(&y, constant), &y, &[0.0], &options).unwrap();
            assert!((fit.parameters[0] - 2.0).abs() < 1e-4, "{fit:?}");
        }
        let flat = [2.0; 9];
        let problem = DualProblem::new(&flat, constant);
        let fit = fit_lar(&problem, &flat, &[0.0], &LarOptions::default());
        assert!(fit.unwrap().r2.is_nan());
    }
}
