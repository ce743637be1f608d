//! `budget`: what the expected squared error on an unseen specimen is made of.

use super::described::{Of, number, of_all, text};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::number::{error_rounding, finite};
use pipeline_findings::{BudgetEntry, CampaignFindings};

type Row<'a> = Of<'a, &'a BudgetEntry>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        text("source", "Source", |r: &Row| Cell::text(&r.one.source)),
        number("variance", "Variance", "", |r| {
            finite(r.one.variance, Rounding::Digits(3))
        }),
        number("share", "Share", "", |r| {
            finite(r.one.variance / total(r.found), Rounding::Percent(0))
        }),
        number("rmse", "Root", "", |r| {
            finite(r.one.rmse, error_rounding(r.one.rmse, &r.one.unit))
        }),
        text("unit", "Unit", |r| Cell::text(&r.one.unit)),
        number("expected_rmse_heldout", "Expected", "", |r| {
            let all = r.found.expected_rmse_heldout;
            let rounding = error_rounding(all.unwrap_or(f64::NAN), &r.found.unit);
            finite(all, rounding)
        }),
    ];
    let caption = "What the expected squared error on an unseen specimen is made of";
    of_all(input, ("budget", caption), columns, |f| {
        f.budget.iter().collect()
    })
    .note("Variances add up, their roots do not. \\v{Expected}: root of their sum.")
}

fn total(found: &CampaignFindings) -> f64 {
    found.budget.iter().map(|b| b.variance).sum()
}
