//! `coefficients`: what was fitted, with intervals, beside what was published.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::symbols;
use crate::table::{Audience, Cell, Column, Rounding, Table};
use crate::wording::name::coefficient_state;
use pipeline_compare::NEW;
use pipeline_fit::engine::{CoefficientFit, CoefficientState, EquationFit};

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build(vec![group]);
    table.id = format!("coefficients-{}", slug(group));
    table
}

fn build(groups: Vec<&GroupInput>) -> Table {
    let columns = vec![
        Column::text("model", "Model").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::People),
        Column::text("coefficient", "Coefficient").seen_by(Audience::Machines),
        Column::text("coefficient", "Coefficient").seen_by(Audience::People),
        Column::number("value", "Fitted", ""),
        Column::text("unit", "Unit"),
        Column::interval("ci", "95% CI", ""),
        Column::text("ci_method", "CI by").seen_by(Audience::Machines),
        Column::number("published", "Published", ""),
        Column::flag("inside_published_ci", "In publ. CI"),
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::text("state", "Remark"),
        Column::number("n", "\\v{n}", "").seen_by(Audience::Machines),
        Column::number("rmse", "RMSE", "").seen_by(Audience::Machines),
        Column::number("adj_r2", "Adj. R^2", "").seen_by(Audience::Machines),
        Column::number("max_abs_error", "Max. error", "").seen_by(Audience::Machines),
        Column::text("rmse_unit", "Unit of errors").seen_by(Audience::Machines),
        Column::text("loss", "Loss").seen_by(Audience::Machines),
    ];
    let mut table = Table::new("coefficients", "Coefficients of the new model", columns);
    for group in groups {
        for equation in &group.fit.equations {
            table.rule();
            for coefficient in &equation.coefficients {
                table.push(row(group, equation, coefficient));
            }
        }
    }
    table
}

fn row(group: &GroupInput, equation: &EquationFit, c: &CoefficientFit) -> Vec<Cell> {
    let [value, interval] = match (c.ci_low, c.ci_high) {
        (Some(low), Some(high)) => Cell::with_interval(c.value, low, high),
        _ => [Cell::number(c.value, Rounding::Digits(4)), Cell::Empty],
    };
    let method = if c.ci_low.is_some() {
        Cell::text(&equation.ci_method)
    } else {
        Cell::Empty
    };
    let inside = c.published_interval.map_or(Cell::Empty, |(low, high)| {
        Cell::Flag((low..=high).contains(&c.value))
    });
    let finite = |x: f64, rounding| Cell::number(x.is_finite().then_some(x), rounding);
    vec![
        Cell::text(NEW),
        Cell::Integer(i64::from(group.fit.group.diameter_mm)),
        Cell::text(&equation.id),
        Cell::Symbol(symbols::equation(&equation.id)),
        Cell::text(&c.symbol),
        Cell::Symbol(symbols::coefficient(&c.symbol)),
        value,
        Cell::text(&c.unit),
        interval,
        method,
        Cell::number(c.published, Rounding::Digits(4)),
        inside,
        Cell::text(&group.fit.group.campaign),
        if c.state == CoefficientState::Ok {
            Cell::Empty
        } else {
            Cell::text(coefficient_state(&c.state))
        },
        Cell::Integer(equation.n as i64),
        finite(equation.rmse, Rounding::Digits(4)),
        finite(equation.adjusted_r2, Rounding::Decimals(4)),
        finite(equation.max_abs_error, Rounding::Digits(4)),
        Cell::text(&equation.unit),
        Cell::text(&equation.loss),
    ]
}
