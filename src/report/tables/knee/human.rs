//! `knee_human`: the human muscles beside OpenSim's exports and the design targets.

use super::decimals;
use crate::input::ReportInput;
use crate::table::{Cell, Column, Rounding, Table};
use pipeline_torque::reference::human::Compares;

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("muscle", "Muscle"),
        Column::text("quantity", "Quantity"),
        Column::text("against", "Beside"),
        Column::number("n", "\\v{n}", ""),
        Column::number("rms", "rms", ""),
        Column::number("max", "Largest", ""),
        Column::text("unit", ""),
        Column::number("at_deg", "at", "°"),
        Column::number("max_relative", "Largest", "%"),
        Column::text("why", "What is left"),
    ];
    let mut table = Table::new(
        "knee_human",
        "Human muscles: calculated moment arm and torque beside the references, over the whole range of the knee",
        columns,
    );
    for h in input.knee.iter().flat_map(|k| &k.reference.human) {
        let (factor, unit) = match h.what {
            Compares::Arm => (1e3, "mm"),
            Compares::Torque => (1.0, "N.m"),
        };
        table.push(vec![
            Cell::text(&h.muscle),
            Cell::text(h.what.name()),
            Cell::text(&h.against),
            Cell::Integer(h.rows.len() as i64),
            Cell::number(factor * h.rms, Rounding::Digits(2)),
            Cell::number(factor * h.max, Rounding::Digits(2)),
            Cell::text(unit),
            decimals(h.at_deg, 0),
            Cell::number(100.0 * h.max_relative, Rounding::Digits(2)),
            Cell::text(&h.why),
        ]);
    }
    table
}
