//! One reading of torque: geometry at its angle, what every model predicts, and what length and arm measured by hand give.

use crate::build::Build;
use pipeline_base::columns::{ANGLE, MOMENT_ARM, MUSCLE_LENGTH, TORQUE};
use pipeline_base::row::Row;
use pipeline_mechanics::knee::Geometry;
use pipeline_mechanics::models::ForceModel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Log file.
    pub log: String,
    /// Line in the log, counted from 1.
    pub row: i64,
    /// Knee angle, rad, flexion negative.
    pub angle_rad: f64,
    /// Measured torque, N.m, flexion negative.
    pub torque_nm: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// What was measured by hand.
    pub by_hand: ByHand,
    /// Every other column of the reading, by name.
    pub extras: BTreeMap<String, f64>,
    /// What the leg has at the angle; none beyond the range of its joint.
    pub expected: Option<Expected>,
    /// Why there is no geometry.
    pub beyond: Option<String>,
    /// Every model's torque, N.m; none where it has no answer.
    pub predicted: Vec<Answer>,
    /// Every model's torque from the length and the arm measured by hand, N.m.
    pub back_calculated: Vec<Option<f64>>,
}

/// Length and arm by tape measure, and what follows from them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ByHand {
    /// l_m, m.
    pub length_m: Option<f64>,
    /// eps*.
    pub contraction_rel: Option<f64>,
    /// r, m, with the sign of the torque.
    pub arm_m: Option<f64>,
    /// One standard deviation of l_m as declared, m.
    pub length_sd_m: Option<f64>,
    /// One standard deviation of r as declared, m.
    pub arm_sd_m: Option<f64>,
}

/// What the geometry says at an angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    /// L_MT, m.
    pub path_length_m: f64,
    /// l_m, m.
    pub length_m: f64,
    /// eps*.
    pub contraction_rel: f64,
    /// r = -dL_MT/dtheta (Eq. 2), m.
    pub arm_m: f64,
    /// r by projection about the instantaneous centre (Eq. 3), m.
    pub projected_arm_m: f64,
    /// Share of the force that acts in the plane of the motion.
    pub in_plane: f64,
}

/// A model's torque at a reading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// N.m; none where the model has no answer.
    pub torque_nm: Option<f64>,
    /// Whether the state lies beyond the model's data.
    pub extrapolated: bool,
}

impl Expected {
    /// What a leg has, with the actuator of a build.
    pub fn new(build: &Build, geometry: &Geometry) -> Self {
        let length_m = build.setup.actuator_length(geometry.length_m);
        Self {
            path_length_m: geometry.length_m,
            length_m,
            contraction_rel: build.setup.state(length_m, 0.0).contraction_rel(),
            arm_m: geometry.arm_m,
            projected_arm_m: geometry.about_centre.arm_m,
            in_plane: geometry.about_centre.in_plane,
        }
    }
}

/// The point of a row.
pub fn point(build: &Build, row: &Row, models: &[&dyn ForceModel]) -> Point {
    let extra = |column: &str| row.extras.get(column).copied().filter(|x| x.is_finite());
    let angle_rad = extra(ANGLE).unwrap_or(f64::NAN);
    let torque_nm = extra(TORQUE).unwrap_or(f64::NAN);
    let geometry = build.leg().geometry(angle_rad);
    let expected = geometry.as_ref().ok().map(|g| Expected::new(build, g));
    // A tape measure has no sign: the arm has that of the path's.
    let sign = expected.map_or(torque_nm, |e| e.arm_m).signum();
    let by_hand = ByHand {
        length_m: extra(MUSCLE_LENGTH),
        contraction_rel: Some(row.contraction_rel).filter(|x| x.is_finite()),
        arm_m: extra(MOMENT_ARM).map(|arm| sign * arm.abs()),
        length_sd_m: Some(row.muscle_length_sd_m).filter(|x| x.is_finite()),
        arm_sd_m: Some(row.moment_arm_sd_m).filter(|x| x.is_finite()),
    };
    let predict = |model: &&dyn ForceModel| match expected {
        None => Answer::NONE,
        Some(e) => answer(build, *model, row.pressure_kpa, &e),
    };
    let back = |model: &&dyn ForceModel| {
        let (length, arm) = (by_hand.length_m?, by_hand.arm_m?);
        build
            .setup
            .back_calculated(*model, row.pressure_kpa, length, arm)
    };
    Point {
        log: row.log.clone(),
        row: row.first_row,
        angle_rad,
        torque_nm,
        pressure_kpa: row.pressure_kpa,
        by_hand,
        extras: others(row),
        expected,
        beyond: geometry.err().map(|beyond| beyond.to_string()),
        predicted: models.iter().map(predict).collect(),
        back_calculated: models.iter().map(back).collect(),
    }
}

/// The columns of a row that are no part of the torque.
fn others(row: &Row) -> BTreeMap<String, f64> {
    const OWN: [&str; 4] = [ANGLE, TORQUE, MUSCLE_LENGTH, MOMENT_ARM];
    let all = row.extras.iter();
    let others = all.filter(|(name, x)| !OWN.contains(&name.as_str()) && x.is_finite());
    others.map(|(name, x)| (name.clone(), *x)).collect()
}

impl Answer {
    const NONE: Answer = Answer {
        torque_nm: None,
        extrapolated: false,
    };
}

/// M = r F of a model.
fn answer(build: &Build, model: &dyn ForceModel, pressure_kpa: f64, e: &Expected) -> Answer {
    let prediction = model.predict(&build.setup.state(e.length_m, pressure_kpa));
    let torque_nm = prediction.force_n().map(|force| e.arm_m * force);
    Answer {
        torque_nm,
        extrapolated: torque_nm.is_some() && prediction.reason().is_some(),
    }
}
