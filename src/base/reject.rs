//! What was left out, and why: nothing is dropped without being counted.

use serde::{Deserialize, Serialize};

/// The size of what was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Extent {
    /// Single rows of a log.
    Row,
    /// Rows of a log in which the actuator was not at rest.
    Transient,
    /// A steady plateau, with its rows.
    Plateau,
    /// A whole log.
    Log,
    /// A whole session.
    Session,
}

impl Extent {
    /// The word used in tables.
    pub fn name(self) -> &'static str {
        match self {
            Extent::Row => "row",
            Extent::Transient => "transient",
            Extent::Plateau => "plateau",
            Extent::Log => "log",
            Extent::Session => "session",
        }
    }
}

/// Rows that were left out for one reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reject {
    /// Session id, or the session's folder where the id is not known.
    pub session: String,
    /// Log file; empty for a whole session.
    pub log: String,
    /// First line concerned, counted from 1; none for a whole file.
    pub first_row: Option<u64>,
    /// Last line concerned.
    pub last_row: Option<u64>,
    /// Number of rows left out (0 where they were never read).
    pub count: u64,
    /// What was left out.
    pub extent: Extent,
    /// Why.
    pub reason: String,
}
