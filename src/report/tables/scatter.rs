//! `scatter`: what varies from group to group, one row a random effect.

use super::described::{Of, flag, interval, number, of_all, text};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::name;
use crate::wording::number::{cells, finite};
use pipeline_findings::Scatter;

type Row<'a> = Of<'a, &'a Scatter>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        text("id", "Random effect", |r: &Row| Cell::text(&r.one.id)),
        text("level", "Of each", |r| Cell::text(name::level(r.one.level))),
        number("groups", "\\v{n}", "", |r| {
            Cell::Integer(r.one.values.len() as i64)
        }),
        number("sd", "Standard deviation", "", |r| size(r.one)[0].clone()),
        interval("ci", "95%", |r| size(r.one)[1].clone()),
        text("unit", "Unit", |r| Cell::text(&r.one.unit)),
        number("declared", "Declared", "", |r| {
            finite(r.one.declared, Rounding::Digits(2))
        }),
        flag("declared_contradicted", "Contradicted", |r| {
            Cell::Flag(r.one.declared_contradicted)
        }),
        number("log_likelihood_gain", "Gain", "", |r| {
            finite(r.one.log_likelihood_gain, Rounding::Decimals(1))
        }),
    ];
    of_all(input, ("scatter", "What varies from group to group"), columns, |f| f.scatter.iter().collect()).note(
        "Standard deviations by restricted likelihood. \\v{Gain}: in log-likelihood, over a model without it; none where it was declared.",
    )
}

fn size(scatter: &Scatter) -> [Cell; 2] {
    cells(scatter.sd, scatter.ci_low, scatter.ci_high)
}
