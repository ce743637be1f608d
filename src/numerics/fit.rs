//! A nonlinear fit with its report: loss, bounds, covariance, and what became of each parameter.
//!
//! Least squares is one descent ([`super::levenberg_marquardt`]). A robust loss is iteratively reweighted least squares around it:
//! residuals are divided by a robust scale (median absolute residual / 0.6745 unless given), weighted by the loss, and refitted
//! from where the last pass ended until no parameter moves (Holland and Welsch 1977). The covariance is the linearised one of the
//! unweighted Jacobian at the end.

use super::bounds::Bounds;
use super::covariance::identify;
pub use super::fit_report::{Fit, Options, ParameterState, Status};
use super::levenberg_marquardt::{LeastSquaresProblem, Limits, Minimum, Outcome, minimise};
use super::loss::Loss;
use super::matrix::{Matrix, dot, norm};
use super::statistics::residual_mad_scale;

/// Fits `problem` from `start`.
///
/// # Panics
/// If `start` or the bounds have not one entry a parameter, or bounds are not in order.
pub fn fit<P: LeastSquaresProblem + ?Sized>(problem: &P, start: &[f64], options: &Options) -> Fit {
    let fitter = Fitter::new(problem, options);
    let first = fitter.descend(start, &fitter.unit_weights());
    fitter.finish(start, first)
}

/// Fits from the start whose least-squares descent ends lowest (the first of equals); `None` without starts.
///
/// A robust loss is applied from the winner on, since sums of different scales cannot be compared.
///
/// # Panics
/// Like [`fit`].
pub fn fit_multi_start<P: LeastSquaresProblem + ?Sized>(
    problem: &P,
    starts: &[Vec<f64>],
    options: &Options,
) -> Option<Fit> {
    let fitter = Fitter::new(problem, options);
    let mut best: Option<(f64, &[f64], Minimum)> = None;
    for start in starts {
        let minimum = fitter.descend(start, &fitter.unit_weights());
        let length = norm(&fitter.residuals(&minimum.parameters));
        let level = if length.is_finite() {
            length
        } else {
            f64::INFINITY
        };
        if best.as_ref().is_none_or(|(lowest, ..)| level < *lowest) {
            best = Some((level, start, minimum));
        }
    }
    best.map(|(_, start, minimum)| fitter.finish(start, minimum))
}

/// Trial points of one reweighted pass.
const POINTS_A_PASS: usize = 3;

/// The end of the reweighted passes.
struct Reweighted {
    minimum: Minimum,
    weights: Vec<f64>,
    scale: f64,
    passes: usize,
}

struct Fitter<'a, P: ?Sized> {
    problem: &'a P,
    options: &'a Options,
    bounds: Bounds,
}

impl<'a, P: LeastSquaresProblem + ?Sized> Fitter<'a, P> {
    fn new(problem: &'a P, options: &'a Options) -> Self {
        Self {
            problem,
            options,
            bounds: Bounds::new(options.bounds.as_deref(), problem.parameters()),
        }
    }

    fn unit_weights(&self) -> Vec<f64> {
        vec![1.0; self.problem.observations()]
    }

    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        let mut r = vec![0.0; self.problem.observations()];
        self.problem.residuals(parameters, &mut r);
        r
    }

    fn descend(&self, start: &[f64], weights: &[f64]) -> Minimum {
        self.descend_at_most(
            self.options.max_iterations,
            start,
            weights,
            self.options.polish,
        )
    }

    fn descend_at_most(
        &self,
        max_iterations: usize,
        start: &[f64],
        weights: &[f64],
        polish: bool,
    ) -> Minimum {
        let row_factors: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
        let limits = Limits {
            max_iterations,
            tolerance: self.options.tolerance,
            polish,
        };
        minimise(self.problem, start, &row_factors, &self.bounds, limits)
    }

    /// Reweighted passes from a least-squares minimum; none for least squares or a perfect fit.
    fn reweight(&self, minimum: Minimum) -> Reweighted {
        let r = self.residuals(&minimum.parameters);
        let freedom = r.len() as f64 - minimum.parameters.len() as f64;
        let mut now = Reweighted {
            scale: if freedom > 0.0 {
                norm(&r) / freedom.sqrt()
            } else {
                f64::NAN
            },
            weights: self.unit_weights(),
            passes: 0,
            minimum,
        };
        let usable = norm(&r) > 0.0 && now.minimum.outcome != Outcome::NotFinite;
        if self.options.loss == Loss::LeastSquares || !usable {
            return now;
        }
        let floor = 1e-6 * norm(&r) / (r.len() as f64).sqrt();
        while now.passes < self.options.max_passes {
            let moved = self.pass(&mut now, floor);
            if moved <= self.options.pass_tolerance {
                // A short pass may also stand still because its few trial points failed: arrive, and see whether that moves.
                let end = self.descend(&now.minimum.parameters, &now.weights);
                let moved = largest_relative_move(&now.minimum.parameters, &end.parameters);
                let iterations = now.minimum.iterations + end.iterations;
                now.minimum = Minimum { iterations, ..end };
                if moved <= self.options.pass_tolerance {
                    return now;
                }
            }
        }
        now.minimum.outcome = Outcome::MaxIterations;
        now
    }

    /// One reweighted pass; returns the largest relative move of a parameter.
    ///
    /// A few trial points are enough, since the weights change before the next: only the last descent has to arrive.
    fn pass(&self, now: &mut Reweighted, floor: f64) -> f64 {
        let r = self.residuals(&now.minimum.parameters);
        let n = now.minimum.parameters.len();
        let estimate = || residual_mad_scale(&r, n).max(floor);
        now.scale = self.options.scale.unwrap_or_else(estimate);
        now.weights = r
            .iter()
            .map(|v| self.options.loss.weight(v / now.scale))
            .collect();
        let next =
            self.descend_at_most(POINTS_A_PASS, &now.minimum.parameters, &now.weights, false);
        let moved = largest_relative_move(&now.minimum.parameters, &next.parameters);
        now.passes += 1;
        now.minimum = Minimum {
            iterations: now.minimum.iterations + next.iterations,
            ..next
        };
        moved
    }

    fn finish(&self, start: &[f64], first: Minimum) -> Fit {
        let end = self.reweight(first);
        let parameters = end.minimum.parameters;
        let residuals = self.residuals(&parameters);
        let mut jacobian = Matrix::zeros(residuals.len(), parameters.len());
        self.problem.jacobian(&parameters, &mut jacobian);
        let inside: Vec<usize> = (0..parameters.len())
            .filter(|&j| {
                !self.bounds.at_lower(&parameters, j) && !self.bounds.at_upper(&parameters, j)
            })
            .collect();
        let mut covariance_factor = identify(&jacobian, &inside).covariance_factor;
        let unidentified = undetermined(&jacobian, &end.weights, &inside);
        for &lost in &unidentified {
            for j in 0..parameters.len() {
                covariance_factor[(lost, j)] = f64::NAN;
                covariance_factor[(j, lost)] = f64::NAN;
            }
        }
        let states = (0..parameters.len())
            .map(|j| self.state(j, &parameters, start, &unidentified))
            .collect();
        Fit {
            states,
            sse: dot(&residuals, &residuals),
            scale: end.scale,
            weights: end.weights,
            covariance_factor,
            iterations: end.minimum.iterations,
            passes: end.passes,
            status: status(end.minimum.outcome, unidentified),
            parameters,
            residuals,
            jacobian,
        }
    }

    fn state(&self, j: usize, x: &[f64], start: &[f64], unidentified: &[usize]) -> ParameterState {
        if self.bounds.at_lower(x, j) {
            ParameterState::AtLowerBound
        } else if self.bounds.at_upper(x, j) {
            ParameterState::AtUpperBound
        } else if unidentified.contains(&j) {
            ParameterState::NotIdentified
        } else if x[j] == start[j] {
            ParameterState::Unmoved
        } else {
            ParameterState::Ok
        }
    }
}

/// The parameters among `inside` that the rows with a weight do not determine: a loss may have given up all that did.
fn undetermined(jacobian: &Matrix, weights: &[f64], inside: &[usize]) -> Vec<usize> {
    let row_factors: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let mut weighted = jacobian.clone();
    weighted.scale_rows(&row_factors);
    identify(&weighted, inside).unidentified
}

fn status(outcome: Outcome, unidentified: Vec<usize>) -> Status {
    match outcome {
        Outcome::NotFinite => Status::NotFinite,
        Outcome::MaxIterations => Status::MaxIterations,
        Outcome::Stalled => Status::Stalled,
        Outcome::Converged if unidentified.is_empty() => Status::Converged,
        Outcome::Converged => Status::Singular {
            parameters: unidentified,
        },
    }
}

/// The largest change of a parameter relative to the larger of its two sizes; 0 if nothing moved.
pub fn largest_relative_move(before: &[f64], after: &[f64]) -> f64 {
    before.iter().zip(after).fold(0.0, |largest: f64, (a, b)| {
        let size = a.abs().max(b.abs());
        if size > 0.0 {
            largest.max((a - b).abs() / size)
        } else {
            largest
        }
    })
}
