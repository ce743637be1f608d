//! `knee_stress`: axial stress in the wall of an actuator.

use crate::described::*;
use crate::input::ReportInput;
use pipeline_torque::reference::walls::Wall;

/// One row a wall.
#[rustfmt::skip]
pub fn stress(input: &ReportInput) -> Table {
    Described::<&Wall>::new("knee_stress", "Axial stress in the wall of a closed actuator at 620 kPa, for walls that the paper does not state")
        .number("diameter_mm", "⌀", Mm, Decimals(0), |w| w.diameter_mm)
        .number("wall_mm", "Wall", Mm, Decimals(1), |w| w.wall_mm)
        .number("thick_kpa", "paper Eq. 13", KPa, Decimals(0), |w| w.thick_kpa)
        .number("as_worded_kpa", "the same as worded", KPa, Decimals(0), |w| w.as_worded_kpa)
        .number("thin_kpa", "paper Eq. 14", KPa, Decimals(0), |w| w.thin_kpa)
        .note("The paper's Eq. 13 holds with the inner diameter; as worded, with the mean diameter, it is too high.")
        .rows(input.knee.iter().flat_map(|k| &k.reference.walls))
}
