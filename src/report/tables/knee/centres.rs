//! `knee_centres`: the instantaneous centre of the biomimetic knee from its table, from the linkage, and from the motion.

use super::{decimals, mm};
use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("other", "Beside the tabulated centre"),
        Column::number("n", "Angles", ""),
        Column::number("rms_mm", "rms", "mm"),
        Column::number("max_mm", "Largest", "mm"),
        Column::number("at_deg", "at", "°"),
    ];
    let mut table = Table::new(
        "knee_centres",
        "The instantaneous centre of the biomimetic knee: distance from the tabulated one",
        columns,
    );
    for c in input.knee.iter().flat_map(|k| &k.reference.centres) {
        table.push(vec![
            Cell::text(&c.other),
            Cell::Integer(c.n as i64),
            mm(c.rms_m, 3),
            mm(c.max_m, 3),
            decimals(c.at_deg, 0),
        ]);
    }
    table
}
