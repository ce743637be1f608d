//! Readings of actuators that are slack, and of those that are nearly.
//!
//! A law of the force ends in a corner where the actuator goes slack. There a linearised model has no fixed point: on one side a reading pulls
//! with all its weight, on the other it says nothing, and the likelihood jumps by tens from one iteration to the next. Real actuators go
//! slack gradually besides. So every reading is on one side of the corner from the start: with a force that is clearly not zero it is on the
//! law, which is then smooth; with none, or with less than half of what the law would push there, where the law says that it is slack by far,
//! the law is 0; in between the corner is rounded, and the noise is that of the rounding.

use super::base::Base;
use super::settings;
use pipeline_effects::{Actuator, Conditions};
use pipeline_mechanics::models::{P_620_KPA, new};
use pipeline_numerics::real::Real;

/// On which side of the corner a reading is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// It pulls (or pushes, which is a mistake): on the law.
    Pulls,
    /// Slack: the law is 0.
    Slack,
    /// In between.
    Corner,
    /// On whichever side the law says, as the papers have it: with a corner, for plain least squares.
    AsPublished,
}

/// The coefficients c0, c1 and c2 of the law that tells where an actuator is slack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape(pub [f64; 3]);

impl Shape {
    /// The published ones of a diameter.
    pub fn published(diameter_mm: u32) -> Option<Self> {
        new::published(diameter_mm, ["c0", "c1", "c2"]).map(Self)
    }

    /// The same; of a diameter without any, those of 10 mm.
    pub fn usual(diameter_mm: u32) -> Self {
        let of = |diameter_mm| Self::published(diameter_mm);
        of(diameter_mm).or_else(|| of(10)).unwrap_or(Self([0.0; 3]))
    }

    /// The force relative to that at 620 kPa, not cut off where it is negative.
    fn force(&self, at: &Conditions) -> f64 {
        let eps_620 = (at.rest_length_m - at.contracted_length_m) / at.rest_length_m;
        let contraction = (at.rest_length_m - at.length_m) / (at.rest_length_m * eps_620);
        new::surface_signed(self.0, contraction, at.pressure_kpa / P_620_KPA)
    }
}

/// The side of a reading of `force` N where the largest of the campaign is `largest`, and readings up to a share `near` of it may be of an actuator
/// that is slack.
pub fn side(force: f64, near: f64, largest: f64, at: &Conditions, shape: &Shape) -> Side {
    let below = -shape.force(at);
    // Where the law would push by `below`, the zero of a load cell alone is no pull: on the law it would be a miss of `below` and bend the
    // whole surface. On the law are readings that are as near to it, in size, as to 0.
    let halfway = below / 2.0;
    if force.abs() >= near.max(halfway) * largest {
        Side::Pulls
    } else if below > settings::SURELY_SLACK {
        Side::Slack
    } else {
        Side::Corner
    }
}

/// Parts of the corner, by the distance from where the law is 0: what rounding leaves grows towards it, and with it the noise that readings show.
pub const BANDS: usize = BAND_ENDS.len() + 1;
/// Where they end, in widths of the rounding, which is wrong by 1/2 of a width at the corner, by 0.31, 0.15 and 0.08 at these.
const BAND_ENDS: [f64; 3] = [0.5, 1.5, 3.0];

/// The band of a reading in the corner, the nearest first.
pub fn band(at: &Conditions, shape: &Shape) -> usize {
    let distance = shape.force(at).abs() / settings::CORNER_WIDTH;
    BAND_ENDS.iter().filter(|end| distance > **end).count()
}

/// The base law on one side of the corner.
pub struct Sided<'a> {
    /// The law.
    pub base: &'a Base,
    /// The side.
    pub side: Side,
}

impl Actuator for Sided<'_> {
    fn force<R: Real>(&self, coefficients: &[R], pressure: R, length: R, at: &Conditions) -> R {
        match self.side {
            Side::Pulls => self.base.force(coefficients, pressure, length, at),
            Side::Slack => R::constant(0.0),
            Side::AsPublished => self
                .base
                .force(coefficients, pressure, length, at)
                .positive_part(),
            Side::Corner => {
                let width = settings::CORNER_WIDTH;
                self.base.rounded(coefficients, pressure, length, at, width)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use settings::NEAR_SLACK;

    #[test]
    fn sides_of_the_corner() {
        let thin = Shape::usual(10);
        let of = |force, largest, at: &Conditions, shape: &Shape| {
            side(force, NEAR_SLACK, largest, at, shape)
        };
        let at = |length_m: f64, kpa: f64| Conditions::at(0.3, 0.25, length_m, kpa);
        // The law of 20 mm pulls there.
        let half = at(0.275, 200.0);
        assert_eq!(of(20.0, 1300.0, &half, &thin), Side::Slack);
        assert_eq!(of(20.0, 1300.0, &half, &Shape::usual(20)), Side::Corner);
        // A force where the law pulls, of either sign.
        assert_eq!(of(20.0, 450.0, &at(0.3, 620.0), &thin), Side::Pulls);
        assert_eq!(of(-20.0, 450.0, &at(0.3, 620.0), &thin), Side::Pulls);
        // Full contraction without pressure, where the law would push by 0.56 of 450 N: slack, whatever the zero of the load cell, unless the
        // force is as large as half of that.
        for zero in [1.0, -20.0, 20.0, 125.0] {
            assert_eq!(of(zero, 450.0, &at(0.25, 0.0), &thin), Side::Slack);
        }
        assert_eq!(of(127.0, 450.0, &at(0.25, 0.0), &thin), Side::Pulls);
        assert_eq!(of(-127.0, 450.0, &at(0.25, 0.0), &thin), Side::Pulls);
        // None, at the resting length, where a millimetre decides.
        assert_eq!(of(1.0, 450.0, &at(0.3, 0.0), &thin), Side::Corner);
        assert_eq!(of(13.4, 450.0, &at(0.3, 0.0), &thin), Side::Corner);
        assert_eq!(of(13.6, 450.0, &at(0.3, 0.0), &thin), Side::Pulls);
    }
}
