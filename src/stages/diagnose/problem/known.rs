//! What is known of coefficients of the law beforehand, as further readings, in units of their standard deviations.

use super::ForceProblem;
use crate::base::Base;
use pipeline_inference::problem::{Linearised, Point};
use pipeline_inference::variance::{Prior, Scale};

/// The class of noise of these readings.
pub(super) const NOISE: Scale = Scale {
    prior: Prior::Fixed(1.0),
    usual: 1.0,
    groups: 1,
};

/// What is known of one coefficient.
pub(super) struct Known {
    /// Place among the coefficients.
    place: usize,
    /// Its usual value.
    usual: f64,
    /// The standard deviation about it.
    to: f64,
}

impl Known {
    /// Of the coefficients of a law.
    pub(super) fn of(base: &Base) -> Vec<Self> {
        let all = base.coefficients.iter().enumerate();
        let known = all.filter_map(|(place, c)| {
            let (usual, to) = c.known?;
            Some(Self { place, usual, to })
        });
        known.collect()
    }

    /// The reading.
    pub(super) fn observed(&self) -> f64 {
        self.usual / self.to
    }
}

impl ForceProblem<'_> {
    /// What a point has for these readings.
    pub(super) fn known_at<'p>(&'p self, point: &'p Point) -> impl Iterator<Item = f64> + 'p {
        let of = |k: &Known| point.coefficients[k.place] / k.to;
        self.known.iter().map(of)
    }

    /// Adds them to a linear model: no group has a part in them, and no effect.
    pub(super) fn linearise_known(&self, point: &Point, linear: &mut Linearised) {
        linear.predicted.extend(self.known_at(point));
        for (k, known) in self.known.iter().enumerate() {
            linear.by_coefficients[known.place][self.data.len() + k] = 1.0 / known.to;
            linear.random.push(vec![0.0; self.tree.width(0)]);
        }
    }
}
