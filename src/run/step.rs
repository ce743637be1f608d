//! What a step is made of, and what it leaves.

use pipeline_base::digest::Outputs;
use pipeline_cache::reason::Reason;
use pipeline_cache::store::Entry;
use std::time::Duration;

/// A stage as the cache sees it.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Name, as in `--force`.
    pub name: &'static str,
    /// Version constant.
    pub version: u32,
    /// Fingerprint of its sources.
    pub code: &'static str,
}

/// A unit that was computed, or would be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Work {
    /// Name of the stage.
    pub stage: &'static str,
    /// Session, group or report.
    pub unit: String,
    /// Why.
    pub reasons: Vec<Reason>,
    /// How long it took; zero where it has not been done.
    pub took: Duration,
}

/// A unit that could not be computed, for a defect of the program; or one that needs such a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Name of the stage.
    pub stage: &'static str,
    /// Session, group or report.
    pub unit: String,
    /// What went wrong, or on what it waits.
    pub why: String,
}

/// The result of a step.
pub enum Step {
    /// The outputs were there.
    Fresh(Entry),
    /// The outputs were computed; the bytes are at hand until the step is settled.
    Done(Entry, Outputs),
    /// A dry run: they would be computed. Or they could not be, and the run goes on without them.
    Pending,
}

impl Step {
    /// The entry, unless the step is pending.
    pub fn entry(&self) -> Option<&Entry> {
        match self {
            Step::Fresh(entry) | Step::Done(entry, _) => Some(entry),
            Step::Pending => None,
        }
    }

    /// The same without the bytes, which the cache has: a large campaign does not fit into memory.
    pub fn settled(self) -> Self {
        match self {
            Step::Done(entry, _) => Step::Done(entry, Outputs::new()),
            other => other,
        }
    }
}
