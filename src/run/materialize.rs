//! Puts outputs where people look for them: reports, tables and figures below `reports/`, tidy data below `derived/`.
//!
//! A file is written only where its contents differ, so that time stamps tell what changed. A file that an earlier run wrote and this
//! one does not is removed, unless somebody has changed it since.

use crate::RunOptions;
use crate::engine::Engine;
use crate::made::UnitMade;
use crate::stages::clean::READINGS;
use crate::stages::ingest;
use crate::stages::normalize::ROWS;
use crate::step::Step;
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_base::names::file_name;
use pipeline_cache::store::{Object, UNFINISHED, write_atomically};
use pipeline_formats::discover::{Discovery, SESSION_FILE};
use pipeline_report::left_out::LeftOut;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Files put in place.
#[derive(Debug, Default)]
pub struct Written {
    /// Those that differed.
    pub changed: Vec<PathBuf>,
    /// The reports.
    pub pdfs: Vec<PathBuf>,
    /// The findings.
    pub findings: Option<PathBuf>,
    /// Figures and documents that could not be built.
    pub left_out: Vec<LeftOut>,
}

/// Folder of the sessions' tidy data, below `derived/`.
pub const SESSIONS: &str = "sessions";
/// The tables of a session beside its logs: stage and name.
const TIDY: [(&str, &str); 2] = [(READINGS.stage, READINGS.name), (ROWS.stage, ROWS.name)];
const DERIVED: &str = "derived/";
const REPORTS: &str = "reports/";
const FINDINGS: &str = "reports/findings.json";
const LIST: &str = "materialized.jsonl";
/// Digests of raw files, below `reports/`.
pub const PROVENANCE: &str = "provenance.json";

/// `reports/` and the tidy part of `derived/`, brought in line with the results unit by unit; a dry run only says which files differ.
pub struct Shelf<'a> {
    engine: &'a Engine,
    options: &'a RunOptions,
    written: Written,
    present: BTreeMap<String, Digest>,
}

impl<'a> Shelf<'a> {
    /// Nothing is put in place yet.
    pub fn new(engine: &'a Engine, options: &'a RunOptions) -> Self {
        Self {
            engine,
            options,
            written: Written::default(),
            present: BTreeMap::new(),
        }
    }

    /// Puts the outputs of one step in place.
    ///
    /// # Errors
    /// A file cannot be written; a stored result is damaged.
    pub fn put(&mut self, step: &Step) -> Result<()> {
        let entry = step
            .entry()
            .ok_or_else(|| Error::internal("a report without outputs"))?;
        for (name, object) in &entry.outputs {
            let Some(path) = place(name, self.options) else {
                continue;
            };
            let read = || self.engine.read(step, name);
            let differs = write(
                self.engine,
                name,
                (&path, &object.digest),
                read,
                self.options,
            )?;
            self.note(name, path, differs, &object.digest);
        }
        Ok(())
    }

    /// Puts in place the outputs of the sessions, and where it comes from.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn put_sessions(&mut self, sessions: &[UnitMade], discovery: &Discovery) -> Result<()> {
        let (engine, options) = (self.engine, self.options);
        let raw = raw_files(engine, sessions, discovery)?;
        let path = options.reports.join(PROVENANCE);
        let (name, digest) = (format!("{REPORTS}{PROVENANCE}"), Digest::of(&raw));
        let differs = write(engine, &name, (&path, &digest), || Ok(raw), options)?;
        self.note(&name, path, differs, &digest);
        self.link_sessions(sessions)
    }

    /// Puts in place the tidy data of the sessions that are up to date.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn link_sessions(&mut self, sessions: &[UnitMade]) -> Result<()> {
        let (engine, options) = (self.engine, self.options);
        let linked = sessions.par_iter().map(|session| {
            let folder = session_folder(&session.unit.name, options);
            let is_other = link_session(engine, session, &folder, options.dry_run)?;
            Ok(is_other.then_some(folder))
        });
        let linked: Vec<Option<PathBuf>> = linked.collect::<Result<_>>()?;
        self.written.changed.extend(linked.into_iter().flatten());
        Ok(())
    }

    /// Notes what stands there now.
    fn note(&mut self, name: &str, path: PathBuf, differs: bool, digest: &Digest) {
        if differs {
            self.written.changed.push(path.clone());
        }
        let is_report = name
            .strip_prefix(REPORTS)
            .is_some_and(|n| n.ends_with(".pdf") && !n.contains('/'));
        if is_report {
            self.written.pdfs.push(path);
        } else if name == FINDINGS {
            self.written.findings = Some(path);
        }
        self.present.insert(name.to_owned(), digest.clone());
    }

    /// Writes down which files are in place so far beside those of the last run: should the run end here, the next one knows them as its own.
    ///
    /// # Errors
    /// The list cannot be written.
    pub fn remember(&self) -> Result<()> {
        let before: BTreeMap<String, Digest> = self.engine.read_aside(LIST);
        let mut all = before.clone();
        all.extend(self.present.clone());
        if self.options.dry_run || all == before {
            return Ok(());
        }
        self.engine.write_aside(LIST, &all)
    }

    /// Everything is in place: what earlier runs left beside it goes.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn finish(self, sessions: &[UnitMade]) -> Result<Written> {
        let (engine, options) = (self.engine, self.options);
        if !options.dry_run {
            remove_sessions(sessions, options);
            remove_stale(engine, &self.present, options)?;
            remove_unfinished(&self.present, options);
        }
        Ok(self.written)
    }

    /// What is in place, where the rest could not be made: nothing is removed. A dry run also looks for what the last run left and is not there any
    /// more, or was changed since: it comes back whatever else is to be computed.
    pub fn unfinished(mut self) -> Written {
        if self.options.dry_run {
            let before: BTreeMap<String, Digest> = self.engine.read_aside(LIST);
            let others = before
                .iter()
                .filter(|(n, _)| !self.present.contains_key(*n));
            let lost = others.filter_map(|(name, digest)| {
                let path = place(name, self.options)?;
                (!stands(self.engine, name, &path, digest)).then_some(path)
            });
            let lost: Vec<PathBuf> = lost.collect();
            self.written.changed.extend(lost);
        }
        self.written
    }
}

/// Writes a file whose contents differ, and says whether they did.
fn write(
    engine: &Engine,
    name: &str,
    (path, digest): (&Path, &Digest),
    bytes: impl FnOnce() -> Result<Vec<u8>>,
    options: &RunOptions,
) -> Result<bool> {
    let differs = !stands(engine, name, path, digest);
    if differs && !options.dry_run {
        write_atomically(path, &bytes()?)?;
    }
    Ok(differs)
}

/// `reports/provenance.json`: the SHA-256 of every raw file, by session. It stands outside of the report stage, because a raw file may change
/// without a change of any number.
fn raw_files(engine: &Engine, sessions: &[UnitMade], discovery: &Discovery) -> Result<Vec<u8>> {
    let mut files: BTreeMap<&str, BTreeMap<String, Digest>> = BTreeMap::new();
    for (result, located) in sessions.iter().zip(&discovery.sessions) {
        let Some(entry) = result.step(ingest::NAME).and_then(Step::entry) else {
            continue;
        };
        let mut digests = entry.parts.inputs.clone();
        // Its key has what the description says, not how; here stand the files.
        digests.remove(SESSION_FILE);
        let leg = located.session.joint.as_ref();
        let leg = leg.and_then(|joint| Some(joint.description.as_ref()?.file.as_str()));
        let campaign = located.campaign.as_deref();
        for name in [SESSION_FILE].into_iter().chain(campaign).chain(leg) {
            let path = located.directory.join(name);
            let found = engine
                .hashes
                .digest(&format!("{}:{name}", result.unit.name), &path);
            digests.extend(found.ok().map(|(digest, _)| (name.to_owned(), digest)));
        }
        files.insert(&result.unit.name, digests);
    }
    let json = serde_json::json!({ "schema": "bpa-provenance/1", "sessions": files });
    let mut bytes = serde_json::to_vec_pretty(&json).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Whether a file is in place with these contents; one that is as old as when it was last hashed is not read.
fn stands(engine: &Engine, name: &str, path: &Path, digest: &Digest) -> bool {
    let found = engine.hashes.digest(name, path);
    found.is_ok_and(|(found, _)| found == *digest)
}

fn place(name: &str, options: &RunOptions) -> Option<PathBuf> {
    match (name.strip_prefix(REPORTS), name.strip_prefix(DERIVED)) {
        (Some(rest), _) => Some(options.reports.join(rest)),
        (_, Some(rest)) => Some(options.derived.join(rest)),
        _ => None,
    }
}

fn remove_stale(
    engine: &Engine,
    present: &BTreeMap<String, Digest>,
    options: &RunOptions,
) -> Result<()> {
    let before: BTreeMap<String, Digest> = engine.read_aside(LIST);
    for (name, digest) in before
        .iter()
        .filter(|(name, _)| !present.contains_key(*name))
    {
        if let Some(path) = place(name, options)
            && stands(engine, name, &path, digest)
        {
            std::fs::remove_file(&path).map_err(Error::io("remove", &path))?;
        }
    }
    if before != *present {
        engine.write_aside(LIST, present)?;
    }
    Ok(())
}

/// Removes what a killed run has begun to write. A file that cannot be removed hurts nobody.
fn remove_unfinished(present: &BTreeMap<String, Digest>, options: &RunOptions) {
    let places = present.keys().filter_map(|name| place(name, options));
    let folders: BTreeSet<PathBuf> = places
        .filter_map(|path| path.parent().map(Path::to_path_buf))
        .collect();
    for folder in folders {
        let files = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let begun = files.filter(|f| f.file_name().to_string_lossy().starts_with(UNFINISHED));
        for file in begun {
            let _ = std::fs::remove_file(file.path());
        }
    }
}

fn session_folder(id: &str, options: &RunOptions) -> PathBuf {
    options.derived.join(SESSIONS).join(file_name(id))
}

/// `derived/sessions/<id>/`: the calibrated logs, the readings and the normalised rows of one session, as links to the cache's objects
/// (copies where the file system has no links). Whether something was missing or other; `only_look` leaves it so.
fn link_session(
    engine: &Engine,
    session: &UnitMade,
    folder: &Path,
    only_look: bool,
) -> Result<bool> {
    if !session.is_whole() {
        return Ok(false);
    }
    let outputs = |stage| {
        let entry = session.step(stage).and_then(Step::entry);
        entry.into_iter().flat_map(|entry| &entry.outputs)
    };
    let logs = outputs(ingest::NAME).filter(|(name, _)| name.ends_with(".parquet"));
    let mut links: Vec<(PathBuf, &Object)> = logs
        .map(|(name, object)| (folder.join("logs").join(name), object))
        .collect();
    for (stage, name) in TIDY {
        let tidy = outputs(stage).filter(|(output, _)| *output == name);
        links.extend(tidy.map(|(_, object)| (folder.join(name), object)));
    }
    let mut is_other = false;
    for (path, object) in &links {
        let place = engine.object_path(object);
        let below = path.strip_prefix(folder).unwrap_or(path).display();
        let name = || format!("{SESSIONS}/{}/{below}", session.unit.name);
        // What was copied from another place has the contents and is no link.
        if same_file(&place, path, object.size) || stands(engine, &name(), path, &object.digest) {
            continue;
        }
        is_other = true;
        if !only_look {
            link(&place, path)?;
        }
    }
    let wanted: BTreeSet<&Path> = links.iter().map(|(path, _)| path.as_path()).collect();
    for path in files_of_session(folder).filter(|path| !wanted.contains(path.as_path())) {
        is_other = true;
        if !only_look {
            std::fs::remove_file(&path).map_err(Error::io("remove", &path))?;
        }
    }
    Ok(is_other)
}

/// The files in a session's folder that have names as a run gives them.
fn files_of_session(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let logs = std::fs::read_dir(folder.join("logs")).into_iter().flatten();
    let logs = logs.flatten().map(|entry| entry.path()).filter(|path| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_number = !stem.is_empty() && stem.bytes().all(|b| b.is_ascii_digit());
        is_number && path.extension().is_some_and(|e| e == "parquet")
    });
    let others = TIDY.map(|(_, name)| folder.join(name));
    logs.chain(others.into_iter().filter(|path| path.exists()))
}

/// Removes what earlier runs put into the folders of sessions that are no longer there. What somebody else put there stays, and what cannot
/// be removed hurts nobody.
fn remove_sessions(sessions: &[UnitMade], options: &RunOptions) {
    let known: BTreeSet<PathBuf> = sessions
        .iter()
        .map(|session| session_folder(&session.unit.name, options))
        .collect();
    let folders = std::fs::read_dir(options.derived.join(SESSIONS));
    let folders = folders.into_iter().flatten().flatten().map(|f| f.path());
    for folder in folders.filter(|folder| !known.contains(folder)) {
        for file in files_of_session(&folder) {
            let _ = std::fs::remove_file(file);
        }
        let _ = std::fs::remove_dir(folder.join("logs"));
        let _ = std::fs::remove_dir(folder);
    }
}

fn link(object: &Path, path: &Path) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    let _ = std::fs::remove_file(path);
    if std::fs::hard_link(object, path).is_ok() {
        return Ok(());
    }
    let bytes = std::fs::read(object).map_err(Error::io("read", object))?;
    write_atomically(path, &bytes)
}

#[cfg(unix)]
fn same_file(a: &Path, b: &Path, _size: u64) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (std::fs::metadata(a), std::fs::metadata(b)) {
        (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn same_file(_a: &Path, b: &Path, size: u64) -> bool {
    std::fs::metadata(b).is_ok_and(|m| m.len() == size)
}
