//! `comparison_by_length`: every model on each specimen, by resting length.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::table::{Audience, Cell, Column, Rounding, Table};
use crate::wording::name::model_name;

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build(vec![group]);
    table.id = format!("comparison_by_length-{}", slug(group));
    table
}

fn build(groups: Vec<&GroupInput>) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("model", "Model").seen_by(Audience::Machines),
        Column::text("title", "Model").seen_by(Audience::People),
        Column::text("split", "Split").seen_by(Audience::Machines),
        Column::text("specimen", "Specimen"),
        Column::number("rest_length_mm", "l_{rest}", "mm"),
        Column::number("n", "\\v{n}", ""),
        Column::number("rmse", "RMSE", "N"),
        Column::number("max_abs_error", "Max. error", "N"),
        Column::number("max_abs_error_pct", "Max. error", "% of F_{max}"),
        Column::number("bias", "Bias", "N"),
        Column::number("n_excluded", "Outside", ""),
        Column::number("n_extrapolated", "Extrap.", ""),
    ];
    let mut table = Table::new(
        "comparison_by_length",
        "Every model on each specimen",
        columns,
    )
    .note("The model that was fitted here predicts each specimen from the others, where there are others.");
    for group in groups {
        let mut model = None;
        for s in &group.comparison.by_specimen {
            let c = &s.comparison;
            let again = model == Some(&c.model);
            if !again {
                table.rule();
            }
            model = Some(&c.model);
            table.push(vec![
                Cell::text(&group.comparison.group.campaign),
                Cell::Integer(i64::from(group.comparison.group.diameter_mm)),
                Cell::text(&c.model),
                if again {
                    Cell::Empty
                } else {
                    Cell::text(model_name(&c.model, &c.title))
                },
                Cell::text(&c.split),
                Cell::text(&s.specimen),
                Cell::number(1e3 * s.rest_length_m, Rounding::Decimals(0)),
                Cell::Integer(c.n as i64),
                Cell::number(c.rmse, Rounding::Decimals(1)),
                Cell::number(c.max_abs_error, Rounding::Decimals(1)),
                Cell::number(c.max_abs_error_pct, Rounding::Decimals(1)),
                Cell::number(c.bias, Rounding::Decimals(1)),
                Cell::Integer(c.n_excluded as i64),
                Cell::Integer(c.n_extrapolated as i64),
            ]);
        }
    }
    table
}
