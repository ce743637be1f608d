//! Nonlinear least squares: Levenberg-Marquardt as a trust-region method with column scaling, to machine precision.
//!
//! The outer algorithm is MINPACK's `lmder` (Moré 1978, see [`super::trust_region`]) with bounds ([`super::bounds`]) and one
//! addition. Its tests stop when the *sum of squares* no longer changes, which leaves parameters with half of the digits of the
//! arithmetic, because the sum of squares is flat at its minimum. A few Gauss-Newton steps then follow, judged by the length of
//! the step in the data's units, which is not flat: see `Descent::polish`.
//!
//! A trial point where a residual or a derivative is not finite is rejected like one where the sum of squares is infinite.
//!
//! Conventions: residual = data - model; the Jacobian is that of the **model**, so a full step solves `J d = r`.

use super::bounds::{BoundedStep, Bounds};
use super::matrix::{dot, norm};
pub use super::problem::LeastSquaresProblem;
use super::problem::{State, Weighted};
use super::trust_region::LinearModel;

/// How a descent ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At a stationary point of the sum of squares within the bounds.
    Converged,
    /// No step helps although the gradient is not zero: the model is not smooth here, or undefined next to here.
    Stalled,
    /// The limit on the iterations was reached first.
    MaxIterations,
    /// The model or its derivatives are not finite at the starting point.
    NotFinite,
}

/// The end point of a descent.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// Number of points at which the model was evaluated after the start.
    pub iterations: usize,
    /// How it ended.
    pub outcome: Outcome,
}

/// Limits of a descent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest number of trial points.
    pub max_iterations: usize,
    /// Relative change of the sum of squares and of the parameters below which the trust-region phase ends.
    pub tolerance: f64,
    /// Whether the end is then polished to machine precision.
    pub polish: bool,
}

/// First radius of the trust region, in units of the scaled length of the starting point (MINPACK's `factor`). Its 100 lets the
/// first step of the NIST problem BoxBOD leap onto a plateau; all 54 runs converge with any factor from 0.1 to 10.
const INITIAL_RADIUS: f64 = 1.0;
/// A trial point is taken if the sum of squares falls by at least this part of the prediction.
const LEAST_GAIN: f64 = 1e-4;
const MAX_POLISHING_STEPS: usize = 50;
/// Polishing ends after this many steps in a row that came no closer.
const FRUITLESS_STEPS: usize = 3;
/// A descent that ends with both this part of the residuals removable and this relative Gauss-Newton step has stalled.
const STALLED: (f64, f64) = (1e-3, 1e-6);

/// Descends from `start`, projected into the bounds, to a local minimum of `sum (s_i r_i)^2`.
///
/// `row_factors` holds `s`, the square roots of the weights, one a row.
///
/// # Panics
/// If `start` has not one entry a parameter or `row_factors` not one a row.
pub fn minimise<P: LeastSquaresProblem + ?Sized>(
    problem: &P,
    start: &[f64],
    row_factors: &[f64],
    bounds: &Bounds,
    limits: Limits,
) -> Minimum {
    assert_eq!(start.len(), problem.parameters(), "one start a parameter");
    assert_eq!(
        row_factors.len(),
        problem.observations(),
        "one factor a row"
    );
    let view = Weighted {
        problem,
        row_factors,
    };
    let start = bounds.project(start);
    let Some(state) = view.state(&start) else {
        return Minimum {
            parameters: start,
            iterations: 0,
            outcome: Outcome::NotFinite,
        };
    };
    let mut descent = Descent::new(view, bounds, state);
    let outcome = if !descent.descend(limits) {
        Outcome::MaxIterations
    } else {
        if limits.polish {
            descent.polish();
        }
        if descent.stalled() {
            Outcome::Stalled
        } else {
            Outcome::Converged
        }
    };
    Minimum {
        parameters: descent.state.x,
        iterations: descent.iterations,
        outcome,
    }
}

/// What a trial point did to the sum of squares, relative to its present value.
struct Gain {
    actual: f64,
    predicted: f64,
    /// Directional derivative along the step, halved; negative.
    slope: f64,
    ratio: f64,
    trial_norm: f64,
}

struct Descent<'a, P: ?Sized> {
    view: Weighted<'a, P>,
    bounds: &'a Bounds,
    state: State,
    scaling: Vec<f64>,
    radius: f64,
    damping: f64,
    iterations: usize,
}

impl<'a, P: LeastSquaresProblem + ?Sized> Descent<'a, P> {
    fn new(view: Weighted<'a, P>, bounds: &'a Bounds, state: State) -> Self {
        let mut scaling = state.jacobian.column_norms();
        for d in scaling.iter_mut().filter(|d| **d == 0.0) {
            *d = 1.0;
        }
        let mut descent = Self {
            view,
            bounds,
            state,
            scaling,
            radius: INITIAL_RADIUS,
            damping: 0.0,
            iterations: 0,
        };
        let length = descent.scaled_norm(&descent.state.x);
        if length > 0.0 {
            descent.radius = INITIAL_RADIUS * length;
        }
        descent
    }

    fn scaled_norm(&self, x: &[f64]) -> f64 {
        let scaled: Vec<f64> = x.iter().zip(&self.scaling).map(|(v, d)| v * d).collect();
        norm(&scaled)
    }

    fn linear_model(&self) -> (Vec<usize>, LinearModel) {
        let state = &self.state;
        let free = self.bounds.free(&state.x, &state.descent);
        let model = LinearModel::new(state.jacobian.select_columns(&free), &state.residuals);
        (free, model)
    }

    /// The trust-region phase; false if the limit on the iterations ended it.
    fn descend(&mut self, limits: Limits) -> bool {
        while self.state.norm > 0.0 {
            let (free, model) = self.linear_model();
            if free.is_empty() || model.removable() == 0.0 {
                return true;
            }
            for (d, length) in self
                .scaling
                .iter_mut()
                .zip(self.state.jacobian.column_norms())
            {
                *d = d.max(length);
            }
            loop {
                if self.iterations == limits.max_iterations {
                    return false;
                }
                let (taken, finished) = self.try_step(&free, &model, limits.tolerance);
                if finished {
                    return true;
                }
                if taken {
                    break;
                }
            }
        }
        true
    }

    /// One trial point: whether it was taken, and whether the phase is over.
    fn try_step(&mut self, free: &[usize], model: &LinearModel, tolerance: f64) -> (bool, bool) {
        let state = &self.state;
        let region = (self.scaling.as_slice(), self.radius, self.damping);
        let linear = (&state.jacobian, state.residuals.as_slice());
        let step = self.bounds.step(&state.x, free, model, linear, region);
        self.damping = step.damping;
        let length = self.scaled_norm(&step.displacement);
        if self.iterations == 0 {
            self.radius = self.radius.min(length);
        }
        self.iterations += 1;
        let (residuals, trial_norm) = self.view.residuals(&step.point);
        let mut gain = self.gain(&step, trial_norm);
        let mut next = None;
        if gain.ratio >= LEAST_GAIN {
            next = self.view.complete(&step.point, residuals, trial_norm);
            if next.is_none() {
                gain = self.gain(&step, f64::INFINITY);
            }
        }
        self.adapt_radius(&gain, length);
        let taken = next.is_some();
        if let Some(state) = next {
            self.state = state;
        }
        let flat =
            gain.actual.abs() <= tolerance && gain.predicted <= tolerance && gain.ratio <= 2.0;
        let still = self.radius <= tolerance * self.scaled_norm(&self.state.x);
        (taken, flat || still || self.radius == 0.0)
    }

    fn gain(&self, step: &BoundedStep, trial_norm: f64) -> Gain {
        let state = &self.state;
        let change = trial_norm / state.norm;
        let actual = if change < 10.0 {
            1.0 - change * change
        } else {
            -1.0
        };
        let removed = norm(&state.jacobian.multiply(&step.displacement)) / state.norm;
        let slope = -dot(&step.displacement, &state.descent) / state.norm / state.norm;
        let predicted = -2.0 * slope - removed * removed;
        let ratio = if predicted > 0.0 {
            actual / predicted
        } else {
            0.0
        };
        Gain {
            actual,
            predicted,
            slope,
            ratio,
            trial_norm,
        }
    }

    /// MINPACK's rule: shrink by interpolation after a poor prediction, grow after a good one.
    fn adapt_radius(&mut self, gain: &Gain, length: f64) {
        if gain.ratio <= 0.25 {
            let mut factor = if gain.actual >= 0.0 {
                0.5
            } else {
                0.5 * gain.slope / (gain.slope + 0.5 * gain.actual)
            };
            if 0.1 * gain.trial_norm >= self.state.norm || factor < 0.1 {
                factor = 0.1;
            }
            self.radius = factor * self.radius.min(10.0 * length);
            self.damping /= factor;
        } else if self.damping == 0.0 || gain.ratio >= 0.75 {
            self.radius = 2.0 * length;
            self.damping *= 0.5;
        }
    }

    /// Full Gauss-Newton steps for as long as they bring the point closer, ending at the closest.
    ///
    /// Closeness is the part of the residuals that the linear model can still remove, `||Q1^T r||`: the length of the next step
    /// measured in the data. Near the minimum it falls to rounding level linearly, where the sum of squares falls quadratically.
    fn polish(&mut self) {
        let (mut free, mut model) = self.linear_model();
        let mut best = (model.removable(), self.state.clone());
        let mut fruitless = 0;
        for _ in 0..MAX_POLISHING_STEPS {
            let mut x = self.state.x.clone();
            for (&j, d) in free.iter().zip(model.gauss_newton()) {
                x[j] += d;
            }
            self.iterations += 1;
            let next = self
                .bounds
                .contain(&x)
                .then(|| self.view.state(&x))
                .flatten();
            let Some(state) = next.filter(|s| s.norm <= best.1.norm * (1.0 + 1e-6)) else {
                break;
            };
            self.state = state;
            (free, model) = self.linear_model();
            let distance = model.removable();
            if distance < best.0 {
                best = (distance, self.state.clone());
                fruitless = 0;
            } else {
                fruitless += 1;
            }
            if fruitless == FRUITLESS_STEPS || distance == 0.0 {
                break;
            }
        }
        self.state = best.1;
    }

    /// Whether the end point is far from stationary (Bates and Watts' relative offset) by the model's own account.
    fn stalled(&self) -> bool {
        let (free, model) = self.linear_model();
        let offset = model.removable() > STALLED.0 * self.state.norm;
        let step = model.gauss_newton();
        let moves = free
            .iter()
            .zip(&step)
            .any(|(&j, d)| d.abs() > STALLED.1 * self.state.x[j].abs());
        offset && moves
    }
}
