//! `detection_limits`: the smallest size of every effect that a campaign would have shown, and what it cannot show at all.

use crate::report::answers::finite;
use crate::report::input::ReportInput;
use crate::report::table::{Cell, Column, Rounding, Table};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::text("id", "Effect"),
        Column::text("form", "Form"),
        Column::number("smallest", "Smallest", ""),
        Column::text("unit", "Unit"),
        Column::number("visible", "Visible", ""),
        Column::text("not_measurable", "Not measurable, because"),
    ];
    let mut table = Table::new(
        "detection_limits",
        "The smallest size of every effect that a campaign would have shown",
        columns,
    )
    .note("\\v{Visible}: share of the effect's trace that a refit of the base model leaves.");
    for found in input.findings() {
        table.rule();
        let row = |id: &str, rest: [Cell; 5]| {
            let campaign = Cell::text(&found.campaign);
            let diameter = Cell::Integer(i64::from(found.diameter_mm));
            [campaign, diameter, Cell::text(id)]
                .into_iter()
                .chain(rest)
                .collect()
        };
        for limit in &found.detection_limits {
            let cells = [
                Cell::text(&limit.form),
                finite(limit.smallest, Rounding::Digits(2)),
                Cell::text(&limit.unit),
                finite(limit.visible, Rounding::Decimals(2)),
                Cell::Empty,
            ];
            table.push(row(&limit.id, cells));
        }
        for none in &found.not_measurable {
            let [a, b, c, d] = [const { Cell::Empty }; 4];
            table.push(row(&none.id, [a, b, c, d, Cell::text(&none.why)]));
        }
    }
    table
}
