//! Torque over the angle before and after the loop, for figures.

use super::Group;
use super::operator::{At, Joint};
use super::refit::{Reading, Sizes};
use super::terms::TERMS;
use crate::stages::torque::curve;
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

/// The curves of every configuration of a joint.
pub(super) fn curves(
    group: &Group,
    sizes: &Sizes,
    held_out: &[(usize, Sizes)],
    fold: fn(&Reading) -> usize,
) -> Vec<BeforeAfter> {
    let several = group.actuators.len() > 1;
    let mut all = Vec::new();
    for (build, configuration) in &group.members {
        let joint = Joint::new(build, group.law);
        let tests = &configuration.tests;
        let of = |r: &&Reading| tests.iter().any(|t| t.session == group.sessions[r.test]);
        let own: Vec<&Reading> = group.all.iter().filter(of).collect();
        let measured = own.iter().map(|r| r.at.angle_rad);
        let (low, high) = measured.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| {
            (l.min(a), h.max(a))
        });
        let (first, last) = build.knee.joint.range;
        let range = ((low - BEYOND).max(first), (high + BEYOND).min(last));
        let without = own.first().and_then(|r| {
            let found = held_out.iter().find(|(f, _)| *f == fold(r));
            found.filter(|_| several).map(|(_, sizes)| sizes)
        });
        if own.is_empty() {
            continue;
        }
        let angles_rad = curve::angles(range, STEPS);
        for pressure_kpa in curve::pressures(configuration) {
            let torque = |values: &[f64; TERMS]| -> Vec<Option<f64>> {
                let at = |angle: &f64| {
                    let torque = joint.torque(&At::still(*angle, pressure_kpa), values).0;
                    Some(torque).filter(|t| t.is_finite())
                };
                angles_rad.iter().map(at).collect()
            };
            all.push(BeforeAfter {
                configuration: configuration.id.clone(),
                pressure_kpa,
                rigid: torque(&[0.0; TERMS]),
                after: torque(&sizes.values),
                held_out: without.map_or_else(Vec::new, |s| torque(&s.values)),
                angles_rad: angles_rad.clone(),
            });
        }
    }
    all
}
