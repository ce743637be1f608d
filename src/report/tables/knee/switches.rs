//! `knee_switches`: what happens to a path where a point comes in.

use super::{decimals, mm};
use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("knee", "Knee"),
        Column::text("route", "Route"),
        Column::number("angle_deg", "Angle", "°"),
        Column::number("length_jump_mm", "Length", "mm"),
        Column::number("arm_jump_mm", "Arm", "mm"),
    ];
    let mut table = Table::new(
        "knee_switches",
        "Points of a route that begin or cease to take part: the jump of length and moment arm, just above the angle less just below it",
        columns,
    )
    .note("A jump of length is a flaw of the route: the point does not lie on the line that it bends. A jump of the arm alone is a path that folds over an edge.");
    for a in input.knee.iter().flat_map(|k| &k.reference.arms) {
        for s in &a.switches {
            table.push(vec![
                Cell::text(&a.knee),
                Cell::text(&a.route),
                decimals(s.angle_rad.to_degrees(), 1),
                mm(s.length_jump_m, 3),
                mm(s.arm_jump_m, 2),
            ]);
        }
    }
    table
}
