//! What is said first: the answer in sentences, the errors in their three forms, the budget.

use crate::findings::{CampaignFindings, Errors};
use crate::report::wording::name::{self, nouns};
use crate::report::wording::number::{NONE, error, error_or_none, error_with_unit, percent, unit};
use crate::report::wording::sentence::{self, clauses, has_effects};
use serde::Serialize;

/// The numbers of readings after which the error is shown.
const GIVEN: [&str; 4] = ["1", "2", "3", "5"];

/// The errors of one model of a campaign.
#[derive(Serialize)]
pub(super) struct ErrorRow {
    /// The campaign; empty in its second row.
    campaign: String,
    model: &'static str,
    /// Unseen, own values known, after 1, 2, 3 and 5 readings.
    cells: [String; 6],
}

/// The rows of a campaign: without effects, and with them where there are any.
pub(super) fn errors(found: &CampaignFindings) -> Vec<ErrorRow> {
    let row = |campaign: String, model, errors: &Errors| ErrorRow {
        campaign,
        model,
        cells: cells(errors, &found.unit),
    };
    let campaign = format!("{} ({})", name::campaign(found), unit(&found.unit));
    let mut rows = vec![row(campaign, "before", &found.before)];
    if has_effects(found) {
        rows.push(row(String::new(), "after", &found.after));
    }
    rows
}

fn cells(errors: &Errors, unit: &str) -> [String; 6] {
    let after = GIVEN.map(|k| errors.rmse_heldout_after.get(k).copied());
    let [one, two, three, five] = after;
    let all = [
        errors.rmse_heldout,
        errors.rmse_heldout_calibrated,
        one,
        two,
        three,
        five,
    ];
    all.map(|e| error_or_none(e, unit))
}

/// Whether any error but that on unseen units is known.
pub(super) fn has_forms(found: &CampaignFindings) -> bool {
    let known =
        |e: &Errors| e.rmse_heldout_calibrated.is_some() || !e.rmse_heldout_after.is_empty();
    known(&found.before) || known(&found.after)
}

/// The answer, a pointer to the detection limits apart.
#[derive(Serialize)]
pub(super) struct Said {
    opening: String,
    limits: bool,
    rest: Vec<String>,
}

pub(super) fn answer(found: &CampaignFindings) -> Said {
    let told = sentence::told(found);
    Said {
        opening: told.opening,
        limits: told.limits,
        rest: told.rest,
    }
}

/// A campaign without a section: name and answer.
pub(super) fn in_short(found: &CampaignFindings) -> [String; 2] {
    [
        name::campaign(found),
        name::capitalised(&clauses(found).found),
    ]
}

/// What was searched, and how errors were made.
pub(super) fn design(found: &CampaignFindings) -> String {
    let (d, nouns) = (&found.design, nouns(found));
    let base = if found.base_refitted {
        "coefficients fitted here"
    } else {
        "coefficients as published"
    };
    let outside = match d.readings_outside_domain {
        0 => String::new(),
        n => format!(
            "; {} outside the model's domain",
            counted(n, "reading lies", "readings lie")
        ),
    };
    let held = match d.readings_held_out {
        0 => String::new(),
        n => format!(
            "; {} held out by their owner",
            counted(n, "reading is", "readings are")
        ),
    };
    let doubtful = if d.doubtful_only {
        "; its owner doubts all of these, and they take part in no other fit"
    } else {
        ""
    };
    format!(
        "Searched: {} in {} of {}{outside}{held}{doubtful}. Base model: {}, {base}. Held out: {}.",
        counted(d.readings, "reading", "readings"),
        counted(d.sessions, nouns.setup, nouns.setups),
        counted(d.specimens, nouns.unit, nouns.units),
        found.base_model,
        name::held_out_by(found)
    )
}

fn counted(n: usize, one: &str, several: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { several })
}

/// Source, scatter behind it, root, share of the variance.
pub(super) fn budget(found: &CampaignFindings) -> Vec<[String; 4]> {
    let total: f64 = found.budget.iter().map(|b| b.variance).sum();
    let mut order: Vec<_> = found.budget.iter().collect();
    order.sort_by(|a, b| b.variance.total_cmp(&a.variance));
    let row = |b: &&crate::findings::BudgetEntry| {
        let scatter = sentence::scatter_behind(found, &b.source);
        [
            name::capitalised(&name::source(&b.source)),
            scatter.map_or_else(|| NONE.to_owned(), sentence::scatter_size),
            error(b.rmse, &found.unit),
            percent(b.variance / total.max(f64::MIN_POSITIVE)),
        ]
    };
    order.iter().map(row).collect()
}

/// The expected error on an unseen unit; empty where none was computed.
pub(super) fn expected(found: &CampaignFindings) -> String {
    let words = |e: f64| error_with_unit(e, &found.unit);
    found.expected_rmse_heldout.map_or_else(String::new, words)
}
