//! Torque over the angle before and after the loop, for figures.

use super::data::Reading;
use super::operator::{At, Joint};
use super::terms::SIZES;
use crate::Configuration;
use crate::build::Build;
use crate::curve;
use serde::{Deserialize, Serialize};

/// Steps of the angle.
const STEPS: u32 = 80;
/// Beyond what was measured by so much, rad.
const BEYOND: f64 = 0.09;

/// Torques of one configuration at one gauge pressure, N.m; none where there is no answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeforeAfter {
    /// Id of the configuration.
    pub configuration: String,
    /// kPa.
    pub pressure_kpa: f64,
    /// Knee angles, rad.
    pub angles_rad: Vec<f64>,
    /// The rigid leg.
    pub rigid: Vec<Option<f64>>,
    /// With the effects, as the joint has them before it turned: no friction.
    pub after: Vec<Option<f64>>,
    /// With the effects that were found without the actuator; empty where whole actuators are not held out.
    pub held_out: Vec<Option<f64>>,
}

/// The curves of one configuration, whose readings these are; `without` are the sizes that were found without its actuator.
pub fn of_configuration(
    joint: &Joint,
    (build, configuration): (&Build, &Configuration),
    own: &[Reading],
    sizes: &[f64; SIZES],
    without: Option<&[f64; SIZES]>,
) -> Vec<BeforeAfter> {
    if own.is_empty() {
        return Vec::new();
    }
    let measured = own.iter().map(|r| r.at.angle_rad);
    let (low, high) = measured.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| {
        (l.min(a), h.max(a))
    });
    let (first, last) = build.knee.joint.range;
    let range = ((low - BEYOND).max(first), (high + BEYOND).min(last));
    let angles_rad = curve::angles(range, STEPS);
    let at_pressure = |pressure_kpa: f64| {
        let torque = |sizes: &[f64; SIZES]| -> Vec<Option<f64>> {
            let at = |angle: &f64| {
                let shown = joint.seen(&At::still(*angle, pressure_kpa), sizes)?;
                Some(shown.torque).filter(|t| t.is_finite())
            };
            angles_rad.iter().map(at).collect()
        };
        BeforeAfter {
            configuration: configuration.id.clone(),
            pressure_kpa,
            rigid: torque(&[0.0; SIZES]),
            after: torque(sizes),
            held_out: without.map_or_else(Vec::new, torque),
            angles_rad: angles_rad.clone(),
        }
    };
    curve::pressures(configuration)
        .into_iter()
        .map(at_pressure)
        .collect()
}
