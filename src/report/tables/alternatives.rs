//! `alternatives`: the law with and without its parts, one row a number of an alternative.

use super::described::{Of, interval, number, of_all, text, unit};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::number::{cells, error_rounding, finite};
use pipeline_findings::{Alternative, CampaignFindings, Parameter};

/// What stands for an alternative without parts.
const NO_PART: &str = "none";

type Row<'a> = Of<'a, (&'a Alternative, Option<&'a Parameter>)>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        text("parts", "With", |r: &Row| Cell::text(parts(r.one.0))),
        number("parameters", "Parameters", "", |r| {
            Cell::Integer(r.one.0.parameters as i64)
        }),
        number("log_likelihood", "Log-likelihood", "", |r| {
            finite(r.one.0.log_likelihood, Rounding::Decimals(1))
        }),
        number("rmse_heldout", "Held out", "", |r| {
            let error = r.one.0.rmse_heldout.unwrap_or(f64::NAN);
            finite(error, error_rounding(error, &r.found.unit))
        }),
        unit(),
        number("log_density_heldout", "Log density", "", |r| {
            finite(r.one.0.log_density_heldout, Rounding::Decimals(3))
        }),
        text("number", "Number", |r| {
            r.one.1.map_or(Cell::Empty, |p| Cell::text(&p.name))
        }),
        number("value", "Value", "", |r| {
            r.one.1.map_or(Cell::Empty, |p| size(p)[0].clone())
        }),
        interval("ci", "95%", |r| {
            r.one.1.map_or(Cell::Empty, |p| size(p)[1].clone())
        }),
        text("number_unit", "Unit", |r| {
            r.one.1.map_or(Cell::Empty, |p| Cell::text(&p.unit))
        }),
    ];
    let caption = "The law with and without its parts";
    of_all(input, ("alternatives", caption), columns, rows)
        .note("\\v{Log-likelihood}: less that of the first. \\v{Held out}: each alternative as it stands, without a search. \\v{Log density}: a held-out reading.")
}

fn rows(found: &CampaignFindings) -> Vec<(&Alternative, Option<&Parameter>)> {
    let mut rows = Vec::new();
    for alternative in &found.alternatives {
        if alternative.numbers.is_empty() {
            rows.push((alternative, None));
        }
        rows.extend(alternative.numbers.iter().map(|p| (alternative, Some(p))));
    }
    rows
}

fn parts(alternative: &Alternative) -> String {
    if alternative.parts.is_empty() {
        return NO_PART.to_owned();
    }
    alternative.parts.join(" ")
}

fn size(p: &Parameter) -> [Cell; 2] {
    cells(p.value, p.ci_low, p.ci_high)
}
