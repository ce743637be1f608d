//! The braid of an ideal McKibben actuator, shared by the two models without rubber.
//!
//! Known for 10 and 20 mm only: the nominal diameter and the braid angle at rest of Martens and Boblan 2017, 28.6 deg - 0.1 rad
//! (22.9 deg) and 28.6 deg - 0.073 rad (24.4 deg); see [`super::martens2017`] for the unit. For 40 mm the angle is not published.

use super::Coefficient;
use super::martens_geometry::NOMINAL_ANGLE_RAD;

/// 10 mm: diameter at rest, braid angle against the axis at rest.
pub(super) static BRAID_10: [Coefficient; 2] = [
    Coefficient::new("D_rest", 0.010, "m"),
    Coefficient::new("theta_0", NOMINAL_ANGLE_RAD - 0.1, "rad"),
];

/// 20 mm: diameter at rest, braid angle against the axis at rest.
pub(super) static BRAID_20: [Coefficient; 2] = [
    Coefficient::new("D_rest", 0.020, "m"),
    Coefficient::new("theta_0", NOMINAL_ANGLE_RAD - 0.073, "rad"),
];

/// The braid for a nominal diameter in mm; empty where it is not known.
pub(super) fn braid(diameter_mm: u32) -> &'static [Coefficient] {
    match diameter_mm {
        10 => &BRAID_10,
        20 => &BRAID_20,
        _ => &[],
    }
}
