//! `scatter`, `budget`: what varies from group to group, and what the expected squared error on an unseen specimen is made of.

use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name;
use crate::wording::number::{cells, error_rounding};
use pipeline_findings::{BudgetEntry, CampaignFindings, Scatter};

/// One row a random effect.
#[rustfmt::skip]
pub fn scatter(input: &ReportInput) -> Table {
    let size = |s: &Scatter| cells(s.sd, s.ci_low, s.ci_high);
    Described::<(&CampaignFindings, &Scatter)>::found("scatter", "Random effects: scatter from group to group")
        .text("id", "Random effect", |(_, s)| &s.id)
        .text("level", "Of each", |(_, s)| name::level(s.level))
        .count("groups", "\\v{n}", One, |(_, s)| s.values.len())
        .value("sd", "Standard deviation", One, move |(_, s)| size(s))
        .interval("ci", "95%", One, move |(_, s)| size(s))
        .number("sd_predictive", "In predictions", One, Digits(2), |(_, s)| finite(s.sd_predictive))
        .text("unit", "Unit", |(_, s)| &s.unit)
        .number("declared", "Declared", One, Digits(2), |(_, s)| finite(s.declared))
        .flag("declared_contradicted", "Contradicted", |(_, s)| s.declared_contradicted)
        .number("log_likelihood_gain", "Gain", One, Decimals(1), |(_, s)| finite(s.log_likelihood_gain))
        .note("Standard deviations by restricted likelihood; in predictions, a handful of groups that happen to agree prove no scatter of 0. \\v{Gain}: in log-likelihood, over a model without it; none where it was declared.")
        .of_all(input, |found| found.scatter.iter().collect())
}

/// One row a source of error.
#[rustfmt::skip]
pub fn budget(input: &ReportInput) -> Table {
    Described::<(&CampaignFindings, &BudgetEntry)>::found("budget", "What the expected squared error on an unseen specimen is made of")
        .text("source", "Source", |(_, b)| &b.source)
        .number("variance", "Variance", One, Digits(3), |(_, b)| finite(b.variance))
        .number("share", "Share", One, Percent(0), |(found, b)| finite(b.variance / total(found)))
        .rounded("rmse", "Root", One, |(_, b)| (finite(b.rmse), error_rounding(b.rmse, &b.unit)))
        .text("unit", "Unit", |(_, b)| &b.unit)
        .error("expected_rmse_heldout", "Expected", |(found, _)| found.expected_rmse_heldout)
        .note("Variances add up, their roots do not. \\v{Expected}: root of their sum.")
        .of_all(input, |found| found.budget.iter().collect())
}

fn total(found: &CampaignFindings) -> f64 {
    found.budget.iter().map(|b| b.variance).sum()
}
