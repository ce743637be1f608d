//! `fits`: how well each equation meets the rows that it was fitted to.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::symbols;
use crate::table::{Audience, Cell, Column, Rounding, Table};

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build(vec![group]);
    table.id = format!("fits-{}", slug(group));
    table
}

fn build(groups: Vec<&GroupInput>) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::People),
        Column::number("n", "\\v{n}", ""),
        Column::number("p", "\\v{p}", ""),
        Column::number("adj_r2", "Adj. R^2", ""),
        Column::number("rmse", "RMSE", ""),
        Column::number("max_abs_error", "Max. error", ""),
        Column::text("unit", "Unit"),
        Column::text("loss", "Loss").seen_by(Audience::Machines),
        Column::text("status", "Fit"),
    ];
    let mut table = Table::new(
        "fits",
        "Goodness of the fits, on the rows that were fitted (RMSE over \\v{n} − \\v{p})",
        columns,
    );
    for group in groups {
        table.rule();
        for e in &group.fit.equations {
            let finite = |x: f64, rounding| Cell::number(x.is_finite().then_some(x), rounding);
            table.push(vec![
                Cell::text(&group.fit.group.campaign),
                Cell::Integer(i64::from(group.fit.group.diameter_mm)),
                Cell::text(&e.id),
                Cell::Symbol(symbols::equation(&e.id)),
                Cell::Integer(e.n as i64),
                Cell::Integer(e.p as i64),
                finite(e.adjusted_r2, Rounding::Decimals(4)),
                finite(e.rmse, Rounding::Digits(4)),
                finite(e.max_abs_error, Rounding::Digits(3)),
                Cell::text(&e.unit),
                Cell::text(&e.loss),
                Cell::text(&e.status),
            ]);
        }
    }
    table
}
