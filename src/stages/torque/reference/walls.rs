//! Axial stress in the wall of an actuator at 620 kPa (the knee paper's Eqs. 13 and 14), for walls of one to two millimetres: the paper states no
//! wall.

use pipeline_mechanics::knee::stress::{thick_wall, thin_wall};
use pipeline_mechanics::models::P_620_KPA;
use serde::{Deserialize, Serialize};

/// One diameter and wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// Inner diameter, mm.
    pub diameter_mm: f64,
    /// Thickness of the wall, mm.
    pub wall_mm: f64,
    /// Eq. 13 with the inner diameter, kPa.
    pub thick_kpa: f64,
    /// Eq. 13 with the mean diameter, as the paper words it, kPa.
    pub as_worded_kpa: f64,
    /// Eq. 14, kPa.
    pub thin_kpa: f64,
}

/// The stress for every diameter.
pub fn walls() -> Vec<Wall> {
    let all = [10.0, 20.0, 40.0]
        .into_iter()
        .flat_map(|d| [1.0, 1.5, 2.0].map(|t| (d, t)));
    all.map(|(diameter_mm, wall_mm)| Wall {
        diameter_mm,
        wall_mm,
        thick_kpa: thick_wall(P_620_KPA, diameter_mm, wall_mm),
        as_worded_kpa: thick_wall(P_620_KPA, diameter_mm + wall_mm, wall_mm),
        thin_kpa: thin_wall(P_620_KPA, diameter_mm, wall_mm),
    })
    .collect()
}
