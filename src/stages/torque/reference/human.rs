//! The human muscles beside OpenSim's exports of Gait2392, and beside the laboratory's design targets.
//!
//! There is no export of the torque of bifemsh. The design targets are moment arm times maximum isometric force, without the muscle's
//! dependence on length, tendon and pennation: no other calculation of the same torque, but what the knee paper's Fig. 15 calls human.

use super::{largest, rms};
use pipeline_mechanics::knee::choice::named;
use pipeline_mechanics::knee::data;
use pipeline_mechanics::knee::human::{VASTI, torque};
use serde::{Deserialize, Serialize};

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Compares {
    /// Moment arm, m.
    Arm,
    /// Torque, N.m.
    Torque,
}

impl Compares {
    /// As tables have it.
    pub fn name(self) -> &'static str {
        match self {
            Compares::Arm => "moment arm",
            Compares::Torque => "torque",
        }
    }
}

/// A calculated curve beside a reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// The muscle, or `vasti` for the sum of the three.
    pub muscle: String,
    /// What.
    pub what: Compares,
    /// Beside what.
    pub against: String,
    /// Angle in rad, calculated, reference; m or N.m.
    pub rows: Vec<(f64, f64, f64)>,
    /// Root mean square of calculated minus reference, m or N.m.
    pub rms: f64,
    /// Largest difference, m or N.m.
    pub max: f64,
    /// Its angle, degrees.
    pub at_deg: f64,
    /// The largest difference over the reference at its own angle.
    pub max_relative: f64,
    /// What is left, explained.
    pub why: String,
}

const OPENSIM: &str = "OpenSim, Gait2392";
/// What a torque is compared with where a designer asked for it.
pub const TARGET: &str = "design target";

const WHY_FLEXOR: &str = "the rounding of the exported file";
const WHY_VASTI: &str =
    "the rotation of the patella, found from the arms of vas_lat and vas_med at 13 knots";
const WHY_TORQUE: &str =
    "the arm; the tendon's force alone, torque over exported arm, agrees within 0.2%";
const WHY_TARGET: &str = "the target leaves out force-length curve, tendon and pennation";

/// All comparisons.
pub fn compared() -> Vec<Compared> {
    let Some(knee) = named("gait2392") else {
        return Vec::new();
    };
    let arm = |muscle: &str, file, column: &str, why| {
        let leg = knee.leg(muscle)?;
        let rows = export(file, column, |angle| leg.arm(angle).ok())?;
        Some(new(muscle, Compares::Arm, OPENSIM, rows, why))
    };
    let torque_of = |muscles: &[&str], angle: f64| torque(&knee, muscles, angle);
    let arms = "opensim_vasti_moment_arm.csv";
    let torques = "opensim_vasti_torque.csv";
    let mut all = vec![arm(
        "bifemsh",
        "opensim_bifemsh_moment_arm.csv",
        "moment_arm_m",
        WHY_FLEXOR,
    )];
    all.extend(VASTI.map(|m| arm(m, arms, &format!("{m}_m"), WHY_VASTI)));
    all.extend(VASTI.map(|m| {
        let rows = export(torques, &format!("{m}_nm"), |a| torque_of(&[m], a))?;
        Some(new(m, Compares::Torque, OPENSIM, rows, WHY_TORQUE))
    }));
    all.push(sum_of_vasti(torques, |a| torque_of(&VASTI, a)));
    all.push(
        export("human_torque_target_bifemsh.csv", "torque_nm", |a| {
            torque_of(&["bifemsh"], a)
        })
        .map(|rows| new("bifemsh", Compares::Torque, TARGET, rows, WHY_TARGET)),
    );
    all.push(
        export("human_torque_target_vasti.csv", "group_nm", |a| {
            torque_of(&VASTI, a)
        })
        .map(|rows| new("vasti", Compares::Torque, TARGET, rows, WHY_TARGET)),
    );
    all.into_iter().flatten().collect()
}

fn sum_of_vasti(file: &str, calculated: impl Fn(f64) -> Option<f64>) -> Option<Compared> {
    let mut rows = export(file, "vas_int_nm", calculated)?;
    for muscle in ["vas_lat_nm", "vas_med_nm"] {
        let table = data::table(file).ok()?;
        for (row, torque) in rows.iter_mut().zip(table.numbers(muscle).ok()?) {
            row.2 += torque;
        }
    }
    Some(new("vasti", Compares::Torque, OPENSIM, rows, WHY_TORQUE))
}

/// A column of an embedded table with the calculated values at its angles.
fn export(
    file: &str,
    column: &str,
    calculated: impl Fn(f64) -> Option<f64>,
) -> Option<Vec<(f64, f64, f64)>> {
    let table = data::table(file).ok()?;
    let angles = table.numbers("knee_angle_deg").ok()?;
    let values = table.numbers(column).ok()?;
    // The first and last row stand at the ends of the range, which rounding may put outside.
    let pairs = angles
        .iter()
        .map(|a| a.clamp(-120.0, 10.0).to_radians())
        .zip(values);
    let row = |(angle, value)| Some((angle, calculated(angle)?, value));
    Some(pairs.filter_map(row).collect())
}

fn new(
    muscle: &str,
    what: Compares,
    against: &str,
    rows: Vec<(f64, f64, f64)>,
    why: &str,
) -> Compared {
    let differences: Vec<f64> = rows.iter().map(|r| r.1 - r.2).collect();
    let (max, at_deg) = largest(rows.iter().map(|r| (r.0, r.1 - r.2)));
    let relative = rows.iter().map(|r| (r.1 / r.2 - 1.0).abs());
    Compared {
        muscle: muscle.to_owned(),
        what,
        against: against.to_owned(),
        rms: rms(&differences),
        max,
        at_deg,
        max_relative: relative.fold(0.0, f64::max),
        why: why.to_owned(),
        rows,
    }
}
