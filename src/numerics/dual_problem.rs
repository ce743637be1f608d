//! A least-squares problem written as one closure over dual numbers, which gives values and the exact Jacobian together.

use super::levenberg_marquardt::LeastSquaresProblem;
use super::matrix::Matrix;
use super::real::Dual;
use std::cell::RefCell;

/// Observations of a model `f(row, parameters)` with `N` parameters, some of which may be held at a value.
///
/// The fitter sees the free parameters only, in their order; [`DualProblem::full`] and [`DualProblem::free`] translate. Dual numbers give
/// the derivatives along with the residuals, and a descent asks for both at the same point, so those of the last point are kept.
#[derive(Clone, Debug)]
pub struct DualProblem<'a, const N: usize, F> {
    model: F,
    observed: &'a [f64],
    row_factors: Option<Vec<f64>>,
    held: [Option<f64>; N],
    last: RefCell<Option<(Vec<f64>, Matrix)>>,
}

impl<'a, const N: usize, F> DualProblem<'a, N, F>
where
    F: Fn(usize, &[Dual<N>; N]) -> Dual<N>,
{
    /// The model beside the data, all weights equal and all parameters free.
    pub fn new(observed: &'a [f64], model: F) -> Self {
        Self {
            model,
            observed,
            row_factors: None,
            held: [None; N],
            last: RefCell::new(None),
        }
    }

    /// Weighs the squared residual of row `i` with `weights[i] >= 0`.
    ///
    /// # Panics
    /// If there is not one weight a row.
    pub fn with_weights(mut self, weights: &[f64]) -> Self {
        assert_eq!(weights.len(), self.observed.len(), "one weight a row");
        self.row_factors = Some(weights.iter().map(|w| w.sqrt()).collect());
        self
    }

    /// Holds the parameters that have a value here.
    pub fn with_held(mut self, held: [Option<f64>; N]) -> Self {
        self.held = held;
        self
    }

    /// All `N` parameters, given the free ones.
    pub fn full(&self, free: &[f64]) -> [f64; N] {
        let mut values = free.iter();
        self.held
            .map(|held| held.unwrap_or_else(|| values.next().copied().unwrap_or(f64::NAN)))
    }

    /// The free ones of all `N` parameters.
    pub fn free(&self, full: &[f64; N]) -> Vec<f64> {
        let values = full.iter().zip(&self.held);
        values
            .filter(|(_, held)| held.is_none())
            .map(|(value, _)| *value)
            .collect()
    }

    /// The parameters as dual numbers; the free ones are seeded from 0 upwards.
    fn seeded(&self, free: &[f64]) -> [Dual<N>; N] {
        let full = self.full(free);
        let mut next = 0;
        std::array::from_fn(|k| {
            if self.held[k].is_some() {
                return super::real::Real::constant(full[k]);
            }
            next += 1;
            Dual::variable(full[k], next - 1)
        })
    }

    fn row_factor(&self, row: usize) -> f64 {
        self.row_factors.as_ref().map_or(1.0, |f| f[row])
    }
}

impl<const N: usize, F> LeastSquaresProblem for DualProblem<'_, N, F>
where
    F: Fn(usize, &[Dual<N>; N]) -> Dual<N>,
{
    fn parameters(&self) -> usize {
        self.held.iter().filter(|held| held.is_none()).count()
    }

    fn observations(&self) -> usize {
        self.observed.len()
    }

    fn residuals(&self, p: &[f64], r: &mut [f64]) {
        let seeded = self.seeded(p);
        let mut derivatives = Matrix::zeros(self.observed.len(), p.len());
        for (row, slot) in r.iter_mut().enumerate() {
            let model = (self.model)(row, &seeded);
            let factor = self.row_factor(row);
            *slot = factor * (self.observed[row] - model.value);
            for k in 0..p.len() {
                derivatives[(row, k)] = factor * model.gradient[k];
            }
        }
        *self.last.borrow_mut() = Some((p.to_vec(), derivatives));
    }

    fn jacobian(&self, p: &[f64], j: &mut Matrix) {
        let known = |last: &Option<(Vec<f64>, Matrix)>| {
            last.as_ref().is_some_and(|(at, _)| at.as_slice() == p)
        };
        if !known(&self.last.borrow()) {
            self.residuals(p, &mut vec![0.0; self.observed.len()]);
        }
        if let Some((_, derivatives)) = self.last.borrow().as_ref() {
            j.clone_from(derivatives);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;

    #[test]
    fn held_parameters_are_invisible_and_weights_scale_the_rows() {
        let x = [0.0, 1.0, 2.0];
        let y = [1.0, 2.0, 3.0];
        let model = |i: usize, p: &[Dual<3>; 3]| p[0] * (p[1] * x[i]).exp() + p[2];
        let problem = DualProblem::new(&y, model)
            .with_weights(&[1.0, 4.0, 9.0])
            .with_held([None, Some(0.0), None]);
        assert_eq!(problem.parameters(), 2);
        assert_eq!(problem.full(&[5.0, 7.0]), [5.0, 0.0, 7.0]);
        assert_eq!(problem.free(&[5.0, 6.0, 7.0]), [5.0, 7.0]);
        let mut r = [0.0; 3];
        problem.residuals(&[0.5, 0.25], &mut r);
        assert_eq!(r, [0.25, 2.5, 6.75]);
        let mut j = Matrix::zeros(3, 2);
        problem.jacobian(&[0.5, 0.25], &mut j);
        assert_eq!(j.data(), [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
    }
}
