//! Sessions and specimens that may be mistaken, and what is left when some are gone.

use crate::data::Data;
use pipeline_inference::decisions::MOST_MISTAKEN_SHARE;
use std::collections::BTreeSet;

/// A session or a specimen, by its place in the lists of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    Session(usize),
    Specimen(usize),
}

/// The readings that are left, by session; a specimen goes with all its sessions.
#[derive(Clone)]
pub(super) struct Left {
    pub(super) sessions: BTreeSet<usize>,
    pub(super) specimen_of: Vec<usize>,
}

impl Left {
    pub(super) fn all(data: &Data) -> Self {
        Self {
            sessions: data.session.iter().copied().collect(),
            specimen_of: data.specimen_of_session(),
        }
    }

    /// The sessions of a group.
    pub(super) fn of(&self, group: Group) -> Vec<usize> {
        let in_it = |s: &usize| match group {
            Group::Session(session) => *s == session,
            Group::Specimen(specimen) => self.specimen_of[*s] == specimen,
        };
        self.sessions.iter().copied().filter(in_it).collect()
    }

    pub(super) fn without(&self, group: Group) -> Self {
        let mut rest = self.clone();
        for s in self.of(group) {
            rest.sessions.remove(&s);
        }
        rest
    }

    pub(super) fn specimens(&self) -> BTreeSet<usize> {
        self.sessions.iter().map(|s| self.specimen_of[*s]).collect()
    }

    /// How many groups could be mistaken.
    pub(super) fn groups(&self) -> usize {
        self.sessions.len() + self.specimens().len()
    }

    /// Whether so many are left that they can say what is right.
    pub(super) fn is_most_of(&self, data: &Data) -> bool {
        let all = Self::all(data);
        let gone = |now: usize, before: usize| (before - now) as f64 / before as f64;
        gone(self.sessions.len(), all.sessions.len()) <= MOST_MISTAKEN_SHARE.0
            && gone(self.specimens().len(), all.specimens().len()) <= MOST_MISTAKEN_SHARE.1
    }
}

/// The readings of the sessions that are left.
pub(super) fn readings_of(data: &Data, left: &Left) -> Data {
    let is_left = |i: &usize| left.sessions.contains(&data.session[*i]);
    let places: Vec<usize> = (0..data.len()).filter(is_left).collect();
    data.select(&places)
}
