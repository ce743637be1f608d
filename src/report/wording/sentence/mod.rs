//! The answer of a campaign in sentences: what was found, what the error is made of, what is worth measuring. A file has one of these.

mod budget;
mod errors;
mod evidence;
mod form;
mod found;
mod next;
mod points;
mod recording;
mod undecided;

use crate::number::Rounding;
use crate::wording::name::capitalised;
use crate::wording::number::{error_with_unit, rounded};
use budget::{budget, largest_source};
use errors::{errors, errors_in_numbers, errors_in_short};
use found::{answer, beside, contradicted, in_names, short_answer};
use next::{error_after_few, few_readings, worth};
use pipeline_findings::{CampaignFindings, Verdict};
use recording::{recording_errors, recording_errors_in_short};
use serde::{Deserialize, Serialize};

pub use budget::{scatter_behind, scatter_size};
pub use errors::black_box_beats;
pub use evidence::{PLACEBO, beside_noise, differ, grades};
pub use form::form;
pub use found::{alias_set, beyond_usual, called, has_terms};
pub use next::{assumed, conditions, is_worth_credible, measurement, plain_number, worth_words};
pub use points::{ERROR, Points, points};
pub use recording::{implausible, in_doubt, recorded_size, set_aside};

/// What there is to say of a campaign; the report says all of it, the command line as much as fits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clauses {
    /// Recording errors; none where there are none.
    pub recording_errors: Option<String>,
    /// Uncertainties that were declared and are contradicted.
    pub contradicted: Option<String>,
    /// What was found.
    pub found: String,
    /// Whether "the smallest detectable sizes are in" a table belongs behind what was found.
    pub limits: bool,
    /// What stays without a name beside an effect.
    pub unexplained: Option<String>,
    /// What the errors on unseen units are, before and after, and whether what was predicted of their spread fits better or worse.
    pub errors: Option<String>,
    /// The same in fewer words, for the first page of the reports on force and torque.
    pub errors_in_short: Option<String>,
    /// What the expected error is made of.
    pub budget: Option<String>,
    /// What the best next measurement is worth.
    pub worth: Option<String>,
    /// What a few readings of a new unit are worth.
    pub readings: Option<String>,
}

/// Everything that there is to say, each clause without a capital and without a full stop.
pub fn clauses(found: &CampaignFindings) -> Clauses {
    Clauses {
        recording_errors: recording_errors(&found.recording_errors),
        contradicted: contradicted(found),
        found: answer(found),
        limits: found.verdict == Verdict::None && !found.detection_limits.is_empty(),
        unexplained: (found.verdict == Verdict::EffectFound)
            .then(|| beside(found))
            .flatten(),
        errors: errors(found),
        errors_in_short: errors_in_short(found),
        budget: budget(found),
        worth: worth(found),
        readings: few_readings(found),
    }
}

/// The answer of a campaign for a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// What was found, and the errors where something was: a sentence without its full stop.
    pub opening: String,
    /// Whether "; the smallest detectable sizes are in" a table belongs behind it.
    pub limits: bool,
    /// Everything else, in sentences.
    pub rest: Vec<String>,
}

/// What was found with the errors; what they are made of and what would help; recording errors.
pub fn full_answer(found: &CampaignFindings) -> Answer {
    said(clauses(found))
}

fn said(c: Clauses) -> Answer {
    let (beside, apart) = if c.limits {
        (None, c.errors)
    } else {
        (c.errors, None)
    };
    let opening: Vec<String> = [Some(c.found), beside].into_iter().flatten().collect();
    let second: Vec<String> = [c.budget, c.worth, c.readings]
        .into_iter()
        .flatten()
        .collect();
    let second = (!second.is_empty()).then(|| second.join("; "));
    let rest = [
        c.contradicted,
        apart,
        c.unexplained,
        second,
        c.recording_errors,
    ]
    .into_iter()
    .flatten();
    Answer {
        opening: capitalised(&opening.join(": ")),
        limits: c.limits,
        rest: rest.map(|s| capitalised(&s) + ".").collect(),
    }
}

/// What was found with the errors, and what is worth measuring next, in sentences.
pub fn answer_in_short(found: &CampaignFindings) -> Vec<String> {
    let all = clauses(found);
    let first = [Some(short_answer(found)), all.errors_in_short];
    let first: Vec<String> = first.into_iter().flatten().collect();
    let next = all.worth.map(|worth| format!("next: {worth}"));
    let sentences = [Some(first.join(": ")), next].into_iter().flatten();
    sentences.map(|s| capitalised(&s) + ".").collect()
}

/// The campaign in three lines: what was found without its remarks, the first of the mistakes, and what was declared wrongly; the errors as numbers; where they come from and what is
/// worth measuring. A line that has nothing to say is not there.
/// With the law alone where that is the better one.
pub fn in_three_lines(found: &CampaignFindings, better_law_alone: Option<LawAlone>) -> Vec<String> {
    let mistakes = recording_errors_in_short(&found.recording_errors);
    let worth = worth(found);
    // That there is no error is said with what would give one.
    let is_tested = found.before.rmse_heldout.is_some() || worth.is_none();
    let errors = errors_in_numbers(found).filter(|_| is_tested);
    let next = worth.map(|worth| format!("next: {worth}"));
    let lines = [
        [Some(in_names(found)), mistakes, contradicted(found)],
        [
            errors,
            error_after_few(found),
            better_law_alone.map(LawAlone::in_words),
        ],
        [largest_source(found), next, None],
    ];
    let lines = lines.map(|parts| parts.into_iter().flatten().collect::<Vec<_>>().join("; "));
    lines.into_iter().filter(|line| !line.is_empty()).collect()
}

/// The new model without effects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawAlone {
    /// With its published coefficients; else fitted to the other specimens by least squares.
    pub is_published: bool,
    /// Its error on the readings of the search, N.
    pub rmse_n: f64,
}

impl LawAlone {
    /// `the law alone, by least squares, has 59.0 N on all readings`: beside the errors of a search that does not come to it.
    pub fn in_words(self) -> String {
        let error = error_with_unit(self.rmse_n, "N");
        format!("{} has {error} on all readings", self.name())
    }

    /// What is called so.
    pub fn name(self) -> &'static str {
        if self.is_published {
            "the law as published, without effects,"
        } else {
            "the law alone, by least squares,"
        }
    }
}

/// A count with its noun: `1 reading`, `1,290 readings`.
pub fn counted(n: usize, one: &str, several: &str) -> String {
    let number = rounded(n as f64, Rounding::Decimals(0));
    format!("{number} {}", if n == 1 { one } else { several })
}

/// The same as sentences, without a table to point to.
pub fn sentences(found: &CampaignFindings) -> Vec<String> {
    let Answer {
        opening,
        limits,
        rest,
    } = full_answer(found);
    let limits = if limits {
        "; the smallest detectable sizes are in tables/detection_limits.csv"
    } else {
        ""
    };
    [format!("{opening}{limits}.")]
        .into_iter()
        .chain(rest)
        .collect()
}
