//! The way from a point to the estimates of its linear model, inside the bounds, shortened until the penalised sum of squares does not rise.

use super::{Free, Setting};
use crate::gram::{Design, Gram};
use crate::problem::Point;
use crate::system::{Estimates, Factor, Panel, Variances};

/// Shortest part of a step that is tried.
pub(crate) const SHORTEST: f64 = 1.0 / 256.0;

pub(super) struct Moved {
    pub(super) point: Point,
    pub(super) stopped: Vec<Free>,
}

impl Setting<'_> {
    /// Moves from a point with these predictions to the estimates of the linear model, shortened until the penalised sum of squares does not rise.
    pub(super) fn step(
        &self,
        (point, predicted): (&Point, &[f64]),
        (design, gram): (&Design, &Gram),
        free: &[Free],
        estimates: &Estimates,
        variances: &Variances,
        longest: f64,
    ) -> Moved {
        let alone = self.linear_only(variances);
        let linear = Factor::new(&design.tree, gram, &alone);
        let value = |p: &Point, predicted: &[f64]| {
            self.objective(p, predicted, (design, &linear), variances)
        };
        let at = |p: &Point| value(p, &self.problem.predict(p));
        let old = value(point, predicted);
        let (next, stopped) = self.moved(point, free, estimates, longest);
        if falls(at(&next), old) {
            return Moved {
                point: next,
                stopped,
            };
        }
        // New variances may punish the old random effects so much that any step would do, or favour the new ones so much that none that keeps
        // part of the old ones does: shorter steps start from the better of both. The estimates are the minimum of a convex function, downhill
        // from either.
        let mut renewed = point.clone();
        renewed.random.clone_from(&estimates.random);
        let new = at(&renewed);
        let (from, here) = if new < old {
            (&renewed, new)
        } else {
            (point, old)
        };
        let mut length = longest;
        loop {
            let (next, stopped) = self.moved(from, free, estimates, length);
            if falls(at(&next), here) || length <= SHORTEST {
                return Moved {
                    point: next,
                    stopped,
                };
            }
            length *= 0.5;
        }
    }

    fn moved(
        &self,
        point: &Point,
        free: &[Free],
        estimates: &Estimates,
        length: f64,
    ) -> (Point, Vec<Free>) {
        let mut next = point.clone();
        for (b, to) in next.random.iter_mut().zip(&estimates.random) {
            *b += length * (to - *b);
        }
        let mut stopped = Vec::new();
        for (f, d) in free.iter().zip(&estimates.fixed) {
            let (value, (low, high)) = match *f {
                Free::Coefficient(k) => (
                    &mut next.coefficients[k],
                    self.problem.coefficients()[k].bounds,
                ),
                Free::Value(t, k) => {
                    let (term, values) = &mut next.terms[t];
                    (&mut values[k], self.problem.terms()[*term].bounds[k])
                }
            };
            let wanted = *value + length * d;
            let bounded = wanted.clamp(low, high);
            // A bound that is met twice holds.
            if bounded != wanted && bounded == *value {
                stopped.push(*f);
            }
            *value = bounded;
        }
        (next, stopped)
    }

    /// Penalised sum of squares at a point with these predictions, the least over the random effects of linear components: wherever the others
    /// go, these follow at once. `linear` is the factor of a system that knows no others.
    pub(crate) fn objective(
        &self,
        point: &Point,
        predicted: &[f64],
        (design, linear): (&Design, &Factor),
        variances: &Variances,
    ) -> f64 {
        let readings = self.problem.observed().iter().zip(predicted);
        let left = readings.map(|(y, p)| y - p).collect();
        let panel = Panel::new(design, linear.gram(), &[left]);
        let sum = linear.project(&panel).unprojected[0];
        let tree = self.problem.tree();
        let components = (0..tree.len()).flat_map(|n| tree.components_of(n));
        let effects = point.random.iter().zip(components);
        let penalty = effects.map(|(b, c)| {
            let is_open = !self.problem.components()[c].linear && *b != 0.0;
            let u = b / variances.components[c].max(f64::MIN_POSITIVE);
            if is_open { u * u } else { 0.0 }
        });
        sum + penalty.sum::<f64>()
    }

    /// The variances with no components but those in which the forward model is linear.
    pub(crate) fn linear_only(&self, variances: &Variances) -> Variances {
        let mut alone = variances.clone();
        let components = alone.components.iter_mut().zip(self.problem.components());
        for (sd, _) in components.filter(|(_, c)| !c.linear) {
            *sd = 0.0;
        }
        alone
    }

    /// The free values that stand at a bound and would go on.
    pub(super) fn pressed(&self, point: &Point, free: &[Free], estimates: &Estimates) -> Vec<Free> {
        let steps = free.iter().zip(&estimates.fixed);
        let pressed = steps.filter(|(f, step)| {
            let (value, (low, high)) = self.bounded(point, **f);
            (value <= low && **step < 0.0) || (value >= high && **step > 0.0)
        });
        pressed.map(|(f, _)| *f).collect()
    }

    /// A value with its bounds.
    fn bounded(&self, point: &Point, free: Free) -> (f64, (f64, f64)) {
        match free {
            Free::Coefficient(k) => (point.coefficients[k], self.problem.coefficients()[k].bounds),
            Free::Value(t, k) => {
                let (term, values) = &point.terms[t];
                (values[k], self.problem.terms()[*term].bounds[k])
            }
        }
    }

    pub(super) fn inside(&self, point: &Point) -> Point {
        let mut point = point.clone();
        for (x, c) in point
            .coefficients
            .iter_mut()
            .zip(self.problem.coefficients())
        {
            *x = x.clamp(c.bounds.0, c.bounds.1);
        }
        for (term, values) in &mut point.terms {
            for (x, (low, high)) in values.iter_mut().zip(&self.problem.terms()[*term].bounds) {
                *x = x.clamp(*low, *high);
            }
        }
        point
    }

    /// For each coefficient whether it is fitted and stands at a bound.
    pub(super) fn at_bound(&self, point: &Point) -> Vec<bool> {
        let coefficients = self.problem.coefficients();
        let values = point.coefficients.iter().zip(coefficients);
        values
            .map(|(x, c)| c.free && (*x <= c.bounds.0 || *x >= c.bounds.1))
            .collect()
    }
}

/// Whether a penalised sum of squares does not rise.
fn falls(to: f64, from: f64) -> bool {
    to.is_finite() && to <= from * (1.0 + 1e-9)
}
