//! Finding sessions: every folder below a raw directory that holds a `session.toml`, in sorted order.

use crate::session_toml::CAMPAIGN_FILE;
use crate::{leg, session_toml, shared_logs, unnamed_logs};
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::session::{LogSpec, Session, Specimen};
use pipeline_base::toml_reader::line_of_key;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// The file that makes a folder a session.
pub const SESSION_FILE: &str = "session.toml";

/// The largest `session.toml` that is read, bytes.
const LARGEST_SESSION_FILE: u64 = 1 << 20;

/// A session on disk.
#[derive(Clone, Debug)]
pub struct Located {
    /// The checked contents of `session.toml`.
    pub session: Session,
    /// The folder.
    pub directory: PathBuf,
    /// The folder relative to its raw directory, with forward slashes.
    pub relative: String,
    /// The `campaign.toml` that completes it, relative to the folder, if there is one.
    pub campaign: Option<String>,
}

impl Located {
    /// Every file that is read of the session, relative to its folder: its description and what completes it, the leg, the logs.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        let session = &self.session;
        let described = session.joint.iter().filter_map(|j| j.description.as_ref());
        [SESSION_FILE]
            .into_iter()
            .chain(self.campaign.as_deref())
            .chain(described.map(|d| d.file.as_str()))
            .chain(session.logs.iter().map(|log| log.file.as_str()))
    }

    /// Whether one of its logs is not there.
    pub fn lacks(&self, log: &LogSpec) -> bool {
        !self.directory.join(&log.file).exists()
    }
}

/// A session that cannot be used, with every reason.
#[derive(Clone, Debug)]
pub struct Unusable {
    /// The folder relative to its raw directory.
    pub relative: String,
    /// Why.
    pub diagnostics: Vec<Diagnostic>,
}

/// What lies below the raw directories.
#[derive(Clone, Debug, Default)]
pub struct Discovery {
    /// Usable sessions, sorted by id.
    pub sessions: Vec<Located>,
    /// Unusable ones, sorted by folder.
    pub unusable: Vec<Unusable>,
    /// What is wrong with the tree itself: unreadable folders, loops of links, contradictions between sessions.
    pub diagnostics: Vec<Diagnostic>,
}

/// Walks the raw directories and reads every `session.toml`. Links are followed; a loop of links is reported and not entered.
pub fn discover(roots: &[PathBuf]) -> Discovery {
    let mut found = Discovery::default();
    let mut seen = BTreeSet::new();
    let mut others = Vec::new();
    for root in roots {
        let folders = walk(root, &mut seen, &mut others, &mut found);
        let read = folders.par_iter().map(|folder| read_session(root, folder));
        for session in read.collect::<Vec<_>>() {
            match session {
                Ok(located) => found.sessions.push(located),
                Err(unusable) => found.unusable.push(unusable),
            }
        }
    }
    unnamed_logs::note(&mut found, others);
    reject_duplicates(&mut found);
    shared_logs::reject(&mut found);
    note_contradictions(&mut found);
    found
        .sessions
        .sort_by(|a, b| a.session.id.cmp(&b.session.id));
    found
}

/// The folders that hold a session. Files that describe nothing go to `others`, each with the name of its folder in messages.
fn walk(
    root: &Path,
    seen: &mut BTreeSet<PathBuf>,
    others: &mut Vec<(PathBuf, String)>,
    found: &mut Discovery,
) -> Vec<PathBuf> {
    let mut folders = Vec::new();
    let entries = WalkDir::new(root).follow_links(true).sort_by_file_name();
    for entry in entries {
        match entry {
            Ok(entry) if entry.file_name() == SESSION_FILE && entry.file_type().is_file() => {
                let directory = entry.path().parent().unwrap_or(root);
                let canonical = directory
                    .canonicalize()
                    .unwrap_or_else(|_| directory.to_path_buf());
                // A directory that is given twice, or inside another, is read once.
                if seen.insert(canonical) {
                    folders.push(directory.to_path_buf());
                }
            }
            Ok(entry) if entry.file_name() == SESSION_FILE => {
                found.unusable.push(not_a_file(root, entry.path()));
            }
            Ok(entry) if entry.file_name() == CAMPAIGN_FILE => {}
            Ok(entry) if entry.file_type().is_file() => {
                let folder = relative_to(root, entry.path().parent().unwrap_or(root));
                others.push((entry.into_path(), folder));
            }
            Ok(_) => {}
            Err(error) => found.diagnostics.push(unreadable_entry(root, &error)),
        }
    }
    folders
}

fn not_a_file(root: &Path, path: &Path) -> Unusable {
    let relative = relative_to(root, path);
    Unusable {
        diagnostics: vec![Diagnostic::error(
            relative.clone(),
            "something that is not a file",
            "a file that describes the session",
            "replace it by a session.toml",
        )],
        relative,
    }
}

fn unreadable_entry(root: &Path, error: &walkdir::Error) -> Diagnostic {
    let path = error.path().unwrap_or(root);
    let (what, hint) = match (error.loop_ancestor(), error.io_error()) {
        (Some(_), _) => (
            "a link to a folder above itself".to_owned(),
            "remove the link; it was not entered",
        ),
        (None, Some(io)) => (
            format!("\"{}\"", io.kind()),
            "give yourself permission to read it; its contents were not read",
        ),
        (None, None) => ("an unreadable entry".to_owned(), "look at it"),
    };
    Diagnostic::error(
        relative_to(root, path),
        what,
        "a readable file or folder",
        hint,
    )
    .with_severity(Severity::Warning)
}

/// `path` relative to `root` with forward slashes; "." for the root itself.
fn relative_to(root: &Path, path: &Path) -> String {
    let relative = path.strip_prefix(root).unwrap_or(path);
    let parts: Vec<String> = relative
        .components()
        .map(|c| c.as_os_str().to_string_lossy().into_owned())
        .collect();
    if parts.is_empty() {
        ".".to_owned()
    } else {
        parts.join("/")
    }
}

fn read_session(root: &Path, directory: &Path) -> Result<Located, Unusable> {
    let relative = relative_to(root, directory);
    let file = format!("{relative}/{SESSION_FILE}");
    let campaign = campaign_of(root, directory);
    let described = || {
        let text = read_text(&directory.join(SESSION_FILE), &file)?;
        let campaign = campaign.as_ref().map(|folder| {
            let path = folder.join(CAMPAIGN_FILE);
            let shown = relative_to(root, &path);
            Ok((read_text(&path, &shown)?, shown))
        });
        Ok((text, campaign.transpose()?))
    };
    let session = described()
        .map_err(|d: Diagnostic| vec![d])
        .and_then(|(text, campaign)| match campaign {
            None => session_toml::read(&file, &text),
            Some((campaign, shown)) => session_toml::read_over((&file, &text), (&shown, &campaign)),
        })
        .and_then(|session| leg::complete(session, directory, &relative));
    match session {
        Ok(session) => Ok(Located {
            session,
            directory: directory.to_path_buf(),
            relative,
            campaign: campaign.map(|folder| from_below(directory, folder)),
        }),
        Err(diagnostics) => Err(Unusable {
            relative,
            diagnostics,
        }),
    }
}

/// The nearest folder with a `campaign.toml`: that of the session, or one above it up to the raw directory.
fn campaign_of<'a>(root: &Path, directory: &'a Path) -> Option<&'a Path> {
    let mut above = directory.ancestors().take_while(|a| a.starts_with(root));
    above.find(|folder| folder.join(CAMPAIGN_FILE).is_file())
}

/// The path of the `campaign.toml` of a folder above, seen from a session's folder.
fn from_below(directory: &Path, folder: &Path) -> String {
    let below = directory.strip_prefix(folder).unwrap_or(Path::new(""));
    "../".repeat(below.components().count()) + CAMPAIGN_FILE
}

/// The text of a small file that describes something; messages call it `file`.
pub(super) fn read_text(path: &Path, file: &str) -> Result<String, Diagnostic> {
    let fail =
        |found: String, hint: &str| Diagnostic::error(file, found, "a readable TOML file", hint);
    let unread = |e: std::io::Error| match e.kind() {
        ErrorKind::NotFound => fail(
            "no such file".to_owned(),
            "put it beside session.toml, or correct its name",
        ),
        kind => fail(format!("\"{kind}\""), "give yourself permission to read it"),
    };
    let size = std::fs::metadata(path).map_err(unread)?.len();
    if size > LARGEST_SESSION_FILE {
        return Err(fail(
            format!("{size} bytes"),
            "a session.toml holds a description, not data",
        ));
    }
    let bytes = std::fs::read(path).map_err(unread)?;
    String::from_utf8(bytes).map_err(|e| {
        let offset = e.utf8_error().valid_up_to();
        let row = 1 + e.as_bytes()[..offset]
            .iter()
            .filter(|b| **b == b'\n')
            .count();
        fail(
            "bytes that are not UTF-8".to_owned(),
            "save the file as UTF-8",
        )
        .at_row(row as u64)
    })
}

/// Of sessions with one id the first in path order stays; the others are unusable.
fn reject_duplicates(found: &mut Discovery) {
    let mut first: BTreeMap<String, String> = BTreeMap::new();
    let mut kept = Vec::with_capacity(found.sessions.len());
    for located in found.sessions.drain(..) {
        let id = located.session.id.clone();
        match first.get(&id) {
            None => {
                first.insert(id, located.relative.clone());
                kept.push(located);
            }
            Some(other) => found.unusable.push(Unusable {
                diagnostics: vec![taken(&located, other)],
                relative: located.relative,
            }),
        }
    }
    found.sessions = kept;
    found.unusable.sort_by(|a, b| a.relative.cmp(&b.relative));
}

/// The id of a session is that of another one.
fn taken(located: &Located, other: &str) -> Diagnostic {
    let file = format!("{}/{SESSION_FILE}", located.relative);
    let diagnostic = Diagnostic::error(
        file.clone(),
        format!(
            "\"{}\", which is the id of {other}/{SESSION_FILE}",
            located.session.id
        ),
        "an id that no other session has",
        "give one of the two sessions another id",
    )
    .in_column("id");
    let text = read_text(&located.directory.join(SESSION_FILE), &file).unwrap_or_default();
    match line_of_key(&text, "id") {
        Some(line) => diagnostic.at_row(line),
        None => diagnostic,
    }
}

/// A length of a specimen with its declared standard deviation.
type Length = fn(&Specimen) -> (f64, Option<f64>);
const REST: Length = |s| (s.rest_length_m, s.rest_length_sd_m);
const CONTRACTED: Length = |s| (s.contracted_length_m, s.contracted_length_sd_m);

/// A length in words; its standard deviation only where the other description has another one.
fn length(specimen: &Specimen, other: &Specimen, of: Length) -> String {
    let ((length, sd), (_, others)) = (of(specimen), of(other));
    match sd {
        _ if sd == others => format!("{length:.4} m"),
        Some(sd) => format!("{length:.4} m (standard deviation {:.3} mm)", 1e3 * sd),
        None => format!("{length:.4} m (standard deviation not declared)"),
    }
}

/// One specimen described in two ways is worth a note; the lengths may have been measured twice.
fn note_contradictions(found: &mut Discovery) {
    let mut first: BTreeMap<&str, &Located> = BTreeMap::new();
    for located in &found.sessions {
        let specimen = &located.session.specimen;
        let seen = first.entry(&specimen.id).or_insert(located);
        let other = &seen.session.specimen;
        if other != specimen {
            found.diagnostics.push(
                Diagnostic::error(
                    format!("{}/{SESSION_FILE}", located.relative),
                    format!(
                        "specimen \"{}\" with diameter {} mm, l_rest {}, l_620 {}",
                        specimen.id,
                        specimen.diameter_mm,
                        length(specimen, other, REST),
                        length(specimen, other, CONTRACTED),
                    ),
                    format!(
                        "{} mm, {}, {} as in {}/{SESSION_FILE}",
                        other.diameter_mm,
                        length(other, specimen, REST),
                        length(other, specimen, CONTRACTED),
                        seen.relative
                    ),
                    "correct one of them, or give the second actuator its own id",
                )
                .with_severity(Severity::Warning)
                .in_column("specimen"),
            );
        }
    }
}
