//! What is known of coefficients of the law beforehand, as further readings: of the logarithm, in units of its standard deviation.

use super::ForceProblem;
use crate::base::Base;
use pipeline_inference::problem::{Linearised, Point};
use pipeline_inference::variance::{Prior, Scale};

/// The class of noise of these readings: they are in standard deviations.
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
    /// Standard deviation of its logarithm.
    spread: f64,
}

impl Known {
    /// Of the coefficients that are fitted.
    pub(super) fn of(base: &Base) -> Vec<Self> {
        let fitted = base.coefficients.iter().enumerate();
        let known = fitted.filter(|(_, c)| c.free).filter_map(|(place, c)| {
            Some(Self {
                place,
                usual: c.start,
                spread: c.known?,
            })
        });
        known.collect()
    }

    /// The reading.
    pub(super) fn observed(&self) -> f64 {
        libm::log(self.usual) / self.spread
    }
}

impl ForceProblem<'_> {
    /// These readings as a point has them.
    pub(super) fn known_at<'p>(&'p self, point: &'p Point) -> impl Iterator<Item = f64> + 'p {
        let of = |k: &Known| libm::log(point.coefficients[k.place]) / k.spread;
        self.known.iter().map(of)
    }

    /// Adds them to a linear model: no group has a part in them, and no effect.
    pub(super) fn linearise_known(&self, point: &Point, linear: &mut Linearised) {
        linear.predicted.extend(self.known_at(point));
        for (k, known) in self.known.iter().enumerate() {
            let slope = 1.0 / (point.coefficients[known.place] * known.spread);
            linear.by_coefficients[known.place][self.data.len() + k] = slope;
            linear.random.push(vec![0.0; self.tree.width(0)]);
        }
    }
}
