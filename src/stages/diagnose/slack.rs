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
use pipeline_mechanics::models::{ForceModel, P_620_KPA, new};
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

/// The side of a reading of `force` N where the largest of the campaign is `largest`.
pub fn side(force: f64, largest: f64, at: &Conditions) -> Side {
    let below = -surface(at);
    // Where the law would push by `below`, the zero of a load cell alone is no pull: on the law it would be a miss of `below` and bend the
    // whole surface. On the law are readings that are as near to it, in size, as to 0.
    let halfway = below / 2.0;
    if force.abs() >= settings::NEAR_SLACK.max(halfway) * largest {
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
pub fn band(at: &Conditions) -> usize {
    let distance = surface(at).abs() / settings::CORNER_WIDTH;
    BAND_ENDS.iter().filter(|end| distance > **end).count()
}

/// The published law of the diameter, relative to the force at 620 kPa and not cut off where it is negative; of another diameter, that of 10 mm.
fn surface(at: &Conditions) -> f64 {
    let known = new::NewPublished.coefficients(at.diameter_mm as u32);
    let law = if known.is_empty() {
        &new::PUBLISHED_10[..]
    } else {
        known
    };
    let value = |symbol: &str| {
        law.iter()
            .find(|c| c.symbol == symbol)
            .map_or(0.0, |c| c.value)
    };
    let eps_620 = (at.rest_length_m - at.contracted_length_m) / at.rest_length_m;
    let contraction = (at.rest_length_m - at.length_m) / (at.rest_length_m * eps_620);
    let c = [value("c0"), value("c1"), value("c2")];
    new::surface_signed(c, contraction, at.pressure_kpa / P_620_KPA)
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

    #[test]
    fn sides_of_the_corner() {
        let at = |length_m: f64, kpa: f64| Conditions::at(0.3, 0.25, length_m, kpa);
        // The law of 20 mm pulls there.
        let mut thick = at(0.275, 200.0);
        assert_eq!(side(20.0, 1300.0, &thick), Side::Slack);
        thick.diameter_mm = 20.0;
        assert_eq!(side(20.0, 1300.0, &thick), Side::Corner);
        // A force where the law pulls, of either sign.
        assert_eq!(side(20.0, 450.0, &at(0.3, 620.0)), Side::Pulls);
        assert_eq!(side(-20.0, 450.0, &at(0.3, 620.0)), Side::Pulls);
        // Full contraction without pressure, where the law would push by 0.56 of 450 N: slack, whatever the zero of the load cell, unless the
        // force is as large as half of that.
        for zero in [1.0, -20.0, 20.0, 125.0] {
            assert_eq!(side(zero, 450.0, &at(0.25, 0.0)), Side::Slack);
        }
        assert_eq!(side(127.0, 450.0, &at(0.25, 0.0)), Side::Pulls);
        assert_eq!(side(-127.0, 450.0, &at(0.25, 0.0)), Side::Pulls);
        // None, at the resting length, where a millimetre decides.
        assert_eq!(side(1.0, 450.0, &at(0.3, 0.0)), Side::Corner);
        assert_eq!(side(13.4, 450.0, &at(0.3, 0.0)), Side::Corner);
        assert_eq!(side(13.6, 450.0, &at(0.3, 0.0)), Side::Pulls);
    }
}
