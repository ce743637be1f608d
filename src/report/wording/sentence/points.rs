//! The answer of a campaign in labelled points, for a page on which many campaigns stand below one another.

use super::budget::points as budget_points;
use super::errors::points as error_points;
use super::found::{graded_answer, mounted_off};
use super::undecided::{not_needed, undecided};
use super::{Clauses, clauses};
use crate::wording::name::capitalised;
use pipeline_findings::{CampaignFindings, Verdict};

/// What the point of the errors is about.
pub const ERROR: &str = "Error";

/// What there is to say of a campaign, point by point; each is a sentence or two without a full stop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Points {
    /// What was found; where that is nothing, what the verdict does not say, or empty.
    pub found: String,
    /// Whether "the smallest detectable sizes are in" a table belongs behind it.
    pub limits: bool,
    /// Everything else: what the point is about, and what there is to say.
    pub rest: Vec<(&'static str, String)>,
}

/// What was found, and how strong the evidence is; the errors in their forms; what the expected error is made of; what would help; what in the records
/// is wrong.
pub fn points(found: &CampaignFindings) -> Points {
    let Clauses {
        recording_errors,
        contradicted,
        limits,
        unexplained,
        worth,
        ..
    } = clauses(found);
    // That there is no error is said with what would give one.
    let is_tested = found.before.rmse_heldout.is_some() || worth.is_none();
    let rest = [
        (ERROR, error_points(found).filter(|_| is_tested)),
        ("Made of", budget_points(found)),
        ("Not named", unexplained),
        ("The law", not_needed(found)),
        ("Undecided", undecided(found)),
        ("Declared", contradicted),
        ("Records", recording_errors),
        ("Next", worth),
    ];
    Points {
        found: if found.verdict == Verdict::None && found.effects.is_empty() {
            capitalised(&mounted_off(found).unwrap_or_default())
        } else {
            capitalised(&graded_answer(found))
        },
        limits,
        rest: rest
            .into_iter()
            .filter_map(|(about, words)| Some((about, capitalised(&words?))))
            .collect(),
    }
}
