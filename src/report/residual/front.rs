//! What is said first: the answer in sentences, the errors in their three forms, the budget.

use super::Simpler;
use crate::number::Rounding;
use crate::wording::CLEARLY_LOWER;
use crate::wording::name::{self, nouns};
use crate::wording::number::{
    NONE, error, error_or_none, error_with_unit, percent, probability, rounded, unit,
};
use crate::wording::sentence::{self, Answer, clauses, counted, has_terms};
use pipeline_findings::{CampaignFindings, Errors, Verdict};
use pipeline_mechanics::models;
use serde::Serialize;
use std::collections::BTreeMap;

/// The numbers of readings after which the error is shown.
const GIVEN: [&str; 4] = ["1", "2", "3", "5"];

/// The names of those of which nothing could be said, by the reason.
pub(super) fn not_assessed<'a>(
    all: impl Iterator<Item = &'a CampaignFindings>,
) -> BTreeMap<String, Vec<String>> {
    let mut by_reason: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for found in all.filter(|found| found.verdict == Verdict::NotAssessed) {
        let names = by_reason.entry(clauses(found).found).or_default();
        names.push(name::campaign(found));
    }
    by_reason
}

/// The errors of one model of a campaign on held-out units, by what is known of these.
#[derive(Serialize)]
pub(super) struct ErrorRow {
    /// The campaign; empty in its further rows.
    campaign: String,
    effects: &'static str,
    /// Nothing known; after 1, 2, 3 and 5 readings; its own gain and lengths known.
    cells: [String; 6],
}

/// The rows of a campaign: without effects, and with them where there are any, the last also with its readings in time order; none where nothing was
/// held out.
pub(super) fn errors(found: &CampaignFindings) -> Vec<ErrorRow> {
    if found.before.rmse_heldout.is_none() {
        return Vec::new();
    }
    let words = |e: Option<f64>| error_or_none(e, &found.unit);
    let cells = |e: &Errors| {
        let [one, two, three, five] = GIVEN.map(|k| words(e.rmse_heldout_spread.get(k).copied()));
        let (unseen, known) = (words(e.rmse_heldout), words(e.rmse_heldout_calibrated));
        [unseen, one, two, three, five, known]
    };
    let in_time_order = |e: &Errors| {
        let [one, two, three, five] = GIVEN.map(|k| words(e.rmse_heldout_after.get(k).copied()));
        [String::new(), one, two, three, five, String::new()]
    };
    let row = |campaign, effects, cells| ErrorRow {
        campaign,
        effects,
        cells,
    };
    let name = format!("{} ({})", name::campaign(found), unit(&found.unit));
    let before = row(name, "without", cells(&found.before));
    let after = has_terms(found).then(|| row(String::new(), "with", cells(&found.after)));
    let (effects, last) = match after {
        Some(_) => ("with, in time order", &found.after),
        None => ("without, in time order", &found.before),
    };
    let last = row(String::new(), effects, in_time_order(last));
    [before].into_iter().chain(after).chain([last]).collect()
}

/// The answer, a pointer to the detection limits apart.
#[derive(Serialize)]
pub(super) struct Said {
    opening: String,
    limits: bool,
    rest: Vec<String>,
}

impl From<Answer> for Said {
    fn from(answer: Answer) -> Self {
        Said {
            opening: answer.opening,
            limits: answer.limits,
            rest: answer.rest,
        }
    }
}

/// For a section.
pub(super) fn answer(found: &CampaignFindings) -> Said {
    sentence::full_answer(found).into()
}

/// For the first page.
#[derive(Serialize)]
pub(super) struct Brief {
    found: String,
    limits: bool,
    rest: Vec<(&'static str, String)>,
}

/// The points, and beside the errors something simpler that does better.
pub(super) fn in_brief(found: &CampaignFindings, simpler: Option<Simpler>) -> Brief {
    let points = sentence::points(found);
    let own = found.rmse_of_answer();
    let better = simpler.filter(|s| own.is_some_and(|own| s.error < CLEARLY_LOWER * own));
    let beside = |(about, words): (&'static str, String)| match better {
        Some(s) if about == sentence::ERROR => {
            let error = error_with_unit(s.error, &found.unit);
            (about, format!("{words}; {} {error}", s.words))
        }
        _ => (about, words),
    };
    Brief {
        found: points.found,
        limits: points.limits,
        rest: points.rest.into_iter().map(beside).collect(),
    }
}

/// What the words for the strength of the evidence mean, where they are said of any effect; else empty.
pub(super) fn evidence<'a>(mut all: impl Iterator<Item = &'a CampaignFindings>) -> String {
    if all.any(|found| !found.effects.is_empty()) {
        sentence::grades()
    } else {
        String::new()
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
    let law = base_model(&found.base_model);
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
            "; {} designated as holdout",
            counted(n, "reading is", "readings are")
        ),
    };
    let doubtful = if d.doubtful_only {
        "; all of these are marked as doubtful and are used in no other fit"
    } else {
        ""
    };
    format!(
        "Searched: {} in {} of {}{outside}{held}{doubtful}. Base model: {law}, {base}. Held out: {}.{}",
        counted(d.readings, "reading", "readings"),
        counted(d.sessions, nouns.setup, nouns.setups),
        counted(d.specimens, nouns.unit, nouns.units),
        name::held_out_by(found),
        smallest_p(found)
    )
}

/// How sure the draws and this number of units can make anyone, in a sentence; empty where nothing was searched.
fn smallest_p(found: &CampaignFindings) -> String {
    let (d, nouns) = (&found.design, nouns(found));
    if found.verdict == Verdict::NotAssessed {
        return String::new();
    }
    let signs = d.smallest_p.signs.map_or_else(String::new, |p| {
        // A power of two is said as it is, down to where nobody reads the digits.
        let p = if p < 1e-4 {
            probability(p)
        } else {
            format!("= {}", rounded(p, Rounding::Digits(3)))
        };
        let all = counted(d.specimens, nouns.unit, nouns.units);
        format!("; the same sign of an effect in all {all} has p {p} by itself")
    });
    format!(
        " The smallest family-wise p that the draws can give is {}{signs}.",
        probability(d.smallest_p.familywise)
    )
}

/// What a base model is called.
fn base_model(id: &str) -> String {
    match id {
        "new" | "new_published" => "the new model".to_owned(),
        _ => {
            let mut published = models::published().into_iter();
            let title = published.find(|m| m.id() == id).map(|m| m.title());
            name::model_name(id, title.unwrap_or(id)).to_owned()
        }
    }
}

/// Source, scatter behind it, root, share of the variance.
pub(super) fn budget(found: &CampaignFindings) -> Vec<[String; 4]> {
    let total: f64 = found.budget.iter().map(|b| b.variance).sum();
    let mut order: Vec<_> = found.budget.iter().collect();
    order.sort_by(|a, b| b.variance.total_cmp(&a.variance));
    let row = |b: &&pipeline_findings::BudgetEntry| {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;

    #[test]
    fn something_simpler_is_named_where_it_does_better() {
        let found = example();
        let own = found.after.rmse_heldout.unwrap();
        let said = |error: f64| {
            let words = "the law alone";
            let brief = in_brief(&found, Some(Simpler { words, error }));
            let of_errors = brief.rest.into_iter().find(|r| r.0 == sentence::ERROR);
            of_errors.unwrap().1
        };
        assert!(said(0.9 * own).contains("; the law alone 14.2"));
        assert!(!said(0.99 * own).contains("law alone"));
        let nothing = in_brief(&found, None).rest;
        assert!(
            nothing
                .iter()
                .all(|(_, words)| !words.contains("law alone"))
        );
    }
}
