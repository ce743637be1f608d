//! One step of Levenberg-Marquardt: least squares inside an ellipsoid.
//!
//! Finds `d` that minimises `||r - J d||` subject to `||D d|| <= radius`, where `D` is a diagonal scaling. The solution solves
//! `(J^T J + a D^2) d = J^T r` for a damping `a >= 0`; `a` is found by Newton's method on the secular equation
//! `||D d(a)|| = radius`, safeguarded by an interval, to 10 %. The damped systems are solved by a QR of `[R P^T; sqrt(a) D]`.
//! Columns are brought to unit length first, so that the rank does not depend on the units of the parameters.
//!
//! Source: Moré, *The Levenberg-Marquardt algorithm: implementation and theory*, Lecture Notes in Mathematics 630, 1978,
//! sections 3 and 5 (MINPACK's `lmpar`).

use super::matrix::{Matrix, dot, norm};
use super::qr::PivotedQr;

/// Relative error allowed in the length of a step that ends on the boundary.
const RADIUS_TOLERANCE: f64 = 0.1;
const MAX_NEWTON_STEPS: usize = 10;

/// A step and the damping that produced it.
#[derive(Clone, Debug)]
pub struct Step {
    /// The step, one entry a column of the Jacobian.
    pub displacement: Vec<f64>,
    /// The damping `a`; zero for a full Gauss-Newton step.
    pub damping: f64,
}

/// A linear least-squares problem prepared for steps of any radius.
#[derive(Clone, Debug)]
pub struct LinearModel {
    /// Of the Jacobian with columns of unit length.
    qr: PivotedQr,
    r: Matrix,
    /// The leading entries of `Q^T r`, as many as `R` has rows.
    projected: Vec<f64>,
    rank: usize,
    /// Lengths of the Jacobian's columns, 1 for columns of zeros.
    lengths: Vec<f64>,
}

impl LinearModel {
    /// Factorises the Jacobian (`m` x `n`) and projects the residuals (`m`).
    pub fn new(mut jacobian: Matrix, residuals: &[f64]) -> Self {
        let lengths = jacobian.normalise_columns();
        let qr = PivotedQr::new(jacobian);
        let r = qr.r();
        let mut projected = residuals.to_vec();
        qr.apply_q_transposed(&mut projected);
        projected.truncate(r.rows());
        let rank = qr.rank(qr.default_tolerance());
        Self {
            qr,
            r,
            projected,
            rank,
            lengths,
        }
    }

    /// The undamped step; columns that are linear combinations of others get zero.
    pub fn gauss_newton(&self) -> Vec<f64> {
        quotients(&self.full_step(), &self.lengths)
    }

    fn full_step(&self) -> Vec<f64> {
        self.qr.solve_r(&self.projected, self.rank)
    }

    /// Norm of the part of the residuals that the linear model can remove: the distance to the minimum in units of the data.
    pub fn removable(&self) -> f64 {
        norm(&self.projected[..self.rank])
    }

    /// The constrained step; `scaling` has `n` positive entries and `damping` is the value used last (0 at first).
    pub fn step(&self, scaling: &[f64], radius: f64, damping: f64) -> Step {
        let scaling = quotients(scaling, &self.lengths);
        let mut step = self.scaled_step(&scaling, radius, damping);
        step.displacement = quotients(&step.displacement, &self.lengths);
        step
    }

    fn scaled_step(&self, scaling: &[f64], radius: f64, damping: f64) -> Step {
        let full = self.full_step();
        let length = norm(&products(scaling, &full));
        if length <= (1.0 + RADIUS_TOLERANCE) * radius {
            return Step {
                displacement: full,
                damping: 0.0,
            };
        }
        let (lower, upper) = self.damping_interval(scaling, radius, &full);
        let mut search = Search {
            lower,
            upper,
            damping: damping.max(lower).min(upper),
        };
        if search.damping == 0.0 {
            search.damping = upper * radius / length;
        }
        self.search_damping(scaling, radius, search)
    }

    /// Moré's bounds on the damping: a Newton step from zero below, steepest descent above.
    fn damping_interval(&self, scaling: &[f64], radius: f64, full: &[f64]) -> (f64, f64) {
        let lower = if self.rank == self.r.cols() {
            newton_correction(&self.qr, scaling, full, radius)
        } else {
            0.0
        };
        let descent: Vec<f64> = (0..self.r.cols())
            .map(|k| dot(self.r.column(k), &self.projected) / scaling[self.qr.permutation()[k]])
            .collect();
        let upper = norm(&descent) / radius;
        if upper == 0.0 {
            (lower, f64::MIN_POSITIVE / radius.min(RADIUS_TOLERANCE))
        } else {
            (lower, upper.max(lower))
        }
    }

    fn search_damping(&self, scaling: &[f64], radius: f64, mut search: Search) -> Step {
        let unbounded_below = search.lower == 0.0;
        let mut previous = f64::INFINITY;
        let mut attempt = 1;
        loop {
            if search.damping == 0.0 {
                search.damping = f64::MIN_POSITIVE.max(0.001 * search.upper);
            }
            let damped = self.damped_qr(scaling, search.damping);
            let displacement = self.damped_step(&damped);
            let excess = norm(&products(scaling, &displacement)) - radius;
            let short = unbounded_below && excess <= previous && previous < 0.0;
            if excess.abs() <= RADIUS_TOLERANCE * radius || short || attempt == MAX_NEWTON_STEPS {
                return Step {
                    displacement,
                    damping: search.damping,
                };
            }
            let correction = newton_correction(&damped, scaling, &displacement, radius);
            search.update(excess, correction);
            previous = excess;
            attempt += 1;
        }
    }

    /// QR of `[R P^T; sqrt(a) D]`, whose columns stand in the order of the Jacobian.
    fn damped_qr(&self, scaling: &[f64], damping: f64) -> PivotedQr {
        let (rows, n) = (self.r.rows(), self.r.cols());
        let mut stacked = Matrix::zeros(rows + n, n);
        for (k, &place) in self.qr.permutation().iter().enumerate() {
            stacked.column_mut(place)[..rows].copy_from_slice(self.r.column(k));
            stacked[(rows + place, place)] = damping.sqrt() * scaling[place];
        }
        PivotedQr::new(stacked)
    }

    fn damped_step(&self, damped: &PivotedQr) -> Vec<f64> {
        let mut right = self.projected.clone();
        right.resize(self.r.rows() + self.r.cols(), 0.0);
        damped.solve_least_squares(&right, damped.rank(0.0))
    }
}

/// The damping within the interval that contains the solution.
struct Search {
    lower: f64,
    upper: f64,
    damping: f64,
}

impl Search {
    fn update(&mut self, excess: f64, correction: f64) {
        if excess > 0.0 {
            self.lower = self.lower.max(self.damping);
        } else {
            self.upper = self.upper.min(self.damping);
        }
        self.damping = self.lower.max(self.damping + correction);
    }
}

/// Newton's correction of the damping for the secular equation, from the factorisation at the present damping.
fn newton_correction(qr: &PivotedQr, scaling: &[f64], step: &[f64], radius: f64) -> f64 {
    let stretched = products(scaling, step);
    let length = norm(&stretched);
    let direction: Vec<f64> = products(scaling, &stretched)
        .iter()
        .map(|v| v / length)
        .collect();
    let w = norm(&qr.solve_r_transposed(&direction, qr.rank(0.0)));
    (length - radius) / radius / w / w
}

fn products(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x * y).collect()
}

fn quotients(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x / y).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> (Matrix, Vec<f64>) {
        let mut j = Matrix::zeros(4, 2);
        for i in 0..4 {
            j[(i, 0)] = 1.0;
            j[(i, 1)] = i as f64;
        }
        (j, vec![3.0, 5.0, 7.0, 9.0])
    }

    #[test]
    fn a_wide_region_gives_the_gauss_newton_step() {
        let (j, r) = model();
        let step = LinearModel::new(j, &r).step(&[1.0, 1.0], 100.0, 0.0);
        assert_eq!(step.damping, 0.0);
        assert!((step.displacement[0] - 3.0).abs() < 1e-13);
        assert!((step.displacement[1] - 2.0).abs() < 1e-13);
    }

    #[test]
    fn a_narrow_region_is_filled_and_the_optimality_condition_holds() {
        let (j, r) = model();
        let scaling = [2.0, 0.5];
        for radius in [1e-6, 1e-2, 1.0] {
            let step = LinearModel::new(j.clone(), &r).step(&scaling, radius, 0.0);
            let length = norm(&products(&scaling, &step.displacement));
            assert!((length / radius - 1.0).abs() <= RADIUS_TOLERANCE);
            let fitted = j.multiply(&step.displacement);
            let rest: Vec<f64> = r.iter().zip(&fitted).map(|(a, b)| a - b).collect();
            for (k, g) in j.transpose_multiply(&rest).iter().enumerate() {
                let damped = step.damping * scaling[k] * scaling[k] * step.displacement[k];
                assert!((g - damped).abs() < 1e-9 * g.abs().max(1.0));
            }
        }
    }

    #[test]
    fn a_singular_jacobian_still_gives_a_bounded_step() {
        let (mut j, r) = model();
        j.column_mut(1).fill(1.0);
        let step = LinearModel::new(j, &r).step(&[1.0, 1.0], 0.5, 0.0);
        assert!(norm(&step.displacement) <= 0.55);
        assert!((step.displacement[0] - step.displacement[1]).abs() < 1e-9);
    }
}
