//! `table1`, `table2`: the force paper's tables. Both have a block an equation, in it three sets of statistics: that of the residuals, that of a
//! robust fit as MATLAB prints it, and the published one. Data files have a row a coefficient in every set; in print a set is one row.

use crate::described::*;
use crate::input::GroupInput;
use crate::symbols;
use crate::wording::name::{coefficient_state, statistics};
use pipeline_audit::claims::{Kind, Split};
use pipeline_fit::engine::{CoefficientFit, CoefficientState, Compatible, EquationFit, Goodness};
use pipeline_fit::equations::{FORCE_AT_REST, MAXIMUM_FORCE, SURFACE};

const HONEST: &str = "honest";
const LAR: &str = "LAR-compatible";
const PUBLISHED: &str = "published";
/// Most coefficients of an equation of these tables.
const MOST_COEFFICIENTS: usize = 3;

const TITLE_1: &str = "Maximum force: coefficients and goodness of fit";
const TITLE_2: &str = "Relative force: coefficients and goodness of fit";
/// What the names of the sets mean.
const SETS: &str = "\\v{Residuals}: the fit of this report, with the RMSE and the largest error of its residuals. \\v{LAR print}: the same \
     equation by least absolute residuals, with the scale and the intervals that MATLAB prints for such a fit (readings taken as independent): \
     for comparison with the paper only. \\v{Published}: the force paper's.";
const COMPARED_1: &str = "As in the force paper, the comparison of F_{max} (its Eq. 7) is with the measured maxima at 620 kPa, and that of \
     F_{620} (its Eqs. 5, 6) is what the Festo tool leaves of the same maxima.";
const COMPARED_2: &str = "The force paper's Eq. 8. Model: the rows that the split by row trains on; validation: the others. Coefficients and \
     intervals are those of all rows, in the second line of the training rows. Rows of one log lie on both sides of this split: it \
     says how well the surface interpolates, not how well it predicts another actuator.";

/// Maximum force. Eq. 7 is compared with the measured maxima at 620 kPa, Eqs. 5 and 6 with what the Festo tool says of the same maxima.
pub fn table1(groups: &[GroupInput]) -> Table {
    let sets = groups.iter().flat_map(maximum_force).map(Block::sets);
    described("table1", TITLE_1, "Comparison", One).blocks(sets.map(rows))
}

/// The same for people.
pub fn table1_in_print(groups: &[GroupInput]) -> Table {
    let sets = groups.iter().flat_map(maximum_force).map(Block::sets);
    let coefficients = ["a_1 (N/kPa), b_1 (N)", "a_2 (1/(kPa m)), b_2 (1/m)"];
    printed(
        "table1",
        TITLE_1,
        "Comparison",
        One,
        &coefficients,
        sets.collect(),
    )
    .note(COMPARED_1)
    .note(SETS)
}

/// Relative force: the surface F*(eps*, P*), on training and validation rows.
pub fn table2(groups: &[GroupInput]) -> Table {
    let sets = groups.iter().filter_map(relative_force).map(Block::sets);
    described("table2", TITLE_2, "Validation", PerCent).blocks(sets.map(rows))
}

/// The same for people.
pub fn table2_in_print(groups: &[GroupInput]) -> Table {
    let sets = groups.iter().filter_map(relative_force).map(Block::sets);
    let coefficients = ["c_0", "c_1", "c_2"];
    printed(
        "table2",
        TITLE_2,
        "Validation",
        PerCent,
        &coefficients,
        sets.collect(),
    )
    .note(COMPARED_2)
}

fn maximum_force(group: &GroupInput) -> impl Iterator<Item = Block<'_>> {
    let maxima = group.comparison.maxima.as_ref();
    let at_rest = maxima.and_then(|m| m.force_at_rest);
    let festo = maxima.and_then(|m| m.festo_tool);
    let equations = [(FORCE_AT_REST, at_rest), (MAXIMUM_FORCE, festo)];
    let block = move |(id, compared): (&str, Option<Goodness>)| {
        let equation = group.fit.equation(id)?;
        Some(Block {
            group,
            equation,
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
    /// Left half, of the residuals.
    model: Side,
    /// The fit by least absolute residuals beside it.
    lar: Option<&'a Compatible>,
    /// Right half.
    compared: Option<Side>,
    /// What the paper prints in its right half.
    compared_as: Split,
    /// Unit of the largest errors.
    unit: Unit,
}

/// A value and the ends of its interval.
type Estimate = (f64, Option<(f64, f64)>);

/// One set of statistics of one equation.
#[derive(Clone, Copy)]
struct Set<'a> {
    block: Block<'a>,
    statistics: &'static str,
    /// Of the coefficients in their order.
    estimates: [Option<Estimate>; MOST_COEFFICIENTS],
    /// Both halves.
    sides: [Side; 2],
}

/// One coefficient of one set of statistics.
#[derive(Clone, Copy)]
struct Row<'a> {
    set: Set<'a>,
    coefficient: &'a CoefficientFit,
    estimate: Estimate,
    /// Both halves; in the first row of the set.
    sides: Option<[Side; 2]>,
}

/// A table with three columns of goodness on each side.
#[rustfmt::skip]
fn with_sides<'a, R: Copy + 'a>(
    table: Described<'a, R>,
    compared: &str,
    unit: Unit,
    sides: impl Fn(R) -> Option<[Side; 2]> + Copy + 'a,
) -> Described<'a, R> {
    let side = |table: Described<'a, R>, prefix: &str, of: usize| table
        .number(&format!("{prefix}adj_r2"), "Adj. R^2", One, Decimals(4), move |r| sides(r)?[of].adjusted_r2)
        .number(&format!("{prefix}rmse"), "RMSE", One, Digits(4), move |r| sides(r)?[of].rmse)
        .number(&format!("{prefix}max_abs_error"), "Max.", unit, Digits(3), move |r| Some(factor(unit) * sides(r)?[of].max_abs_error?));
    side(side(table, "", 0), "compared_", 1)
        .span("Model", "adj_r2", "max_abs_error")
        .span(compared, "compared_adj_r2", "compared_max_abs_error")
}

#[rustfmt::skip]
fn described<'a>(id: &str, caption: &str, compared: &str, unit: Unit) -> Described<'a, Row<'a>> {
    let table = Described::<Row>::new(id, caption)
        .group(|r| &r.set.block.group.fit.group)
        .text("equation", "Equation", |r| &r.set.block.equation.id)
        .text("statistics", "Statistics", |r| r.set.statistics)
        .coefficient("", |r| &r.coefficient.symbol)
        .value("value", "Value", One, |r| estimate(r.set.statistics, r.estimate))
        .text("unit", "Unit", |r| &r.coefficient.unit)
        .interval("ci", "95% CI", One, |r| estimate(r.set.statistics, r.estimate));
    with_sides(table, compared, unit, |r| r.sides)
        .text("state", "Remark", |r| (r.set.statistics == HONEST).then(|| remark(r.coefficient)).flatten())
}

/// One row a set; `coefficients` are the headings over their values and intervals.
#[rustfmt::skip]
fn printed<'a>(id: &str, caption: &str, compared: &str, unit: Unit, coefficients: &[&str], blocks: Vec<Vec<Set<'a>>>) -> Table {
    let mut table = Described::<Set>::new(id, caption)
        .group(|s| &s.block.group.fit.group)
        .symbol("equation", "", |s| law(&s.block.equation.id).to_owned()).once()
        .text("statistics", "Statistics", |s| statistics(s.statistics));
    for (k, heading) in coefficients.iter().enumerate() {
        let cells = move |s: Set| s.estimates[k].map_or([Cell::Empty, Cell::Empty], |e| estimate(s.statistics, e));
        let (value, interval) = (format!("value_{k}"), format!("ci_{k}"));
        table = table
            .value(&value, "Value", One, cells)
            .interval(&interval, "95% CI", One, cells)
            .span(heading, &value, &interval);
    }
    let remarks = remarks(&blocks);
    let table = with_sides(table, compared, unit, |s| Some(s.sides)).blocks(blocks);
    remarks.iter().fold(table, |table, remark| table.note(remark))
}

/// What became of coefficients that are not as they should be, equation by equation; with the campaign where there are several.
fn remarks(blocks: &[Vec<Set>]) -> Vec<String> {
    let sets = || blocks.iter().filter_map(|sets| sets.first());
    let campaign = |s: &Set| s.block.group.fit.group.campaign.replace('_', "\\_");
    let several = sets().any(|s| Some(campaign(s)) != sets().next().map(campaign));
    let of_equation = |s: &Set| {
        let all = s.block.equation.coefficients.iter();
        let remarks = all.filter_map(|c| {
            let remark = remark(c)?.replace('_', "\\_");
            Some(format!("{} {remark}", symbols::coefficient(&c.symbol)))
        });
        let remarks: Vec<String> = remarks.collect();
        let whose = if several {
            format!("{}, ", campaign(s))
        } else {
            String::new()
        };
        let equation = symbols::equation(&s.block.equation.id);
        (!remarks.is_empty()).then(|| format!("{whose}{equation}: {}.", remarks.join("; ")))
    };
    sets().filter_map(of_equation).collect()
}

/// What an equation gives.
fn law(equation: &str) -> &'static str {
    match equation {
        FORCE_AT_REST => "F_{max}",
        MAXIMUM_FORCE => "F_{620}",
        _ => "\\v{F}*",
    }
}

/// What became of a coefficient that is not as it should be.
fn remark(coefficient: &CoefficientFit) -> Option<String> {
    (coefficient.state != CoefficientState::Ok).then(|| coefficient_state(&coefficient.state))
}

/// By what a share of F_620 is multiplied.
fn factor(unit: Unit) -> f64 {
    if unit == PerCent { 100.0 } else { 1.0 }
}

/// What a paper printed keeps its digits.
fn estimate(statistics: &str, (value, ends): Estimate) -> [Cell; 2] {
    let rounding = Digits(4);
    match ends {
        Some((low, high)) if statistics == PUBLISHED => {
            let interval = Cell::Interval {
                low,
                high,
                rounding,
            };
            [Cell::number(value, rounding), interval]
        }
        Some((low, high)) => Cell::with_interval(value, low, high),
        None => [Cell::number(value, rounding), Cell::Empty],
    }
}

/// One row a coefficient of every set.
fn rows(sets: Vec<Set>) -> Vec<Row> {
    sets.into_iter().flat_map(Set::rows).collect()
}

impl<'a> Set<'a> {
    fn rows(self) -> impl Iterator<Item = Row<'a>> {
        let coefficients = self.block.equation.coefficients.iter().zip(self.estimates);
        coefficients
            .enumerate()
            .filter_map(move |(k, (coefficient, estimate))| {
                Some(Row {
                    set: self,
                    coefficient,
                    estimate: estimate?,
                    sides: (k == 0).then_some(self.sides),
                })
            })
    }
}

impl<'a> Block<'a> {
    fn sets(self) -> Vec<Set<'a>> {
        let all = &self.equation.coefficients;
        let honest = all.iter().map(|c| (c.value, c.ci_low.zip(c.ci_high)));
        let sides = [self.model, self.compared.unwrap_or_default()];
        let mut sets = vec![self.set(HONEST, honest, sides)];
        if let Some(lar) = self.lar {
            let values = lar.coefficients.iter().copied();
            let side = Side {
                adjusted_r2: lar.adjusted_r2,
                rmse: Some(lar.rmse),
                max_abs_error: Some(lar.max_abs_error),
            };
            let values = values.zip(lar.intervals.iter().copied());
            sets.push(self.set(LAR, values, [side, Side::default()]));
        }
        let published = all
            .iter()
            .map(|c| Some((c.published?, c.published_interval)));
        if let Some(published) = published.collect::<Option<Vec<Estimate>>>() {
            let sides = [Split::Model, self.compared_as].map(|split| self.printed(split));
            sets.push(self.set(PUBLISHED, published, sides));
        }
        sets
    }

    fn set(
        self,
        statistics: &'static str,
        of: impl IntoIterator<Item = Estimate>,
        sides: [Side; 2],
    ) -> Set<'a> {
        let mut estimates = [None; MOST_COEFFICIENTS];
        for (place, estimate) in estimates.iter_mut().zip(of) {
            *place = Some(estimate);
        }
        Set {
            block: self,
            statistics,
            estimates,
            sides,
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::tests::groups;

    /// Every value with its interval, of columns of these names.
    fn estimates(table: &Table, values: &[&str], intervals: &[&str]) -> Vec<String> {
        let place = |key: &&str| table.columns.iter().position(|c| c.key == *key).unwrap();
        let pairs: Vec<(usize, usize)> = values
            .iter()
            .map(place)
            .zip(intervals.iter().map(place))
            .collect();
        let of_row = |row: &Vec<Cell>| {
            let cells = pairs
                .iter()
                .map(|(v, i)| (row[*v].clone(), row[*i].clone()));
            let filled = cells.filter(|(value, _)| *value != Cell::Empty);
            filled.map(|pair| format!("{pair:?}")).collect::<Vec<_>>()
        };
        table.rows.iter().flat_map(of_row).collect()
    }

    #[test]
    fn what_is_printed_is_what_data_files_hold() {
        let groups = groups();
        let (values, intervals) = (["value_0", "value_1", "value_2"], ["ci_0", "ci_1", "ci_2"]);
        let both = [
            (table1(&groups), table1_in_print(&groups), 2),
            (table2(&groups), table2_in_print(&groups), 3),
        ];
        for (data, print, coefficients) in both {
            let in_data = estimates(&data, &["value"], &["ci"]);
            let in_print = estimates(&print, &values[..coefficients], &intervals[..coefficients]);
            assert!(
                in_data.len() > 10 && in_data == in_print,
                "{in_data:?} {in_print:?}"
            );
            assert_eq!(data.rows.len(), in_data.len());
            assert!(2 * print.rows.len() <= data.rows.len());
        }
    }
}
