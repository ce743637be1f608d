//! The full-size actuators of the biomimetic leg beside the human muscles that they stand for (the knee paper's Fig. 15).
//!
//! A 20 mm actuator stands for the short head of biceps femoris, one of 40 mm for the vasti. Their lengths are those that the laboratory built:
//! 423 mm (322 mm at 620 kPa), and 557 mm with the manufacturer's contraction of 25%. Nobody recorded their fittings, which are taken as
//! those of the 10 mm actuator.

use crate::curve::{angles, laws};
use pipeline_mechanics::knee::choice::named;
use pipeline_mechanics::knee::human::{VASTI, met, torque};
use pipeline_mechanics::knee::{Leg, Setup};
use pipeline_mechanics::models::{ForceModel, P_620_KPA, Prediction};
use serde::{Deserialize, Serialize};

/// Steps over the common range of both knees.
const STEPS: u32 = 130;
/// The range over which a human and a robot knee are compared, degrees.
const RANGE_DEG: (f64, f64) = (-120.0, 9.5);

/// One actuator beside one human muscle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Design {
    /// "flexor" or "extensor".
    pub muscle: String,
    /// The human muscle.
    pub human: String,
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_620, m.
    pub contracted_length_m: f64,
    /// Angles, rad.
    pub angles_rad: Vec<f64>,
    /// Torque of the human muscle, N.m.
    pub human_nm: Vec<f64>,
    /// Torque of the actuator by each of the laws, N.m.
    pub actuator_nm: Vec<Vec<Option<f64>>>,
    /// Angles at which the actuator's torque is at least the human's, degrees, by law: beginnings and ends.
    pub met_deg: Vec<Vec<(f64, f64)>>,
    /// The same where the law does not extrapolate.
    pub met_within_data_deg: Vec<Vec<(f64, f64)>>,
}

/// The two actuators of Fig. 15.
pub fn designs() -> Vec<Design> {
    let flexor = Setup {
        diameter_mm: 20.0,
        rest_length_m: 0.423,
        contracted_length_m: 0.322,
        fitting_m: 0.0254,
        tendon_m: 0.0,
    };
    let extensor = Setup {
        diameter_mm: 40.0,
        rest_length_m: 0.557,
        contracted_length_m: 0.75 * 0.557,
        ..flexor
    };
    let (Some(robot), Some(human)) = (named("biomimetic"), named("gait2392")) else {
        return Vec::new();
    };
    let all = [
        ("flexor", "bifemsh", &["bifemsh"][..], "flexor_20mm", flexor),
        ("extensor", "vasti", &VASTI[..], "extensor_10mm", extensor),
    ];
    let angles = angles((RANGE_DEG.0.to_radians(), RANGE_DEG.1.to_radians()), STEPS);
    all.into_iter()
        .filter_map(|(muscle, name, heads, route, setup)| {
            let at = |a: &f64| torque(&human, heads, *a);
            let human_nm = angles.iter().map(at).collect::<Option<Vec<f64>>>()?;
            let leg = robot.leg(route)?;
            let actuator_nm = by_law(&leg, &setup, &angles, &Prediction::force_n);
            let within_data = |p: &Prediction| match p {
                Prediction::Force(force) => Some(*force),
                _ => None,
            };
            let within_data = by_law(&leg, &setup, &angles, &within_data);
            let degrees: Vec<f64> = angles.iter().map(|a| a.to_degrees()).collect();
            let met = |found: &Vec<Option<f64>>| met(&degrees, &human_nm, found);
            Some(Design {
                muscle: muscle.to_owned(),
                human: name.to_owned(),
                diameter_mm: setup.diameter_mm as u32,
                rest_length_m: setup.rest_length_m,
                contracted_length_m: setup.contracted_length_m,
                met_deg: actuator_nm.iter().map(met).collect(),
                met_within_data_deg: within_data.iter().map(met).collect(),
                angles_rad: angles.clone(),
                human_nm,
                actuator_nm,
            })
        })
        .collect()
}

/// Torques by each of the laws, from as much of its prediction as `force` takes, N.m.
fn by_law(
    leg: &Leg,
    setup: &Setup,
    angles: &[f64],
    force: &dyn Fn(&Prediction) -> Option<f64>,
) -> Vec<Vec<Option<f64>>> {
    let of = |law: &&'static dyn ForceModel| {
        let at = |a: &f64| {
            let found = leg.torque(setup, *law, P_620_KPA, *a).ok()?;
            Some(found.arm_m * force(&found.force)?)
        };
        angles.iter().map(at).collect()
    };
    laws().iter().map(of).collect()
}
