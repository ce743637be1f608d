//! The instantaneous centre of the biomimetic knee, three ways: as tabulated, where the links of the four-bar linkage cross, and about which the
//! tabulated motion turns, c = p + z x dp/dtheta.

use super::{largest, rms};
use crate::curve::angles;
use pipeline_mechanics::knee::choice::named;
use pipeline_mechanics::knee::joint::Joint;
use serde::{Deserialize, Serialize};

/// Steps over the range of the joint.
const STEPS: u32 = 150;

/// Two ways compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Centres {
    /// Beside the tabulated centre.
    pub other: String,
    /// Angles.
    pub n: usize,
    /// Root mean square of the distance, m.
    pub rms_m: f64,
    /// Largest distance, m.
    pub max_m: f64,
    /// Its angle, degrees.
    pub at_deg: f64,
}

/// The tabulated centre beside the linkage's and beside that of its own motion.
pub fn centres() -> Vec<Centres> {
    let (Some(table), Some(linkage)) = (named("biomimetic"), named("biomimetic_linkage")) else {
        return Vec::new();
    };
    let (table, linkage) = (table.joint, linkage.joint);
    vec![
        compared("crossing of the four-bar linkage's links", &table, |a| {
            linkage.centre(a).ok()
        }),
        compared("motion of the tibia, p + z × dp/dθ", &table, |a| {
            let (pose, rate) = table.pose_and_rate(a).ok()?;
            Some([pose.origin[0] - rate[1], pose.origin[1] + rate[0]])
        }),
    ]
}

fn compared(other: &str, table: &Joint, centre: impl Fn(f64) -> Option<[f64; 2]>) -> Centres {
    let distances: Vec<(f64, f64)> = angles(table.range, STEPS)
        .into_iter()
        .filter_map(|angle| {
            let ([ax, ay], [bx, by]) = (table.centre(angle).ok()?, centre(angle)?);
            Some((angle, libm::hypot(ax - bx, ay - by)))
        })
        .collect();
    let (max_m, at_deg) = largest(distances.iter().copied());
    let only: Vec<f64> = distances.iter().map(|d| d.1).collect();
    Centres {
        other: other.to_owned(),
        n: only.len(),
        rms_m: rms(&only),
        max_m,
        at_deg,
    }
}
