//! `coefficients`, `intervals`: what was fitted beside what was published, and the interval of every coefficient by every method.

use crate::described::*;
use crate::input::GroupInput;
use crate::symbols;
use crate::wording::name::{coefficient_state, statistics};
use pipeline_compare::NEW;
use pipeline_config::IntervalMethod;
use pipeline_fit::engine::{CoefficientFit, CoefficientState, EquationFit};

type Row<'a> = (&'a GroupInput, &'a EquationFit, &'a CoefficientFit);

/// One row a coefficient.
#[rustfmt::skip]
pub fn coefficients(groups: &[GroupInput]) -> Table {
    Described::<Row>::new("coefficients", "Coefficients of the new model")
        .text("model", "Model", |_| NEW).machines()
        .count("diameter_mm", "⌀", Mm, |(g, ..)| g.fit.group.diameter_mm).machines()
        .equation(|(_, e, _)| &e.id)
        .coefficient("Coefficient", |(.., c)| &c.symbol)
        .value("value", "Fitted", One, estimate)
        .text("unit", "Unit", |(.., c)| &c.unit)
        .interval("ci", "95% CI", One, estimate)
        .text("ci_method", "CI by", |(_, e, c)| c.ci_low.map(|_| &e.ci_method)).machines()
        .number("published", "Published", One, Digits(4), |(.., c)| c.published)
        .flag("inside_published_ci", "In publ. CI", |(.., c)| c.published_interval.map(|(low, high)| (low..=high).contains(&c.value)))
        .text("campaign", "Campaign", |(g, ..)| &g.fit.group.campaign).machines()
        .text("state", "Remark", |(.., c)| (c.state != CoefficientState::Ok).then(|| coefficient_state(&c.state)))
        .count("n", "\\v{n}", One, |(_, e, _)| e.n).machines()
        .number("rmse", "RMSE", One, Digits(4), |(_, e, _)| finite(e.rmse)).machines()
        .number("adj_r2", "Adj. R^2", One, Decimals(4), |(_, e, _)| finite(e.adjusted_r2)).machines()
        .number("max_abs_error", "Max. error", One, Digits(4), |(_, e, _)| finite(e.max_abs_error)).machines()
        .text("rmse_unit", "Unit of errors", |(_, e, _)| &e.unit).machines()
        .text("loss", "Loss", |(_, e, _)| &e.loss).machines()
        .blocks(equations(groups).map(|(g, e)| e.coefficients.iter().map(move |c| (g, e, c))))
}

fn equations(groups: &[GroupInput]) -> impl Iterator<Item = (&GroupInput, &EquationFit)> {
    let all = groups.iter();
    all.flat_map(|g| g.fit.equations.iter().map(move |e| (g, e)))
}

fn estimate((.., c): Row) -> [Cell; 2] {
    match (c.ci_low, c.ci_high) {
        (Some(low), Some(high)) => Cell::with_interval(c.value, low, high),
        _ => [Cell::number(c.value, Digits(4)), Cell::Empty],
    }
}

/// The interval of a coefficient by one method.
#[derive(Clone, Copy)]
struct By<'a> {
    row: Row<'a>,
    method: &'static str,
    value: f64,
    low: Option<f64>,
    high: Option<f64>,
    rounding: Rounding,
}

/// One row a method: those of the fit, of the LAR-compatible statistics and of the papers.
#[rustfmt::skip]
pub fn intervals(groups: &[GroupInput]) -> Table {
    Described::<By>::new("intervals", "95% intervals of every coefficient, by every method")
        .group(|r| &r.row.0.fit.group)
        .equation(|r| &r.row.1.id).once()
        .coefficient("Coefficient", |r| &r.row.2.symbol).once()
        .text("unit", "Unit", |r| &r.row.2.unit)
        .text("method", "Interval by", |r| r.method).machines()
        .text("method", "Interval by", |r| statistics(r.method)).people()
        .rounded("value", "Value", One, |r| (r.value, r.rounding))
        .rounded("ci_low", "From", One, |r| (r.low, r.rounding))
        .rounded("ci_high", "To", One, |r| (r.high, r.rounding))
        .note(
            "The methods by specimen let readings of one specimen depend on each other; profile and linearised intervals, like those \
             that MATLAB prints for least absolute residuals (LAR) and the published ones, count every reading as independent and are too \
             narrow. Where an end is empty, the interval is unbounded on that side.",
        )
        .blocks(equations(groups).flat_map(|(g, e)| (0..e.coefficients.len()).map(move |k| by_every_method(g, e, k))))
}

/// Methods of intervals in the order of the printed table, with their headings.
const METHODS: [(IntervalMethod, &str); 4] = [
    (IntervalMethod::Jackknife, "Jackknife"),
    (IntervalMethod::Bootstrap, "Bootstrap"),
    (IntervalMethod::Profile, "Profile"),
    (IntervalMethod::Linearised, "Linearised"),
];

/// The same for people: one row a coefficient, the methods beside each other.
#[rustfmt::skip]
pub fn intervals_in_print(groups: &[GroupInput]) -> Table {
    let place = |(_, e, c): &Row| e.coefficients.iter().position(|o| o.symbol == c.symbol);
    let lar = move |row: Row| {
        let lar = row.1.compatible.as_ref().zip(place(&row));
        lar.map_or([Cell::Empty, Cell::Empty], |(l, k)| cells(l.coefficients[k], l.intervals[k]))
    };
    let published = |(.., c): Row| c.published.map_or([Cell::Empty, Cell::Empty], |value| cells(value, c.published_interval));
    let mut table = Described::<Row>::new("intervals", "95% intervals of every coefficient, by every method")
        .group(|(g, ..)| &g.fit.group)
        .symbol("equation", "Equation", |(_, e, _)| symbols::equation(&e.id)).once()
        .symbol("coefficient", "", |(.., c)| symbols::coefficient(&c.symbol))
        .value("value", "Fitted", One, estimate);
    for (method, heading) in METHODS {
        table = table.interval(method.name(), heading, One, move |(.., c)| {
            let own = c.intervals.iter().find(|i| i.method == method);
            [Cell::Empty, own.map_or(Cell::Empty, |i| ends(c.value, (i.low, i.high)))]
        });
    }
    table
        .value("lar", "Value", One, lar)
        .interval("lar_ci", "Interval", One, lar)
        .value("published", "Value", One, published)
        .interval("published_ci", "Interval", One, published)
        .span("By specimen", METHODS[0].0.name(), METHODS[1].0.name())
        .span("By reading", METHODS[2].0.name(), METHODS[3].0.name())
        .span("LAR print", "lar", "lar_ci")
        .span("Published", "published", "published_ci")
        .note(
            "Units as in the table of the coefficients. The methods by specimen let readings of one specimen depend on each other; those by \
             reading, like those that MATLAB prints for least absolute residuals (LAR) and the published ones, count every reading as \
             independent and are too narrow.",
        )
        .blocks(equations(groups).map(|(g, e)| e.coefficients.iter().map(move |c| (g, e, c))))
}

fn cells(value: f64, interval: Option<(f64, f64)>) -> [Cell; 2] {
    match interval {
        Some((low, high)) => Cell::with_interval(value, low, high),
        None => [Cell::number(value, Digits(4)), Cell::Empty],
    }
}

/// An interval, of which an end may be open.
fn ends(value: f64, interval: (Option<f64>, Option<f64>)) -> Cell {
    let bound = |word: &str, x| {
        Digits(3)
            .round(x)
            .map(|n| format!("{word} {}", n.typeset()))
    };
    match interval {
        (Some(low), Some(high)) => {
            let [_, interval] = Cell::with_interval(value, low, high);
            interval
        }
        (Some(low), None) => bound("above", low).map_or(Cell::Empty, Cell::Text),
        (None, Some(high)) => bound("below", high).map_or(Cell::Empty, Cell::Text),
        (None, None) => Cell::text("open"),
    }
}

fn by_every_method<'a>(group: &'a GroupInput, equation: &'a EquationFit, k: usize) -> Vec<By<'a>> {
    let c = &equation.coefficients[k];
    let by = |method, value, [low, high]: [Option<f64>; 2]| By {
        row: (group, equation, c),
        method,
        value,
        low,
        high,
        rounding: match (low, high) {
            (Some(low), Some(high)) => Rounding::ByInterval { low, high },
            _ => Digits(4),
        },
    };
    let both = |ends: Option<(f64, f64)>| [ends.map(|e| e.0), ends.map(|e| e.1)];
    let own = c.intervals.iter();
    let mut rows: Vec<By> = own
        .map(|i| by(i.method.name(), c.value, [i.low, i.high]))
        .collect();
    if let Some(lar) = &equation.compatible {
        let (value, ends) = (lar.coefficients[k], lar.intervals[k]);
        rows.push(by("LAR-compatible", value, both(ends)));
    }
    if let Some(published) = c.published {
        rows.push(by("published", published, both(c.published_interval)));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::tests::groups;

    #[test]
    fn every_interval_of_a_data_file_is_printed() {
        let groups = groups();
        let (data, print) = (intervals(&groups), intervals_in_print(&groups));
        let count = |table: &Table, keys: &[&str]| {
            let of = |k: &usize| keys.contains(&table.columns[*k].key.as_str());
            let places: Vec<usize> = (0..table.columns.len()).filter(of).collect();
            let cells = table
                .rows
                .iter()
                .flat_map(|row| places.iter().map(|k| &row[*k]));
            cells.filter(|cell| **cell != Cell::Empty).count()
        };
        let methods = METHODS.map(|(method, _)| method.name());
        let printed = count(&print, &methods) + count(&print, &["lar", "published"]);
        assert_eq!(printed, data.rows.len());
        assert!(4 * print.rows.len() <= data.rows.len());
    }

    #[test]
    fn open_ends_are_said() {
        assert_eq!(ends(1.0, (Some(0.5), None)), Cell::text("above 0.500"));
        assert_eq!(ends(1.0, (None, Some(2.0))), Cell::text("below 2.00"));
        assert_eq!(ends(1.0, (None, None)), Cell::text("open"));
    }
}
