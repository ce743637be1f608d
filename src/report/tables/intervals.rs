//! `intervals`: the interval of every coefficient by every method, those of the LAR-compatible statistics and the published ones included.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::symbols;
use crate::table::{Audience, Cell, Column, Rounding, Table};
use pipeline_fit::engine::{CoefficientFit, EquationFit};

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build(vec![group]);
    table.id = format!("intervals-{}", slug(group));
    table
}

fn build(groups: Vec<&GroupInput>) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::People),
        Column::text("coefficient", "Coefficient").seen_by(Audience::Machines),
        Column::text("coefficient", "Coefficient").seen_by(Audience::People),
        Column::text("unit", "Unit"),
        Column::text("method", "Interval by"),
        Column::number("value", "Value", ""),
        Column::number("ci_low", "From", ""),
        Column::number("ci_high", "To", ""),
    ];
    let mut table = Table::new(
        "intervals",
        "95% intervals of every coefficient, by every method",
        columns,
    )
    .note(
        "The methods by specimen let readings of one specimen depend on each other; profile and linearised intervals, like the \
         LAR-compatible and the published ones, count every reading as independent and are too narrow. An empty end is open.",
    );
    for group in groups {
        for equation in &group.fit.equations {
            for (k, coefficient) in equation.coefficients.iter().enumerate() {
                table.rule();
                rows(&mut table, group, equation, k, coefficient);
            }
        }
    }
    table
}

fn rows(
    table: &mut Table,
    group: &GroupInput,
    equation: &EquationFit,
    k: usize,
    c: &CoefficientFit,
) {
    let mut first = true;
    let mut push = |method: &str, value: f64, low: Option<f64>, high: Option<f64>| {
        let rounding = match (low, high) {
            (Some(low), Some(high)) => Rounding::ByInterval { low, high },
            _ => Rounding::Digits(4),
        };
        let once = |cell: Cell| if first { cell } else { Cell::Empty };
        table.push(vec![
            Cell::text(&group.fit.group.campaign),
            Cell::Integer(i64::from(group.fit.group.diameter_mm)),
            Cell::text(&equation.id),
            once(Cell::Symbol(symbols::equation(&equation.id))),
            Cell::text(&c.symbol),
            once(Cell::Symbol(symbols::coefficient(&c.symbol))),
            Cell::text(&c.unit),
            Cell::text(method),
            Cell::number(value, rounding),
            Cell::number(low, rounding),
            Cell::number(high, rounding),
        ]);
        first = false;
    };
    for interval in &c.intervals {
        push(interval.method.name(), c.value, interval.low, interval.high);
    }
    if let Some(lar) = &equation.compatible {
        let ends = lar.intervals[k];
        push(
            "LAR-compatible",
            lar.coefficients[k],
            ends.map(|e| e.0),
            ends.map(|e| e.1),
        );
    }
    if let Some(published) = c.published {
        let ends = c.published_interval;
        push("published", published, ends.map(|e| e.0), ends.map(|e| e.1));
    }
}
