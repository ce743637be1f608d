//! Box constraints for the trust-region step: projection and an active set.
//!
//! A parameter that sits on a bound and is pushed outwards by the gradient is held for the iteration. A free parameter that a
//! step would carry out of the box is put onto its bound, and the step of the others is computed again for what is left of the
//! residuals. For a small radius the step is scaled steepest descent, along which this is the projected gradient, so a point
//! where no radius helps satisfies the first-order conditions.
//!
//! Source: Bertsekas, *SIAM Journal on Control and Optimization* 20, 1982, pp. 221-246 (two-metric projection, active sets).

use super::matrix::{Matrix, add_scaled};
use super::trust_region::{LinearModel, Step};

/// Lower and upper bound of each parameter; infinite where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds(Vec<(f64, f64)>);

/// Where a step leads.
#[derive(Clone, Debug)]
pub struct BoundedStep {
    /// The point reached, inside the box.
    pub point: Vec<f64>,
    /// The step to it, one entry a parameter.
    pub displacement: Vec<f64>,
    /// The damping of the trust-region solution.
    pub damping: f64,
}

impl Bounds {
    /// The given bounds, one pair a parameter, or none at all for `n` parameters.
    ///
    /// # Panics
    /// If there are bounds but not `n` pairs of them, or a pair is not in order.
    pub fn new(bounds: Option<&[(f64, f64)]>, n: usize) -> Self {
        let Some(pairs) = bounds else {
            return Self(vec![(f64::NEG_INFINITY, f64::INFINITY); n]);
        };
        assert_eq!(pairs.len(), n, "one pair of bounds a parameter");
        assert!(
            pairs.iter().all(|(lower, upper)| lower <= upper),
            "bounds must be in order: {pairs:?}"
        );
        Self(pairs.to_vec())
    }

    /// The nearest point of the box.
    pub fn project(&self, x: &[f64]) -> Vec<f64> {
        let inside = |(&v, &(lower, upper)): (&f64, &(f64, f64))| v.max(lower).min(upper);
        x.iter().zip(&self.0).map(inside).collect()
    }

    /// Whether the point is in the box, bounds included.
    pub fn contain(&self, x: &[f64]) -> bool {
        x.iter()
            .zip(&self.0)
            .all(|(v, (lower, upper))| lower <= v && v <= upper)
    }

    /// Whether parameter `j` sits on its lower bound at `x`.
    pub fn at_lower(&self, x: &[f64], j: usize) -> bool {
        x[j] == self.0[j].0
    }

    /// Whether parameter `j` sits on its upper bound at `x`.
    pub fn at_upper(&self, x: &[f64], j: usize) -> bool {
        x[j] == self.0[j].1
    }

    /// Indices of the parameters that may move when the sum of squares falls along `descent`.
    pub fn free(&self, x: &[f64], descent: &[f64]) -> Vec<usize> {
        (0..x.len())
            .filter(|&j| {
                let held = (self.at_lower(x, j) && descent[j] <= 0.0)
                    || (self.at_upper(x, j) && descent[j] >= 0.0);
                !held
            })
            .collect()
    }

    /// The trust-region step from `x` that stays in the box.
    ///
    /// `model` is the linear model of the columns `free` of `jacobian` (`m` x `n`) and `residuals` (`m`); `scaling` has `n` entries.
    pub fn step(
        &self,
        x: &[f64],
        free: &[usize],
        model: &LinearModel,
        (jacobian, residuals): (&Matrix, &[f64]),
        region: (&[f64], f64, f64),
    ) -> BoundedStep {
        let (scaling, radius, damping) = region;
        let mut free = free.to_vec();
        let mut left = residuals.to_vec();
        let mut reached = BoundedStep {
            point: x.to_vec(),
            displacement: vec![0.0; x.len()],
            damping,
        };
        let mut step = model.step(&pick(scaling, &free), radius, damping);
        loop {
            let before = free.len();
            free = self.place(x, &free, &step, &mut reached);
            if free.len() == before || free.is_empty() {
                return reached;
            }
            left.copy_from_slice(residuals);
            for (j, &d) in reached.displacement.iter().enumerate() {
                if !free.contains(&j) {
                    add_scaled(&mut left, -d, jacobian.column(j));
                }
            }
            let reduced = LinearModel::new(jacobian.select_columns(&free), &left);
            step = reduced.step(&pick(scaling, &free), radius, damping);
        }
    }

    /// Puts the free parameters where the step leads, or onto the bound that it crosses; returns those still free.
    fn place(
        &self,
        x: &[f64],
        free: &[usize],
        step: &Step,
        reached: &mut BoundedStep,
    ) -> Vec<usize> {
        reached.damping = step.damping;
        let mut still_free = Vec::with_capacity(free.len());
        for (&j, &d) in free.iter().zip(&step.displacement) {
            let target = x[j] + d;
            let (lower, upper) = self.0[j];
            if target < lower || target > upper {
                let bound = if target < lower { lower } else { upper };
                reached.point[j] = bound;
                reached.displacement[j] = bound - x[j];
            } else {
                reached.point[j] = target;
                reached.displacement[j] = d;
                still_free.push(j);
            }
        }
        still_free
    }
}

/// The entries of `values` at `indices`.
pub fn pick(values: &[f64], indices: &[usize]) -> Vec<f64> {
    indices.iter().map(|&j| values[j]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_out_of_the_box_ends_on_it_and_the_others_make_up_for_it() {
        // y = a + b x through (0, 3), (1, 5), (2, 7), (3, 9), with a at most 1.
        let mut jacobian = Matrix::zeros(4, 2);
        for i in 0..4 {
            jacobian[(i, 0)] = 1.0;
            jacobian[(i, 1)] = i as f64;
        }
        let residuals = [3.0, 5.0, 7.0, 9.0];
        let bounds = Bounds::new(Some(&[(-1.0, 1.0), (-10.0, 10.0)]), 2);
        let model = LinearModel::new(jacobian.clone(), &residuals);
        let reached = bounds.step(
            &[0.0, 0.0],
            &[0, 1],
            &model,
            (&jacobian, &residuals),
            (&[1.0, 1.0], 100.0, 0.0),
        );
        assert_eq!(reached.point[0], 1.0);
        let slope = (4.0 + 2.0 * 6.0 + 3.0 * 8.0) / 14.0;
        assert!((reached.point[1] - slope).abs() < 1e-13);
    }

    #[test]
    fn parameters_pushed_outwards_are_held() {
        let bounds = Bounds::new(Some(&[(0.0, 1.0), (0.0, 1.0), (2.0, 2.0)]), 3);
        assert_eq!(bounds.free(&[0.0, 1.0, 2.0], &[1.0, 1.0, 1.0]), [0]);
        assert_eq!(bounds.project(&[-1.0, 0.5, 9.0]), [0.0, 0.5, 2.0]);
        assert!(!bounds.contain(&[0.5, f64::NAN, 2.0]));
    }
}
