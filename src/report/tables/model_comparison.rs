//! `model_comparison`: every model on the same rows.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::table::{Audience, Cell, Column, Rounding, Table};
use crate::wording::name::model_name;
use pipeline_compare::Comparison;

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect(), |_| true)
}

/// One group, for people: a published model has seen none of the rows, so that one split says all of it.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build(vec![group], |c| {
        if c.fitted_here {
            c.split != "all"
        } else {
            c.split == "all"
        }
    });
    table.id = format!("model_comparison-{}", slug(group));
    table
}

fn build(groups: Vec<&GroupInput>, shown: fn(&Comparison) -> bool) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("model", "Model").seen_by(Audience::Machines),
        Column::text("title", "Model").seen_by(Audience::People),
        Column::flag("fitted_here", "Fitted").seen_by(Audience::Machines),
        Column::text("split", "Split"),
        Column::number("n", "\\v{n}", ""),
        Column::number("adj_r2", "Adj. R^2", ""),
        Column::number("rmse", "RMSE", "N"),
        Column::number("max_abs_error", "Max. error", "N"),
        Column::number("max_abs_error_pct", "Max. error", "% of F_{max}"),
        Column::number("bias", "Bias", "N"),
        Column::text("unit", "Unit").seen_by(Audience::Machines),
        Column::number("n_excluded", "Outside", ""),
        Column::number("n_extrapolated", "Extrap.", ""),
    ];
    let mut table = Table::new(
        "model_comparison",
        "Every model on the same readings",
        columns,
    )
    .note(
        "Errors and bias are measured minus predicted. \\v{Outside}: readings for which the model has no answer, not counted in its errors; \
         \\v{Extrap.}: readings beyond the model's own data, counted. Directions of filling and venting enter Hunt's model as \\v{S} = 0, the mean of both.",
    );
    for group in groups {
        let mut model = None;
        for c in group.comparison.comparisons.iter().filter(|c| shown(c)) {
            if model != Some(&c.model) {
                table.rule();
            }
            let title = if model == Some(&c.model) {
                Cell::Empty
            } else {
                Cell::text(model_name(&c.model, &c.title))
            };
            model = Some(&c.model);
            table.push(vec![
                Cell::text(&group.comparison.group.campaign),
                Cell::Integer(i64::from(group.comparison.group.diameter_mm)),
                Cell::text(&c.model),
                title,
                Cell::Flag(c.fitted_here),
                Cell::text(&c.split),
                Cell::Integer(c.n as i64),
                Cell::number(c.adj_r2, Rounding::Decimals(4)),
                Cell::number(c.rmse, Rounding::Decimals(2)),
                Cell::number(c.max_abs_error, Rounding::Decimals(1)),
                Cell::number(c.max_abs_error_pct, Rounding::Decimals(1)),
                Cell::number(c.bias, Rounding::Decimals(2)),
                Cell::text("N"),
                Cell::Integer(c.n_excluded as i64),
                Cell::Integer(c.n_extrapolated as i64),
            ]);
        }
    }
    table
}
