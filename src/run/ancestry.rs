//! Where an artifact comes from: the units of the last run, joined by the digests of what they read and made.
//!
//! Nothing is recorded for this beside the cache itself. An input of a unit is an output of another one if their digests agree, and a raw
//! file if no unit made it, so that an ancestry is what the keys say and no second opinion.

use crate::cache::STATE;
use crate::materialize::{PROVENANCE, SESSIONS};
use crate::stages::clean::READINGS;
use crate::stages::normalize::ROWS;
use crate::stages::{LIST, NAMES, ingest};
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_base::names::{file_name, plain_path};
use pipeline_cache::store::{Entry, Store};
use pipeline_cache::{Left, State};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A unit of the last run.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Place of its stage in [`NAMES`].
    pub stage: usize,
    /// Session, group or report.
    pub name: String,
    /// Key of its computation.
    pub key: Digest,
    /// What it read and made.
    pub entry: Entry,
    /// The units whose outputs it read, by their places.
    pub from: BTreeSet<usize>,
    /// Inputs that no unit made, by name: raw files, descriptions.
    pub given: BTreeMap<String, Digest>,
}

/// `provenance.json`.
#[derive(Debug, Default, Deserialize)]
pub struct Provenance {
    /// By session, the digests of its raw files by their paths from its folder.
    pub sessions: BTreeMap<String, BTreeMap<String, Digest>>,
}

impl Unit {
    /// Name of its stage.
    pub fn stage_name(&self) -> &'static str {
        NAMES[self.stage]
    }

    /// Whether its stage reads raw logs.
    pub fn reads_raw(&self) -> bool {
        LIST[self.stage].reads_raw()
    }
}

/// The units of the last run, in the order of stages and names.
#[derive(Clone, Debug, Default)]
pub struct Ancestry {
    /// All of them.
    pub units: Vec<Unit>,
}

impl Ancestry {
    /// What the last run on `derived/` left.
    ///
    /// # Errors
    /// Nothing has been run there, or an entry is no longer there.
    pub fn load(derived: &Path) -> Result<Self> {
        let store = Store::new(&derived.join("cache"));
        let state: State = store.read_aside(STATE);
        if state.is_empty() {
            let place = derived.display();
            return Err(Error::Usage(format!(
                "nothing has been run in {place} yet; `pipeline run` does, and --derived DIR names another place"
            )));
        }
        let mut units = Vec::with_capacity(state.len());
        for (name, Left { key, .. }) in state {
            let (stage, unit) = name.split_once('/').unwrap_or((name.as_str(), ""));
            let Some(stage) = NAMES.iter().position(|s| *s == stage) else {
                continue;
            };
            let entry = store.recorded(&key).ok_or_else(|| {
                Error::Usage(format!(
                    "the cache entry of {name} is no longer there; `pipeline run` computes it again"
                ))
            })?;
            units.push(Unit {
                stage,
                name: unit.to_owned(),
                key,
                entry,
                from: BTreeSet::new(),
                given: BTreeMap::new(),
            });
        }
        units.sort_by(|a, b| (a.stage, &a.name).cmp(&(b.stage, &b.name)));
        let mut ancestry = Ancestry { units };
        ancestry.join();
        Ok(ancestry)
    }

    /// Finds out which unit made which input.
    fn join(&mut self) {
        let mut made: BTreeMap<Digest, Vec<usize>> = BTreeMap::new();
        for (k, unit) in self.units.iter().enumerate() {
            let outputs = unit.entry.outputs.values().map(|o| o.digest.clone());
            for digest in outputs.chain([unit.entry.digest()]) {
                made.entry(digest).or_default().push(k);
            }
        }
        for k in 0..self.units.len() {
            let (mut from, mut given) = (BTreeSet::new(), BTreeMap::new());
            for (name, digest) in &self.units[k].entry.parts.inputs {
                let makers = made.get(digest).map_or(&[][..], Vec::as_slice);
                match self.maker(k, name, makers) {
                    Some(maker) => {
                        from.insert(maker);
                    }
                    None => {
                        given.insert(name.clone(), digest.clone());
                    }
                }
            }
            self.units[k].from = from;
            self.units[k].given = given;
        }
    }

    /// Of the units that made something with an input's digest (equal results have one), the one that the input's name means: the same unit
    /// in an earlier stage, or one whose name stands in it.
    fn maker(&self, reader: usize, input: &str, makers: &[usize]) -> Option<usize> {
        let reader = &self.units[reader];
        let meant = |k: usize| {
            let maker = &self.units[k];
            (
                maker.stage < reader.stage,
                maker.name == reader.name || input.contains(&maker.name),
                input.contains(maker.stage_name()),
                maker.stage,
            )
        };
        let best = makers.iter().copied().max_by_key(|k| meant(*k))?;
        (self.units[best].stage < reader.stage).then_some(best)
    }

    /// Raw files that some units read, each once by its path below the raw directory, with their digests as the run wrote them down in `reports`:
    /// the key of a session has what its description says and not the digest of that file. Where that list is not there, what the keys have.
    pub fn raw_files<'a>(
        &self,
        units: impl Iterator<Item = &'a Unit>,
        reports: &Path,
    ) -> BTreeMap<String, String> {
        let text = std::fs::read_to_string(reports.join(PROVENANCE)).unwrap_or_default();
        let written: Provenance = serde_json::from_str(&text).unwrap_or_default();
        let ingest = units.filter(|u| u.reads_raw());
        let of_unit = |u: &Unit| {
            let options = &u.entry.parts.options;
            let folder = options.get("folder").map_or("", String::as_str);
            let file = |(name, digest): (&String, &Digest)| {
                let path = format!("{folder}/{name}");
                let path = plain_path(Path::new(&path)).unwrap_or(path);
                (path, digest.hex().to_owned())
            };
            let files = written.sessions.get(&u.name).unwrap_or(&u.given);
            files.iter().map(file).collect::<Vec<_>>()
        };
        ingest.flat_map(of_unit).collect()
    }

    /// Units on which some units depend, themselves included.
    pub fn upstream(&self, of: impl IntoIterator<Item = usize>) -> BTreeSet<usize> {
        let mut all = BTreeSet::new();
        let mut open: Vec<usize> = of.into_iter().collect();
        while let Some(k) = open.pop() {
            if all.insert(k) {
                open.extend(self.units[k].from.iter().copied());
            }
        }
        all
    }

    /// The unit and the output that an artifact is: a file below `reports/` or `derived/` as people name it, with or without folders before
    /// it, or a unit.
    ///
    /// # Errors
    /// No artifact has that name, or several have.
    pub fn find(&self, artifact: &str) -> Result<(usize, Option<String>)> {
        let artifact = artifact.trim_start_matches("./");
        if let Some(unit) = self.of_session(artifact) {
            return Ok((unit, None));
        }
        let mut found = self.outputs_called(artifact);
        if found.len() > 1 && !artifact.contains('.') {
            // A bare name means the table as data: every table has four formats.
            found.retain(|(_, n)| {
                n.as_ref()
                    .is_some_and(|n| n.ends_with(".csv") || n.ends_with(".svg"))
            });
        }
        let is_table =
            |(_, n): &(usize, Option<String>)| n.as_ref().is_some_and(|n| n.contains("/tables/"));
        if found.len() > 1 && found.iter().filter(|f| is_table(f)).count() == 1 {
            // A figure's data may have the name of a table.
            found.retain(is_table);
        }
        if found.is_empty() {
            found.extend(self.unit_called(artifact).map(|k| (k, None)));
        }
        match found.len() {
            1 => Ok(found.swap_remove(0)),
            0 => Err(Error::Usage(self.no_such(artifact))),
            n => {
                let names: Vec<&str> = found
                    .iter()
                    .filter_map(|(_, n)| n.as_deref())
                    .take(5)
                    .collect();
                Err(Error::Usage(format!(
                    "{n} artifacts are called {artifact}: {}; give more of the path",
                    names.join(", ")
                )))
            }
        }
    }

    /// The outputs that people keep, below `reports/` or `derived/`, that have a name.
    fn outputs_called(&self, artifact: &str) -> Vec<(usize, Option<String>)> {
        let mut found: Vec<(usize, Option<String>)> = Vec::new();
        // People may keep reports and derived data in folders of other names.
        let below = |name: &str| name.split_once('/').map_or("", |(_, rest)| rest).to_owned();
        let ends = |name: &str| {
            name == artifact
                || artifact
                    .strip_suffix(&below(name))
                    .is_some_and(|rest| rest.ends_with('/'))
                || name
                    .strip_suffix(artifact)
                    .is_some_and(|rest| rest.ends_with('/'))
                || artifact
                    .strip_suffix(name)
                    .is_some_and(|rest| rest.ends_with('/'))
        };
        for (k, unit) in self.units.iter().enumerate() {
            let in_place =
                |name: &&String| name.starts_with("reports/") || name.starts_with("derived/");
            let outputs = unit.entry.outputs.keys().filter(in_place);
            let called = outputs.filter(|n| ends(n) || stem(n) == artifact);
            found.extend(called.map(|n| (k, Some(n.clone()))));
        }
        found
    }

    /// The last unit that has a name, with or without that of its stage.
    fn unit_called(&self, artifact: &str) -> Option<usize> {
        // The units of a campaign have its diameter behind its name.
        let is_of_campaign = |unit: &Unit| {
            let rest = unit.name.strip_prefix(artifact);
            rest.is_some_and(|rest| rest.starts_with(' ') && rest.ends_with(" mm"))
        };
        let is_named = |unit: &Unit| {
            unit.name == artifact
                || format!("{} {}", unit.stage_name(), unit.name) == artifact
                || is_of_campaign(unit)
        };
        let mut named = (0..self.units.len()).filter(|k| is_named(&self.units[*k]));
        named.next_back()
    }

    /// The unit that made a file of `derived/sessions/<id>/`.
    fn of_session(&self, artifact: &str) -> Option<usize> {
        let mut parts = artifact.split('/').skip_while(|part| *part != SESSIONS);
        let (_, folder, file) = (parts.next()?, parts.next()?, parts.next());
        let stage = match file {
            None => ROWS.stage,
            Some(file) if file == ROWS.name => ROWS.stage,
            Some(file) if file == READINGS.name => READINGS.stage,
            Some(_) => ingest::NAME,
        };
        let made = |u: &Unit| u.stage_name() == stage && file_name(&u.name) == folder;
        self.units.iter().position(made)
    }

    fn no_such(&self, artifact: &str) -> String {
        let all = self.units.iter().flat_map(|u| u.entry.outputs.keys());
        let names: BTreeSet<&str> = all.filter_map(|n| n.rsplit('/').next()).collect();
        let file = artifact.rsplit('/').next().unwrap_or(artifact);
        let hint = pipeline_base::diagnostics::nearest(file, names.iter().copied())
            .map_or_else(String::new, |near| format!("; did you mean {near}?"));
        format!(
            "the last run made no {artifact}; give a file below reports/, such as tables/coefficients.csv, or a session or campaign{hint}"
        )
    }
}

/// The file name without folders and ending.
pub fn stem(name: &str) -> &str {
    let file = name.rsplit('/').next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}
