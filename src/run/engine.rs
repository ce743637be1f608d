//! One step of the pipeline: a stage applied to a unit, taken from the cache where its key is known.

use crate::base::error::{Error, Result};
use crate::cache::key::KeyParts;
use crate::cache::reason::{Reason, differences};
use crate::cache::store::{Entry, Object, Outputs};
use crate::cache::{Digest, FileHashes};
use crate::run::cache::{Access, Cache, STATE};
use crate::run::{Progress, RunOptions};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::{Duration, Instant};

include!(concat!(env!("OUT_DIR"), "/fingerprints.rs"));

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

/// The result of a step.
pub enum Step {
    /// The outputs were there.
    Fresh(Entry),
    /// The outputs were computed; the bytes are at hand.
    Done(Entry, Outputs),
    /// A dry run, in which they would be computed, or a job to which they do not belong.
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
}

/// The cache of a run, with what it has done so far.
pub struct Engine {
    cache: Cache,
    /// Digests of raw files.
    pub hashes: FileHashes,
    now: Mutex<BTreeMap<String, Digest>>,
    work: Mutex<Vec<Work>>,
    fresh: Mutex<usize>,
    force: Option<String>,
    dry_run: bool,
    /// Names of the steps that are asked for; all where there are none.
    asked: Option<BTreeSet<String>>,
}

const HASHES: &str = "hashes.json";

impl Engine {
    /// Opens the cache below `derived/`; waits for another run on it to end. A job, which is `asked` for some steps only, shares it with
    /// other jobs.
    ///
    /// # Errors
    /// The directory cannot be made or written.
    pub fn open(
        options: &RunOptions,
        asked: Option<BTreeSet<String>>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let access = match (options.dry_run, &asked) {
            (true, _) => Access::Look,
            (false, Some(_)) => Access::Shared,
            (false, None) => Access::Alone,
        };
        let cache = Cache::open(&options.derived, access, progress)?;
        Ok(Self {
            hashes: FileHashes::from_json(&cache.store().read_aside(HASHES)),
            cache,
            now: Mutex::default(),
            work: Mutex::default(),
            fresh: Mutex::default(),
            force: options.force.clone(),
            dry_run: options.dry_run,
            asked,
        })
    }

    /// Applies `stage` to `unit`: `compute` is called only if no result with this key is there.
    ///
    /// # Errors
    /// Whatever `compute` fails with, and system errors of the store.
    pub fn step(
        &self,
        stage: Stage,
        unit: &str,
        options: BTreeMap<String, String>,
        inputs: BTreeMap<String, Digest>,
        compute: impl FnOnce() -> Result<Outputs>,
    ) -> Result<Step> {
        if !self.is_asked(stage, unit) {
            return Ok(Step::Pending);
        }
        let parts = KeyParts {
            stage: stage.name.to_owned(),
            version: stage.version,
            code: stage.code.to_owned(),
            options,
            inputs,
        };
        let key = parts.key();
        let reasons = match self.cache.store().entry(&key) {
            Ok(Some(entry)) if self.force.as_deref() != Some(stage.name) => {
                *self.fresh.lock().map_err(Error::internal)? += 1;
                self.remember(stage, unit, key)?;
                return Ok(Step::Fresh(entry));
            }
            Ok(Some(_)) => vec![Reason::Forced],
            Ok(None) => self.why(stage, unit, &parts),
            Err(damage) => vec![Reason::Damaged(damage)],
        };
        if self.dry_run {
            self.record(stage, unit, reasons, Duration::ZERO)?;
            return Ok(Step::Pending);
        }
        let started = Instant::now();
        let outputs = compute()?;
        let entry = self.cache.store().put(parts, &outputs)?;
        self.record(stage, unit, reasons, started.elapsed())?;
        self.remember(stage, unit, key)?;
        Ok(Step::Done(entry, outputs))
    }

    /// Notes, in a dry run, that a unit waits for an earlier stage.
    ///
    /// # Errors
    /// Another thread panicked.
    pub fn waits(&self, stage: Stage, unit: &str, on: &str) -> Result<Step> {
        if self.is_asked(stage, unit) {
            let reasons = vec![Reason::Waits(on.to_owned())];
            self.record(stage, unit, reasons, Duration::ZERO)?;
        }
        Ok(Step::Pending)
    }

    fn is_asked(&self, stage: Stage, unit: &str) -> bool {
        let name = || name_of(stage.name, unit);
        self.asked
            .as_ref()
            .is_none_or(|asked| asked.contains(&name()))
    }

    /// The bytes of an output, from memory if the step has just made it.
    ///
    /// # Errors
    /// The stored bytes are missing or damaged; the entry is dropped, so that the next attempt computes it again.
    pub fn read(&self, step: &Step, name: &str) -> Result<Vec<u8>> {
        match step {
            Step::Done(_, outputs) => outputs.get(name).cloned().ok_or_else(|| missing(name)),
            Step::Fresh(entry) => {
                let object = entry.outputs.get(name).ok_or_else(|| missing(name))?;
                self.cache.store().read(object).map_err(|damage| {
                    self.cache.store().forget(&entry.parts.key());
                    Error::Damaged(format!("{name} of {}: {damage}", entry.parts.stage))
                })
            }
            Step::Pending => Err(missing(name)),
        }
    }

    /// A small file of the cache, empty where it is not there.
    pub fn read_aside(&self, name: &str) -> Vec<u8> {
        self.cache.store().read_aside(name)
    }

    /// Replaces a small file of the cache.
    ///
    /// # Errors
    /// What the system says.
    pub fn write_aside(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.cache.store().write_aside(name, bytes)
    }

    /// Path of an object's file, for links.
    pub fn object_path(&self, object: &Object) -> std::path::PathBuf {
        self.cache.store().object_path(&object.digest)
    }

    fn why(&self, stage: Stage, unit: &str, parts: &KeyParts) -> Vec<Reason> {
        let Some(last) = self.cache.last().get(&name_of(stage.name, unit)) else {
            return vec![Reason::FirstTime];
        };
        match self.cache.store().recorded(last) {
            Some(old) => {
                let reasons = differences(&old.parts, parts);
                if reasons.is_empty() {
                    vec![Reason::Damaged("the entry is missing".to_owned())]
                } else {
                    reasons
                }
            }
            None => vec![Reason::Damaged("the entry is missing".to_owned())],
        }
    }

    fn record(&self, stage: Stage, unit: &str, reasons: Vec<Reason>, took: Duration) -> Result<()> {
        self.work.lock().map_err(Error::internal)?.push(Work {
            stage: stage.name,
            unit: unit.to_owned(),
            reasons,
            took,
        });
        Ok(())
    }

    fn remember(&self, stage: Stage, unit: &str, key: Digest) -> Result<()> {
        self.now
            .lock()
            .map_err(Error::internal)?
            .insert(name_of(stage.name, unit), key);
        Ok(())
    }

    /// Writes down which keys are current, and what is known of the raw files. A job leaves the keys as they were, which are those of the
    /// last whole run, and adds to the files what it has read itself.
    ///
    /// # Errors
    /// System errors of the store.
    pub fn close(&self) -> Result<()> {
        if self.asked.is_some() {
            let others = self.cache.store().read_aside(HASHES);
            return match self.hashes.to_json_with(&others) {
                Some(json) => self.cache.store().write_aside(HASHES, &json),
                None => Ok(()),
            };
        }
        let now = self.now.lock().map_err(Error::internal)?;
        if *now != *self.cache.last() {
            let json = serde_json::to_vec(&*now).map_err(Error::internal)?;
            self.cache.store().write_aside(STATE, &json)?;
        }
        if let Some(json) = self.hashes.to_json() {
            self.cache.store().write_aside(HASHES, &json)?;
        }
        Ok(())
    }

    /// Begins again after a damaged entry was dropped: what has been computed since is fresh now.
    ///
    /// # Errors
    /// Another thread panicked.
    pub fn restart(&self) -> Result<()> {
        *self.fresh.lock().map_err(Error::internal)? = 0;
        Ok(())
    }

    /// What was computed, by stage and unit, and how many units were fresh.
    pub fn into_work(self) -> (Vec<Work>, usize) {
        let mut work = self.work.into_inner().unwrap_or_default();
        let place = |w: &Work| crate::run::STAGES.iter().position(|s| *s == w.stage);
        work.sort_by(|a, b| (place(a), &a.unit).cmp(&(place(b), &b.unit)));
        (work, self.fresh.into_inner().unwrap_or_default())
    }
}

/// Name of a step: a stage with a unit.
pub fn name_of(stage: &str, unit: &str) -> String {
    format!("{stage}/{unit}")
}

fn missing(name: &str) -> Error {
    Error::Internal(format!("output {name} is missing"))
}
