//! `residual_errors`: the error on every unit that was held out, before and after.

use crate::report::answers::finite;
use crate::report::input::ReportInput;
use crate::report::table::{Cell, Column, Rounding, Table};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::text("unit", "Held out"),
        Column::number("readings", "Readings", ""),
        Column::number("before", "Before", "N"),
        Column::number("after", "After", "N"),
        Column::number("black_box", "Black box", "N"),
        Column::text("chosen", "Chosen without it"),
    ];
    let mut table = Table::new(
        "residual_errors",
        "The error on what was held out: base model, with the effects that were chosen without it, and a black box",
        columns,
    )
    .note("Root-mean-square errors. The black box is a smooth regression of the base model's residual, fitted to the same readings.");
    for found in input.findings() {
        table.rule();
        for fold in &found.by_specimen {
            table.push(vec![
                Cell::text(&found.campaign),
                Cell::Integer(i64::from(found.diameter_mm)),
                Cell::text(&fold.unit),
                Cell::Integer(fold.readings as i64),
                finite(fold.before, Rounding::Decimals(2)),
                finite(fold.after, Rounding::Decimals(2)),
                finite(fold.black_box.unwrap_or(f64::NAN), Rounding::Decimals(2)),
                Cell::text(fold.chosen.join(", ")),
            ]);
        }
    }
    table
}
