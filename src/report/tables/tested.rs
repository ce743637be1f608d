//! `tested`: the candidates of the first step of every search.

use super::described::{Of, flag, number, of_all, text};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::number::finite;
use pipeline_findings::{ActsOn, Tested};

type Row<'a> = Of<'a, &'a Tested>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        text("id", "Candidate", |r: &Row| Cell::text(&r.one.id)),
        flag("is_column", "Column", |r| Cell::Flag(r.one.is_column)),
        text("form", "Form", |r| Cell::text(&r.one.form)),
        text("acts_on", "Acts on", |r| {
            Cell::text(match r.one.acts_on {
                ActsOn::All => "all",
                ActsOn::Levels => "levels",
                ActsOn::From => "from",
            })
        }),
        number("log_likelihood_gain", "Gain", "", |r| {
            finite(r.one.log_likelihood_gain, Rounding::Decimals(1))
        }),
        number("amplitude", "Size", "", |r| {
            finite(r.one.amplitude, Rounding::Digits(2))
        }),
        text("unit", "Unit", |r| Cell::text(&r.one.unit)),
        number("p_familywise", "\\v{p}", "", |r| {
            finite(r.one.p_familywise, Rounding::Digits(2))
        }),
    ];
    of_all(input, ("tested", "The candidates of the first step of the search"), columns, |f| f.tested.iter().collect()).note(
        "\\v{Gain}: in log-likelihood. \\v{Size}: of the linearised effect. \\v{p}: probability of a candidate as strong as this anywhere.",
    )
}
