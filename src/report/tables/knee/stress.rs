//! `knee_stress`: axial stress in the wall of an actuator.

use super::decimals;
use crate::input::ReportInput;
use crate::table::{Column, Table};

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::number("diameter_mm", "⌀", "mm"),
        Column::number("wall_mm", "Wall", "mm"),
        Column::number("thick_kpa", "Eq. 13", "kPa"),
        Column::number("as_worded_kpa", "Eq. 13 as worded", "kPa"),
        Column::number("thin_kpa", "Eq. 14", "kPa"),
    ];
    let mut table = Table::new(
        "knee_stress",
        "Axial stress in the wall of a closed actuator at 620 kPa, for walls that the paper does not state",
        columns,
    )
    .note("Eq. 13 holds with the inner diameter; as worded, with the mean diameter, it is too high.");
    for w in input.knee.iter().flat_map(|k| &k.reference.walls) {
        table.push(vec![
            decimals(w.diameter_mm, 0),
            decimals(w.wall_mm, 1),
            decimals(w.thick_kpa, 0),
            decimals(w.as_worded_kpa, 0),
            decimals(w.thin_kpa, 0),
        ]);
    }
    table
}
