//! The messages about every session, remembered so that a run without changes need not open what its sessions left.

use crate::code;
use crate::engine::Engine;
use crate::made::UnitMade;
use crate::parallel;
use crate::stages::normalize::{REJECTS, ROWS};
use crate::stages::{clean, ingest};
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::digest::Digest;
use pipeline_base::error::Result;
use pipeline_base::reject::{Extent, Reject};
use pipeline_config::Config;
use pipeline_formats::discover::Discovery;
use pipeline_inspect::plausible::{self, Doubt};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

const MESSAGES: &str = "messages.jsonl";

/// The messages about one session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Messages {
    /// Errors and warnings about its files.
    pub diagnostics: Vec<Diagnostic>,
    /// The logs that could not be read; of each there is a diagnostic.
    pub unreadable: Vec<Reject>,
    /// The logs that were read and left out, and the session itself.
    pub rejects: Vec<Reject>,
    /// What no such actuator does.
    pub doubts: Vec<Doubt>,
}

/// What messages are made of beside the outputs of stages.
pub struct Described<'a> {
    /// The sessions as they were found.
    pub discovery: &'a Discovery,
    /// The options of the run.
    pub config: &'a Config,
}

/// By session: a digest of the outputs of its stages and of what judges them, and what follows from that.
type Remembered = BTreeMap<String, (Digest, Messages)>;

/// The messages about the sessions that are up to date, by id; `jobs` sessions at a time.
///
/// # Errors
/// A damaged cache; system errors of the store.
pub fn all(
    engine: &Engine,
    sessions: &[UnitMade],
    described: &Described,
    (jobs, only_look): (usize, bool),
) -> Result<BTreeMap<String, Messages>> {
    let before: Remembered = engine.read_aside(MESSAGES);
    // What looks implausible is read again, by polars: why the threads are no workers of a pool, see `parallel`.
    let now = parallel::each(jobs, sessions, |session| {
        let Some(digest) = digest_of(session, described.config) else {
            return Ok(None);
        };
        let remembered = before
            .get(&session.unit.name)
            .filter(|(of, _)| *of == digest);
        let messages = match remembered {
            Some((_, messages)) => messages.clone(),
            None => messages(engine, session, described)?,
        };
        Ok(Some((session.unit.name.clone(), (digest, messages))))
    })?;
    let now: Remembered = now.into_iter().flatten().collect();
    if now != before && !only_look {
        engine.write_aside(MESSAGES, &now)?;
    }
    let messages = now.into_iter().map(|(id, (_, messages))| (id, messages));
    Ok(messages.collect())
}

/// One digest over the outputs of the stages of a session, and the code and options that judge its readings; none while one of them is pending.
fn digest_of(session: &UnitMade, config: &Config) -> Option<Digest> {
    let judged =
        Digest::of(format!("{} {:?} {:?}", code::INSPECT, config.clean, config.fit).as_bytes());
    let outputs = session
        .outputs()
        .map(|(name, d)| Some((name.to_owned(), d?)));
    let mut outputs: Vec<(String, &Digest)> = outputs.collect::<Option<_>>()?;
    outputs.push(("judged".to_owned(), &judged));
    Some(Digest::of_named(outputs.iter().map(|(name, d)| (name, *d))))
}

fn messages(engine: &Engine, session: &UnitMade, described: &Described) -> Result<Messages> {
    let ingest = session.read(engine, &ingest::HEADER)?;
    let mut rejects = session.read(engine, &clean::HEADER)?.rejects;
    rejects.extend(session.read(engine, &REJECTS)?);
    rejects.retain(|r| matches!(r.extent, Extent::Session | Extent::Log));
    let mut diagnostics = ingest.diagnostics;
    diagnostics.retain(|d| d.severity != Severity::Note);
    let rows = session.read(engine, &ROWS)?;
    let located = session.unit.sessions.first();
    let located = located.and_then(|k| described.discovery.sessions.get(*k));
    let doubts = located.map(|l| plausible::doubts(l, &rows, described.config));
    Ok(Messages {
        diagnostics,
        unreadable: ingest.rejects,
        rejects,
        doubts: doubts.unwrap_or_default(),
    })
}
