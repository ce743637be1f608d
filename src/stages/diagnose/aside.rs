//! What looks mistaken and is set aside: among which readings it is looked for, beside which law, and what is left without it.

use crate::base::Base;
use crate::data::{self, Data};
use crate::library::{self, What};
use crate::problem::ForceProblem;
use crate::recording::{self, Law};
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_findings::{Level, RecordingError};
use pipeline_fit::Group;
use pipeline_inference::decisions;
use pipeline_inference::search::Found;
use std::collections::BTreeSet;

/// Groups that look mistaken.
pub(crate) fn groups_of(mistakes: &[RecordingError]) -> BTreeSet<&str> {
    mistakes.iter().map(|m| m.group.as_str()).collect()
}

/// Whether some mistakes are among others, and fewer.
pub(crate) fn is_part(mistakes: &[RecordingError], of: &[RecordingError]) -> bool {
    let (part, whole) = (groups_of(mistakes), groups_of(of));
    part.len() < whole.len() && part.is_subset(&whole)
}

/// What looks mistaken beside a law among the sessions that are searched.
pub(crate) fn mistakes_among(group: &Group, law: &Law, data: &Data) -> Vec<RecordingError> {
    if data.len() < decisions::FEWEST_READINGS || data.specimens.len() < decisions::FEWEST_SPECIMENS
    {
        return Vec::new();
    }
    recording::recording_errors(group.diameter_mm, law, data)
}

/// The readings whose sessions and specimens may be mistaken: those that are searched.
pub(crate) fn judged(rows: &[&Row]) -> Data {
    let searched = rows.iter().filter(|r| r.role != Some(Role::Holdout));
    let searched: Vec<&Row> = searched.copied().collect();
    Data::new(&searched)
}

/// The rows without what is set aside.
pub(crate) fn without_mistakes<'a>(mistakes: &[RecordingError], rows: &[&'a Row]) -> Vec<&'a Row> {
    let searched = rows.iter().filter(|r| r.role != Some(Role::Holdout));
    let campaigns: BTreeSet<&str> = searched.map(|r| r.campaign.as_str()).collect();
    let is_aside = |row: &&&Row| {
        mistakes.iter().any(|m| match m.level {
            Level::Specimen => {
                m.set_aside && m.group == data::specimen_id(row, campaigns.len() > 1)
            }
            _ => m.set_aside && m.group == row.session,
        })
    };
    rows.iter().filter(|r| !is_aside(r)).copied().collect()
}

/// The law with what was found on all readings, for the data that is judged.
pub(crate) fn law_found<'a>(
    base: &'a Base,
    judged: &Data,
    problem: &ForceProblem,
    found: &Found,
) -> Law<'a> {
    let terms = found.model.point.terms.iter();
    let whole = terms.filter(|(t, _)| problem.library[*t].scope == library::Scope::All);
    whole.fold(Law::new(base), |law, (t, values)| {
        let what = match problem.library[*t].what {
            What::Column(column) => column.of(problem.data, judged).map(What::Column),
            effect @ What::Effect { .. } => Some(effect),
        };
        match what {
            Some(what) => law.with(what, values),
            None => law,
        }
    })
}
