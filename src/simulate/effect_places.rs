//! Where an effect of a truth file acts: on a specimen, in a session, from a session on.

use super::logged_columns::ColumnTruth;
use super::truth::SpecimenTruth;
use super::truth_lists::contraction_label;
use pipeline_base::toml_reader::{Entry, Section};
use serde::Serialize;

/// Where an effect acts: everywhere, unless one of these confines it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Place {
    /// On this specimen.
    pub specimen: Option<String>,
    /// In this session, id without the campaign's.
    pub session: Option<String>,
    /// In this session, in the order of time counted from 1, and in all later ones.
    pub from_session: Option<usize>,
}

/// What an effect may name; a list that could not be read is none, and nothing is checked against it.
pub struct Named<'a> {
    /// Id of the campaign.
    pub campaign: &'a str,
    /// The actuators.
    pub specimens: Option<&'a [SpecimenTruth]>,
    /// The relative contractions.
    pub contractions: Option<&'a [f64]>,
    /// The extra columns.
    pub columns: Option<&'a [ColumnTruth]>,
}

/// The keys `specimen`, `session` and `from_session` of an effect's table.
pub fn place(table: &Section, named: &Named) -> Option<Place> {
    let specimens = named.specimens.map(ids);
    let sessions = specimens.as_deref().zip(named.contractions);
    let sessions = sessions.map(|(specimens, c)| session_ids(specimens, c));
    let in_list = |list: &Option<Vec<String>>, id: &str| {
        list.as_ref()
            .is_none_or(|l| l.iter().any(|known| known == id))
    };
    let specimen = optional(table.get("specimen"), |e| {
        let id = e.string()?;
        known(e, in_list(&specimens, &id), "a specimen of this file")?;
        Some(id)
    });
    let session = optional(table.get("session"), |e| {
        let id = e.string()?;
        let own = id.strip_prefix(named.campaign);
        let own = own.and_then(|id| id.strip_prefix('-')).unwrap_or(&id);
        known(
            e,
            in_list(&sessions, own),
            "specimen-cNN, a session of this file",
        )?;
        Some(own.to_owned())
    });
    let from_session = optional(table.get("from_session"), |e| {
        let place = usize::try_from(e.integer()?).unwrap_or(0);
        let last = sessions.as_ref().map_or(usize::MAX, Vec::len);
        known(
            e,
            (1..=last).contains(&place),
            "a place in time, the first session being 1",
        )?;
        Some(place)
    });
    Some(Place {
        specimen: specimen?,
        session: session?,
        from_session: from_session?,
    })
}

fn ids(specimens: &[SpecimenTruth]) -> Vec<String> {
    specimens.iter().map(|s| s.id.clone()).collect()
}

fn session_ids(specimens: &[String], contractions: &[f64]) -> Vec<String> {
    let of = |s: &String| {
        let labels = contractions.iter().map(|c| contraction_label(*c));
        labels
            .map(|label| format!("{s}-{label}"))
            .collect::<Vec<_>>()
    };
    specimens.iter().flat_map(of).collect()
}

/// A key that may be left out: `None` for one that is no good.
fn optional<T>(entry: Option<Entry>, read: impl Fn(&Entry) -> Option<T>) -> Option<Option<T>> {
    match entry {
        None => Some(None),
        Some(entry) => read(&entry).map(Some),
    }
}

fn known(entry: &Entry, good: bool, expected: &str) -> Option<()> {
    if !good {
        entry.reject(expected, "compare the ids in this file");
    }
    good.then_some(())
}
