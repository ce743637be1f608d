//! What the user is told of every session, remembered so that a run without changes need not open what its sessions left.

use crate::engine::Engine;
use crate::made::UnitMade;
use crate::stages::normalize::REJECTS;
use crate::stages::{clean, ingest};
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::digest::Digest;
use pipeline_base::error::Result;
use pipeline_base::reject::{Extent, Reject};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

const TOLD: &str = "told.jsonl";

/// What the user is told of one session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// Errors and warnings about its files.
    pub diagnostics: Vec<Diagnostic>,
    /// The logs that were left out, and the session itself.
    pub rejects: Vec<Reject>,
}

/// By session: a digest of what its stages gave, and what follows from that.
type Remembered = BTreeMap<String, (Digest, Told)>;

/// What is told of the sessions that are up to date, in their order.
///
/// # Errors
/// A damaged cache; system errors of the store.
pub fn all(engine: &Engine, sessions: &[UnitMade], only_look: bool) -> Result<Vec<Told>> {
    let before: Remembered = engine.read_aside(TOLD);
    let known = sessions.par_iter().map(|session| {
        let Some(digest) = outputs(session) else {
            return Ok(None);
        };
        let remembered = before
            .get(&session.unit.name)
            .filter(|(of, _)| *of == digest);
        let told = match remembered {
            Some((_, told)) => told.clone(),
            None => told(engine, session)?,
        };
        Ok(Some((session.unit.name.clone(), (digest, told))))
    });
    let now: Vec<Option<(String, (Digest, Told))>> = known.collect::<Result<_>>()?;
    let now: Remembered = now.into_iter().flatten().collect();
    if now != before && !only_look {
        engine.write_aside(TOLD, &now)?;
    }
    Ok(now.into_values().map(|(_, told)| told).collect())
}

/// One digest over what the stages of a session gave; none while one of them is pending.
fn outputs(session: &UnitMade) -> Option<Digest> {
    let gave = session.gave().map(|(name, d)| Some((name.to_owned(), d?)));
    let gave: Vec<(String, &Digest)> = gave.collect::<Option<_>>()?;
    Some(Digest::of_named(gave.iter().map(|(name, d)| (name, *d))))
}

fn told(engine: &Engine, session: &UnitMade) -> Result<Told> {
    let ingest = session.read(engine, &ingest::HEADER)?;
    let mut rejects = ingest.rejects;
    rejects.extend(session.read(engine, &clean::HEADER)?.rejects);
    rejects.extend(session.read(engine, &REJECTS)?);
    rejects.retain(|r| matches!(r.extent, Extent::Session | Extent::Log));
    let mut diagnostics = ingest.diagnostics;
    diagnostics.retain(|d| d.severity != Severity::Note);
    Ok(Told {
        diagnostics,
        rejects,
    })
}
