//! `table1`, `table2`: the force paper's tables. Both have a block an equation, in it three sets of statistics, in each a row a coefficient. The
//! honest set comes first, the LAR-compatible and the published ones stand below it.

use crate::described::*;
use crate::input::GroupInput;
use crate::wording::name::coefficient_state;
use pipeline_audit::claims::{Kind, Split};
use pipeline_fit::engine::{CoefficientFit, CoefficientState, Compatible, EquationFit, Goodness};
use pipeline_fit::equations::{FORCE_AT_REST, MAXIMUM_FORCE, SURFACE};

const HONEST: &str = "honest";
const PUBLISHED: &str = "published";

/// Maximum force. Eq. 7 is compared with the measured maxima at 620 kPa, Eqs. 5 and 6 with what the Festo tool says of the same maxima.
#[rustfmt::skip]
pub fn table1(groups: &[GroupInput]) -> Table {
    let blocks = groups.iter().flat_map(maximum_force);
    described("table1", "Maximum force: coefficients and goodness of fit", "Comparison", One)
        .note(
            "As in the force paper, the comparison of F_{max} is with the measured maxima at 620 kPa, and that of F_{620} is what the Festo \
             tool leaves of the same maxima. Honest: of the residuals, intervals as configured; LAR-compatible: as a robust fit prints them.",
        )
        .blocks(blocks.map(Block::rows))
}

/// Relative force: the surface F*(eps*, P*), on training and validation rows.
#[rustfmt::skip]
pub fn table2(groups: &[GroupInput]) -> Table {
    let blocks = groups.iter().filter_map(relative_force);
    described("table2", "Relative force: coefficients and goodness of fit", "Validation", PerCent)
        .note(
            "Model: the rows that the split by row trains on; validation: the others. Honest coefficients and intervals are those of all \
             rows, LAR-compatible ones those of the training rows. Rows of one log lie on both sides of this split: it says how well the \
             surface interpolates, not how well it predicts another actuator.",
        )
        .blocks(blocks.map(Block::rows))
}

fn maximum_force(group: &GroupInput) -> impl Iterator<Item = Block<'_>> {
    let maxima = group.comparison.maxima.as_ref();
    let at_rest = maxima.and_then(|m| m.force_at_rest);
    let festo = maxima.and_then(|m| m.festo_tool);
    let equations = [
        (FORCE_AT_REST, "paper Eq. 7", at_rest),
        (MAXIMUM_FORCE, "paper Eqs. 5, 6", festo),
    ];
    let block = move |(id, number, compared): (&str, _, Option<Goodness>)| {
        let equation = group.fit.equation(id)?;
        Some(Block {
            group,
            equation,
            number,
            model: all_rows(equation),
            lar: equation.compatible.as_ref(),
            compared: compared.map(|g| Side::of(&g)),
            compared_as: Split::Comparison,
            unit: One,
        })
    };
    equations.into_iter().filter_map(block)
}

fn relative_force(group: &GroupInput) -> Option<Block<'_>> {
    let equation = group.fit.equation(SURFACE)?;
    let split = equation.by_rows.as_ref();
    Some(Block {
        group,
        equation,
        number: "paper Eq. 8",
        model: split.map_or_else(|| all_rows(equation), |s| Side::of(&s.train)),
        lar: split.and_then(|s| s.compatible.as_ref()),
        compared: split.map(|s| Side::of(&s.validation)),
        compared_as: Split::Validation,
        unit: PerCent,
    })
}

/// Adjusted R2, RMSE and largest error of one half of the table.
#[derive(Clone, Copy, Default)]
struct Side {
    adjusted_r2: Option<f64>,
    rmse: Option<f64>,
    max_abs_error: Option<f64>,
}

impl Side {
    fn of(goodness: &Goodness) -> Self {
        Self {
            adjusted_r2: goodness.adjusted_r2,
            rmse: goodness.rmse,
            max_abs_error: goodness.max_abs_error,
        }
    }
}

fn all_rows(equation: &EquationFit) -> Side {
    Side {
        adjusted_r2: finite(equation.adjusted_r2),
        rmse: finite(equation.rmse),
        max_abs_error: finite(equation.max_abs_error),
    }
}

/// One equation of one group.
#[derive(Clone, Copy)]
struct Block<'a> {
    group: &'a GroupInput,
    equation: &'a EquationFit,
    /// Its number in the force paper.
    number: &'static str,
    /// Left half, honest.
    model: Side,
    /// The LAR-compatible fit beside it.
    lar: Option<&'a Compatible>,
    /// Right half.
    compared: Option<Side>,
    /// What the paper prints in its right half.
    compared_as: Split,
    /// Unit of the largest errors.
    unit: Unit,
}

/// One coefficient of one set of statistics.
#[derive(Clone, Copy)]
struct Row<'a> {
    block: Block<'a>,
    statistics: &'static str,
    coefficient: &'a CoefficientFit,
    value: f64,
    ends: Option<(f64, f64)>,
    /// Both halves; in the first row of the set.
    sides: Option<[Side; 2]>,
}

#[rustfmt::skip]
fn described<'a>(id: &str, caption: &str, compared: &str, unit: Unit) -> Described<'a, Row<'a>> {
    let side = |table: Described<'a, Row<'a>>, prefix: &str, of: usize| table
        .number(&format!("{prefix}adj_r2"), "Adj. R^2", One, Decimals(4), move |r| r.sides?[of].adjusted_r2)
        .number(&format!("{prefix}rmse"), "RMSE", One, Digits(4), move |r| r.sides?[of].rmse)
        .number(&format!("{prefix}max_abs_error"), "Max. error", unit, Digits(3), move |r| Some(factor(unit) * r.sides?[of].max_abs_error?));
    let table = Described::<Row>::new(id, caption)
        .group(|r| &r.block.group.fit.group)
        .text("equation", "Equation", |r| &r.block.equation.id).machines()
        .text("number", "Equation", |r| r.block.number).people().once()
        .text("statistics", "Statistics", |r| r.statistics).machines()
        .text("statistics", "Statistics", |r| r.sides.map(|_| r.statistics)).people()
        .coefficient("", |r| &r.coefficient.symbol)
        .value("value", "Value", One, estimate)
        .text("unit", "Unit", |r| &r.coefficient.unit)
        .interval("ci", "95% CI", One, estimate);
    let table = side(side(table, "", 0), "compared_", 1);
    table
        .text("state", "Remark", |r| (r.statistics == HONEST && r.coefficient.state != CoefficientState::Ok).then(|| coefficient_state(&r.coefficient.state)))
        .span("Model", "adj_r2", "max_abs_error")
        .span(compared, "compared_adj_r2", "compared_max_abs_error")
}

/// By what a share of F_620 is multiplied.
fn factor(unit: Unit) -> f64 {
    if unit == PerCent { 100.0 } else { 1.0 }
}

/// What a paper printed keeps its digits.
fn estimate(row: Row) -> [Cell; 2] {
    let rounding = Digits(4);
    match row.ends {
        Some((low, high)) if row.statistics == PUBLISHED => {
            let interval = Cell::Interval {
                low,
                high,
                rounding,
            };
            [Cell::number(row.value, rounding), interval]
        }
        Some((low, high)) => Cell::with_interval(row.value, low, high),
        None => [Cell::number(row.value, rounding), Cell::Empty],
    }
}

type Estimate = (f64, Option<(f64, f64)>);

impl<'a> Block<'a> {
    fn rows(self) -> Vec<Row<'a>> {
        let all = &self.equation.coefficients;
        let honest = all.iter().map(|c| (c.value, c.ci_low.zip(c.ci_high)));
        let sides = [self.model, self.compared.unwrap_or_default()];
        let mut rows = self.set(HONEST, honest.collect(), sides);
        if let Some(lar) = self.lar {
            let values = lar.coefficients.iter().copied();
            let side = Side {
                adjusted_r2: lar.adjusted_r2,
                rmse: Some(lar.rmse),
                max_abs_error: Some(lar.max_abs_error),
            };
            let values = values.zip(lar.intervals.iter().copied()).collect();
            rows.extend(self.set("LAR-compatible", values, [side, Side::default()]));
        }
        let published = all
            .iter()
            .map(|c| Some((c.published?, c.published_interval)));
        if let Some(published) = published.collect() {
            let sides = [Split::Model, self.compared_as].map(|split| self.printed(split));
            rows.extend(self.set(PUBLISHED, published, sides));
        }
        rows
    }

    fn set(self, statistics: &'static str, of: Vec<Estimate>, sides: [Side; 2]) -> Vec<Row<'a>> {
        let coefficients = self.equation.coefficients.iter().zip(of).enumerate();
        let row = |(k, (coefficient, (value, ends)))| Row {
            block: self,
            statistics,
            coefficient,
            value,
            ends,
            sides: (k == 0).then_some(sides),
        };
        coefficients.map(row).collect()
    }

    /// What the force paper prints for the equation.
    fn printed(self, split: Split) -> Side {
        let (id, diameter) = (&self.equation.id, self.group.fit.group.diameter_mm);
        let of = |kind| pipeline_audit::published(id, diameter, split, kind, None);
        let of = |kind| of(kind).map(|claim| claim.printed.value);
        let share = if self.unit == PerCent { 0.01 } else { 1.0 };
        Side {
            adjusted_r2: of(Kind::AdjR2),
            rmse: of(Kind::Rmse),
            max_abs_error: of(Kind::MaxError).map(|x| share * x),
        }
    }
}
