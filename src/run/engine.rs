//! One step of the pipeline: a stage applied to a unit, taken from the cache where its key is known.

use crate::cache::{Access, Cache, STATE};
use crate::step::{Failure, Stage, Step, Work};
use crate::{Progress, RunOptions, defect};
use pipeline_base::digest::Digest;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_cache::key::KeyParts;
use pipeline_cache::reason::{Reason, differences};
use pipeline_cache::store::{Entry, Object, Objects};
use pipeline_cache::{FileHashes, Left, State};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The cache of a run, with what it has done so far.
pub struct Engine {
    cache: Cache,
    /// Digests of raw files and reports.
    pub hashes: FileHashes,
    now: Mutex<State>,
    work: Mutex<Vec<Work>>,
    failed: Mutex<Vec<Failure>>,
    fresh: Mutex<usize>,
    force: Option<String>,
    dry_run: bool,
    keep_going: bool,
    /// Names of the steps that are asked for; all where there are none.
    asked: Option<BTreeSet<String>>,
}

const HASHES: &str = "hashes.jsonl";

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
            hashes: FileHashes::new(cache.store().read_aside(HASHES)),
            cache,
            now: Mutex::default(),
            work: Mutex::default(),
            failed: Mutex::default(),
            fresh: Mutex::default(),
            force: options.force.clone(),
            dry_run: options.dry_run,
            keep_going: options.keep_going,
            asked,
        })
    }

    /// Applies `stage` to `unit`: `compute` is called only if no result with this key is there.
    ///
    /// # Errors
    /// Whatever `compute` fails with, and system errors of the store. A panic of `compute` is an error that names the unit; a run that keeps
    /// going notes it and leaves the step pending.
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
        let reasons = match self.known(stage, unit, &key) {
            Ok(Some(outputs)) if self.force.as_deref() != Some(stage.name) => {
                *self.fresh.lock().map_err(Error::internal)? += 1;
                self.remember(stage, unit, key, &outputs)?;
                return Ok(Step::Fresh(Entry { parts, outputs }));
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
        let outputs = match defect::caught(stage, unit, compute) {
            Err(Error::Internal(why)) if self.keep_going => return self.fail(stage, unit, why),
            other => other?,
        };
        let entry = self.cache.store().put(parts, &outputs)?;
        self.record(stage, unit, reasons, started.elapsed())?;
        self.remember(stage, unit, key, &entry.outputs)?;
        Ok(Step::Done(entry, outputs))
    }

    /// The outputs of a key: as the last run left them if nobody has touched the entry since, else as the entry says.
    fn known(
        &self,
        stage: Stage,
        unit: &str,
        key: &Digest,
    ) -> std::result::Result<Option<Objects>, String> {
        let store = self.cache.store();
        let untouched = |left: &&Left| {
            left.key == *key && left.entry_ns > 0 && left.entry_ns == store.entry_ns(key)
        };
        match self
            .cache
            .last()
            .get(&name_of(stage.name, unit))
            .filter(untouched)
        {
            Some(left) => store.checked(left.outputs.clone()).map(Some),
            None => store.outputs(key),
        }
    }

    /// Notes that a unit could not be computed, and leaves it pending.
    ///
    /// # Errors
    /// Another thread panicked.
    pub fn fail(&self, stage: Stage, unit: &str, why: String) -> Result<Step> {
        self.failed.lock().map_err(Error::internal)?.push(Failure {
            stage: stage.name,
            unit: unit.to_owned(),
            why,
        });
        Ok(Step::Pending)
    }

    /// Notes that a unit waits for an earlier stage: in a dry run, or where that one failed.
    ///
    /// # Errors
    /// Another thread panicked.
    pub fn waits(&self, stage: Stage, unit: &str, on: &str) -> Result<Step> {
        if !self.is_asked(stage, unit) {
            return Ok(Step::Pending);
        }
        let reason = Reason::Waits(on.to_owned());
        if self.dry_run {
            self.record(stage, unit, vec![reason], Duration::ZERO)?;
            return Ok(Step::Pending);
        }
        self.fail(stage, unit, reason.to_string())
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
    /// The stored bytes are missing or damaged; they are dropped, so that the next attempt computes them again.
    pub fn read(&self, step: &Step, name: &str) -> Result<Vec<u8>> {
        let entry = match step {
            Step::Done(_, outputs) if outputs.contains_key(name) => {
                return Ok(outputs[name].clone());
            }
            Step::Done(entry, _) | Step::Fresh(entry) => entry,
            Step::Pending => return Err(missing(name)),
        };
        let object = entry.outputs.get(name).ok_or_else(|| missing(name))?;
        let store = self.cache.store();
        store.read(object).or_else(|damage| {
            store.discard(object)?;
            Err(Error::Damaged(format!(
                "{name} of {}: {damage}",
                entry.parts.stage
            )))
        })
    }

    /// The value in a small file of the cache; the empty value where the file is not there or not whole.
    pub fn read_aside<T: DeserializeOwned + Default>(&self, name: &str) -> T {
        self.cache.store().read_aside(name)
    }

    /// Replaces a small file of the cache.
    ///
    /// # Errors
    /// What the system says.
    pub fn write_aside(&self, name: &str, value: &impl Serialize) -> Result<()> {
        self.cache.store().write_aside(name, value)
    }

    /// Path of an object's file, for links.
    pub fn object_path(&self, object: &Object) -> std::path::PathBuf {
        self.cache.store().object_path(&object.digest)
    }

    fn why(&self, stage: Stage, unit: &str, parts: &KeyParts) -> Vec<Reason> {
        let Some(last) = self.cache.last().get(&name_of(stage.name, unit)) else {
            return vec![Reason::FirstTime];
        };
        match self.cache.store().recorded(&last.key) {
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

    fn remember(&self, stage: Stage, unit: &str, key: Digest, outputs: &Objects) -> Result<()> {
        let left = Left {
            entry_ns: self.cache.store().entry_ns(&key),
            key,
            outputs: outputs.clone(),
        };
        let mut now = self.now.lock().map_err(Error::internal)?;
        now.insert(name_of(stage.name, unit), left);
        Ok(())
    }

    /// Writes down what every unit has left, and what is known of raw files and reports. A job leaves the units as they were, which is how the
    /// last whole run left them, and adds to the files what it has read itself.
    ///
    /// # Errors
    /// System errors of the store.
    pub fn close(&self) -> Result<()> {
        if self.asked.is_some() {
            let others = self.cache.store().read_aside(HASHES);
            return match self.hashes.learned_beside(others) {
                Some(learned) => self.cache.store().write_aside(HASHES, &learned),
                None => Ok(()),
            };
        }
        let mut now = std::mem::take(&mut *self.now.lock().map_err(Error::internal)?);
        if now != *self.cache.last() {
            now = now.into_iter().map(|(n, l)| (n, l.settled())).collect();
            self.cache.store().write_aside(STATE, &now)?;
        }
        if let Some(learned) = self.hashes.learned() {
            self.cache.store().write_aside(HASHES, &learned)?;
        }
        Ok(())
    }

    /// Begins again after a damaged entry was dropped: what has been computed since is fresh now.
    ///
    /// # Errors
    /// Another thread panicked.
    pub fn restart(&self) -> Result<()> {
        *self.fresh.lock().map_err(Error::internal)? = 0;
        self.failed.lock().map_err(Error::internal)?.clear();
        Ok(())
    }

    /// What was computed, by stage and unit; how many units were fresh; what failed.
    ///
    /// # Errors
    /// Another thread panicked.
    pub fn take_work(&self) -> Result<(Vec<Work>, usize, Vec<Failure>)> {
        let place = |stage: &str| crate::stages::NAMES.iter().position(|s| *s == stage);
        let mut work = std::mem::take(&mut *self.work.lock().map_err(Error::internal)?);
        work.sort_by(|a, b| (place(a.stage), &a.unit).cmp(&(place(b.stage), &b.unit)));
        let mut failed = std::mem::take(&mut *self.failed.lock().map_err(Error::internal)?);
        failed.sort_by(|a, b| (place(a.stage), &a.unit).cmp(&(place(b.stage), &b.unit)));
        let fresh = *self.fresh.lock().map_err(Error::internal)?;
        Ok((work, fresh, failed))
    }
}

/// Name of a step: a stage with a unit.
pub fn name_of(stage: &str, unit: &str) -> String {
    format!("{stage}/{unit}")
}

fn missing(name: &str) -> Error {
    Error::Internal(format!("output {name} is missing"))
}
