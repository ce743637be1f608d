//! The layout that Tables 1 and 2 of the force paper share: a block an equation, in it three sets of statistics, in each a row a
//! coefficient. The honest set comes first, the LAR-compatible and the published ones stand below it.

use crate::figures::slug;
use crate::input::GroupInput;
use crate::symbols;
use crate::table::{Audience, Cell, Column, Rounding, Table};
use crate::wording::name::coefficient_state;
use pipeline_audit::claims::{Kind, Split};
use pipeline_fit::engine::{CoefficientState, Compatible, EquationFit, Goodness};

/// Adjusted R2, RMSE and largest error of one half of the table.
#[derive(Clone, Copy, Debug, Default)]
pub struct Side {
    /// Adjusted R2.
    pub adjusted_r2: Option<f64>,
    /// RMSE.
    pub rmse: Option<f64>,
    /// Largest absolute error.
    pub max_abs_error: Option<f64>,
}

impl Side {
    /// The statistics of residuals.
    pub fn of(goodness: &Goodness) -> Self {
        Self {
            adjusted_r2: goodness.adjusted_r2,
            rmse: goodness.rmse,
            max_abs_error: goodness.max_abs_error,
        }
    }
}

/// One equation of one group.
pub struct Block<'a> {
    /// The group.
    pub group: &'a GroupInput,
    /// The fit.
    pub equation: &'a EquationFit,
    /// Its number in the force paper.
    pub number: &'a str,
    /// Left half, honest.
    pub model: Side,
    /// The LAR-compatible fit beside it.
    pub lar: Option<&'a Compatible>,
    /// Right half.
    pub compared: Option<Side>,
    /// What the paper prints in its right half.
    pub compared_as: Split,
    /// Largest errors are shares of F_620, in percent.
    pub percent: bool,
}

/// The statistics of a fit on all of its rows.
pub fn all_rows(equation: &EquationFit) -> Side {
    let finite = |x: f64| x.is_finite().then_some(x);
    Side {
        adjusted_r2: finite(equation.adjusted_r2),
        rmse: finite(equation.rmse),
        max_abs_error: finite(equation.max_abs_error),
    }
}

/// The columns; the last of each half is given.
pub fn columns(largest: &[Column; 2]) -> Vec<Column> {
    let [model, compared] = largest.clone();
    vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("equation", "Equation").seen_by(Audience::Machines),
        Column::text("number", "Equation").seen_by(Audience::People),
        Column::text("statistics", "Statistics").seen_by(Audience::Machines),
        Column::text("statistics", "Statistics").seen_by(Audience::People),
        Column::text("coefficient", "Coefficient").seen_by(Audience::Machines),
        Column::text("coefficient", "").seen_by(Audience::People),
        Column::number("value", "Value", ""),
        Column::text("unit", "Unit"),
        Column::interval("ci", "95% CI", ""),
        Column::number("adj_r2", "Adj. R^2", ""),
        Column::number("rmse", "RMSE", ""),
        model,
        Column::number("compared_adj_r2", "Adj. R^2", ""),
        Column::number("compared_rmse", "RMSE", ""),
        compared,
        Column::text("state", "Remark"),
    ]
}

/// The table of one group alone, under a name of its own.
pub fn of_group(mut table: Table, group: &GroupInput) -> Table {
    table.id = format!("{}-{}", table.id, slug(group));
    table
}

/// Adds the rows of one block.
pub fn push(table: &mut Table, block: &Block) {
    table.rule();
    let fit = block.equation;
    let honest = fit
        .coefficients
        .iter()
        .map(|c| (c.value, c.ci_low.zip(c.ci_high)))
        .collect();
    set(table, block, "honest", honest, block.model, block.compared);
    if let Some(lar) = block.lar {
        let values = lar.coefficients.iter().zip(&lar.intervals);
        let side = Side {
            adjusted_r2: lar.adjusted_r2,
            rmse: Some(lar.rmse),
            max_abs_error: Some(lar.max_abs_error),
        };
        let values = values.map(|(v, i)| (*v, *i)).collect();
        set(table, block, "LAR-compatible", values, side, None);
    }
    let published: Vec<_> = fit
        .coefficients
        .iter()
        .filter_map(|c| Some((c.published?, c.published_interval)))
        .collect();
    if published.len() == fit.coefficients.len() {
        let (model, compared) = (
            printed(block, Split::Model),
            printed(block, block.compared_as),
        );
        set(table, block, "published", published, model, Some(compared));
    }
}

/// What the force paper prints for the equation.
fn printed(block: &Block, split: Split) -> Side {
    let diameter = block.group.fit.group.diameter_mm;
    let of = |kind| {
        pipeline_audit::published(&block.equation.id, diameter, split, kind, None)
            .map(|claim| claim.printed.value)
    };
    let unit = if block.percent { 0.01 } else { 1.0 };
    Side {
        adjusted_r2: of(Kind::AdjR2),
        rmse: of(Kind::Rmse),
        max_abs_error: of(Kind::MaxError).map(|x| unit * x),
    }
}

type Estimate = (f64, Option<(f64, f64)>);

fn set(
    table: &mut Table,
    block: &Block,
    name: &str,
    estimates: Vec<Estimate>,
    model: Side,
    compared: Option<Side>,
) {
    let group = &block.group.fit.group;
    let coefficients = block.equation.coefficients.iter();
    for (k, (coefficient, (value, ends))) in coefficients.zip(estimates).enumerate() {
        let first = k == 0;
        let once = |cell: Cell| if first { cell } else { Cell::Empty };
        // What a paper printed keeps its digits.
        let as_printed = Rounding::Digits(4);
        let [value, interval] = match ends {
            Some((low, high)) if name == "published" => [
                Cell::number(value, as_printed),
                Cell::Interval {
                    low,
                    high,
                    rounding: as_printed,
                },
            ],
            Some((low, high)) => Cell::with_interval(value, low, high),
            None => [Cell::number(value, Rounding::Digits(4)), Cell::Empty],
        };
        let mut row = vec![
            Cell::text(&group.campaign),
            Cell::Integer(i64::from(group.diameter_mm)),
            Cell::text(&block.equation.id),
            if first && name == "honest" {
                Cell::text(block.number)
            } else {
                Cell::Empty
            },
            Cell::text(name),
            once(Cell::text(name)),
            Cell::text(&coefficient.symbol),
            Cell::Symbol(symbols::coefficient(&coefficient.symbol)),
            value,
            Cell::text(&coefficient.unit),
            interval,
        ];
        row.extend(side(Some(model), block.percent).map(once));
        row.extend(side(compared, block.percent).map(once));
        row.push(
            if name == "honest" && coefficient.state != CoefficientState::Ok {
                Cell::text(coefficient_state(&coefficient.state))
            } else {
                Cell::Empty
            },
        );
        table.push(row);
    }
}

fn side(side: Option<Side>, percent: bool) -> [Cell; 3] {
    let side = side.unwrap_or_default();
    let factor = if percent { 100.0 } else { 1.0 };
    [
        Cell::number(side.adjusted_r2, Rounding::Decimals(4)),
        Cell::number(side.rmse, Rounding::Digits(4)),
        Cell::number(side.max_abs_error.map(|x| factor * x), Rounding::Digits(3)),
    ]
}
