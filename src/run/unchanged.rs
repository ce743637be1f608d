//! The shortest answer: no file has changed since the last run, so there is nothing to ask the stages.
//!
//! A whole run writes down the fingerprint of the raw files, taken before it read any of them, that of everything that it has left below
//! `derived/` and `reports/`, and its messages. Where both are the same in the next run, and the program and its options too, that
//! is said again: no `session.toml` is read and no key is made. With anything else the stages are asked as if this did not exist, so that it
//! saves time and decides nothing.

use crate::cache::{Access, Cache};
use crate::code;
use crate::engine::Engine;
use crate::{Outcome, Progress, RunOptions, parallel};
use pipeline_base::digest::Digest;
use pipeline_base::error::Result;
use pipeline_cache::{Store, tree};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const UNCHANGED: &str = "unchanged.jsonl";

#[derive(Serialize, Deserialize)]
struct Left {
    /// The program, its options and where its files are.
    program: Digest,
    /// The raw files before the run.
    raw: Digest,
    /// What the run left.
    made: Digest,
    outcome: Outcome,
}

/// A run that watches whether anything has changed.
pub struct Watch<'a> {
    options: &'a RunOptions,
    program: Digest,
    raw: Digest,
}

impl<'a> Watch<'a> {
    /// Looks at the raw files, and the messages of the last run if nothing has changed since. No watch for a run that is to do something in any case or
    /// concerns a part only, and where the files prove nothing ([`tree::fingerprint`]).
    ///
    /// # Errors
    /// The cache cannot be opened.
    pub fn begin(
        options: &'a RunOptions,
        progress: &dyn Progress,
    ) -> Result<(Option<Self>, Option<Outcome>)> {
        if options.force.is_some() || options.only.is_some() {
            return Ok((None, None));
        }
        let program = program(options);
        let store = Store::new(&options.derived.join("cache"));
        let left: Option<Left> = store.read_aside(UNCHANGED);
        let left = left.filter(|left| left.program == program);
        let access = match options.dry_run || left.is_none() {
            true => Access::Look,
            false => Access::Alone,
        };
        // Whoever waits for another run looks after it.
        let _nobody_else_writes = Cache::lock(&options.derived, access, progress)?;
        let parts: Vec<PathBuf> = options.raw.iter().flat_map(|r| tree::parts(r)).collect();
        let Some(raw) = all(options, &parts, true) else {
            return Ok((None, None));
        };
        let left = left.filter(|left| left.raw == raw);
        let left = left.filter(|left| made(options).is_some_and(|made| made == left.made));
        let watch = Self {
            options,
            program,
            raw,
        };
        Ok((Some(watch), left.map(|left| left.outcome)))
    }

    /// Writes down what a run that is whole has left.
    ///
    /// # Errors
    /// System errors of the store.
    pub fn end(self, engine: &Engine, outcome: &Outcome) -> Result<()> {
        let Some(made) = made(self.options) else {
            return Ok(());
        };
        let mut outcome = outcome.clone();
        outcome.fresh += outcome.work.len();
        let left = Left {
            program: self.program,
            raw: self.raw,
            made,
            outcome,
        };
        engine.write_aside(UNCHANGED, &left)
    }
}

fn program(options: &RunOptions) -> Digest {
    let places = (&options.raw, &options.derived, &options.reports);
    let text = format!("{} {places:?} {:?}", code::CLI, options.config);
    Digest::of(text.as_bytes())
}

/// The fingerprint of what a run leaves; the small files of the cache aside, which only save time and of which this is one.
fn made(options: &RunOptions) -> Option<Digest> {
    let cache = options.derived.join("cache");
    let sessions = options.derived.join("sessions");
    let below = |folder: &Path| tree::parts(folder).into_iter();
    let parts = below(&options.derived)
        .filter(|part| *part != cache && *part != sessions)
        .chain(below(&sessions))
        .chain(below(&cache.join("entries")))
        .chain(below(&cache.join("objects")))
        .chain(below(&options.reports));
    all(options, &parts.collect::<Vec<_>>(), false)
}

/// One fingerprint of all parts.
fn all(options: &RunOptions, parts: &[PathBuf], follow: bool) -> Option<Digest> {
    let one = |part: &PathBuf| Ok(tree::fingerprint(part, follow));
    let prints: Vec<Option<Digest>> = parallel::each(options.jobs, parts, one).ok()?;
    let names = parts.iter().map(|p| p.display().to_string());
    let named: Option<Vec<(String, Digest)>> = names
        .zip(prints)
        .map(|(name, print)| Some((name, print?)))
        .collect();
    Some(Digest::of_named(named?.iter().map(|(n, d)| (n, d))))
}
