//! What is to be fitted: the trait of a least-squares problem, and its value and derivatives at a point.
//!
//! Conventions: residual = data - model; the Jacobian is that of the **model**, so a full step solves `J d = r`.

use super::matrix::{Matrix, norm};

/// A model of observations, with parameters to be found.
pub trait LeastSquaresProblem {
    /// Number of parameters, `n`.
    fn parameters(&self) -> usize;
    /// Number of observations, `m`.
    fn observations(&self) -> usize;
    /// Writes data minus model at `p` (`n` entries) into `r` (`m` entries); not finite where the model is undefined.
    fn residuals(&self, p: &[f64], r: &mut [f64]);
    /// Writes the derivatives of the **model** (minus those of the residuals) at `p` into `j` (`m` x `n`).
    fn jacobian(&self, p: &[f64], j: &mut Matrix);
}

/// The problem with its rows multiplied by the square roots of the weights.
pub(super) struct Weighted<'a, P: ?Sized> {
    pub(super) problem: &'a P,
    pub(super) row_factors: &'a [f64],
}

/// A point with finite residuals and derivatives.
#[derive(Clone)]
pub(super) struct State {
    pub(super) x: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    pub(super) norm: f64,
    pub(super) jacobian: Matrix,
    /// `J^T r`, along which the sum of squares falls.
    pub(super) descent: Vec<f64>,
}

impl<P: LeastSquaresProblem + ?Sized> Weighted<'_, P> {
    /// Residuals and their norm; the norm is infinite where the model is undefined.
    pub(super) fn residuals(&self, x: &[f64]) -> (Vec<f64>, f64) {
        let mut r = vec![0.0; self.problem.observations()];
        self.problem.residuals(x, &mut r);
        for (value, factor) in r.iter_mut().zip(self.row_factors) {
            *value *= factor;
        }
        let length = norm(&r);
        (
            r,
            if length.is_finite() {
                length
            } else {
                f64::INFINITY
            },
        )
    }

    pub(super) fn state(&self, x: &[f64]) -> Option<State> {
        let (residuals, norm) = self.residuals(x);
        if norm.is_infinite() {
            return None;
        }
        self.complete(x, residuals, norm)
    }

    /// Adds the derivatives; none if one of them is not finite.
    pub(super) fn complete(&self, x: &[f64], residuals: Vec<f64>, norm: f64) -> Option<State> {
        let mut jacobian = Matrix::zeros(residuals.len(), x.len());
        self.problem.jacobian(x, &mut jacobian);
        jacobian.scale_rows(self.row_factors);
        let descent = jacobian.transpose_multiply(&residuals);
        let finite = jacobian
            .data()
            .iter()
            .chain(&descent)
            .all(|v| v.is_finite());
        finite.then(|| State {
            x: x.to_vec(),
            residuals,
            norm,
            jacobian,
            descent,
        })
    }
}
