//! `statistics`: the honest statistics of every fit and, under their own name, those that a robust LAR fit prints.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::symbols;
use crate::table::{Audience, Cell, Column, Rounding, Table};
use pipeline_fit::engine::{Compatible, EquationFit, Goodness};

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build(vec![group]);
    table.id = format!("statistics-{}", slug(group));
    table
}

fn build(groups: Vec<&GroupInput>) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::People),
        Column::text("split", "Rows"),
        Column::number("n", "\\v{n}", ""),
        Column::number("adj_r2", "Adj. R^2", ""),
        Column::number("rmse", "RMSE", ""),
        Column::number("max_abs_error", "Max. error", ""),
        Column::number("lar_adj_r2", "Adj. R^2", ""),
        Column::number("lar_rmse", "RMSE", ""),
        Column::number("lar_max_abs_error", "Max. error", ""),
        Column::text("unit", "Unit"),
    ];
    let mut table = Table::new(
        "statistics",
        "Two sets of statistics: of the residuals themselves, and as a robust LAR fit prints them",
        columns,
    )
    .span("Honest", "adj_r2", "max_abs_error")
    .span("LAR-compatible", "lar_adj_r2", "lar_max_abs_error")
    .note(
        "The right-hand set stands beside the papers and is used nowhere else: its RMSE is a mixed scale, at least \\v{s} \\v{p}/√(\\v{p}^2 + \\v{n}) \
         of the ordinary fit's \\v{s}, and no root of mean squares. Validation rows are the fifth of each session's rows that the split by \
         row kept out of the fit.",
    );
    for group in groups {
        for equation in &group.fit.equations {
            table.rule();
            let all = Goodness {
                n: equation.n,
                rmse: finite(equation.rmse),
                adjusted_r2: finite(equation.adjusted_r2),
                max_abs_error: finite(equation.max_abs_error),
            };
            table.push(row(
                group,
                equation,
                "all, fitted",
                &all,
                equation.compatible.as_ref(),
            ));
            if let Some(split) = &equation.by_rows {
                let lar = split.compatible.as_ref();
                table.push(row(group, equation, "training", &split.train, lar));
                table.push(row(group, equation, "validation", &split.validation, None));
            }
        }
    }
    table
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn row(
    group: &GroupInput,
    equation: &EquationFit,
    split: &str,
    honest: &Goodness,
    lar: Option<&Compatible>,
) -> Vec<Cell> {
    let first = split == "all, fitted";
    vec![
        Cell::text(&group.fit.group.campaign),
        Cell::Integer(i64::from(group.fit.group.diameter_mm)),
        Cell::text(&equation.id),
        if first {
            Cell::Symbol(symbols::equation(&equation.id))
        } else {
            Cell::Empty
        },
        Cell::text(split),
        Cell::Integer(honest.n as i64),
        Cell::number(honest.adjusted_r2, Rounding::Decimals(4)),
        Cell::number(honest.rmse, Rounding::Digits(4)),
        Cell::number(honest.max_abs_error, Rounding::Digits(3)),
        Cell::number(lar.and_then(|l| l.adjusted_r2), Rounding::Decimals(4)),
        Cell::number(lar.map(|l| l.rmse), Rounding::Digits(4)),
        Cell::number(lar.map(|l| l.max_abs_error), Rounding::Digits(3)),
        Cell::text(&equation.unit),
    ]
}
