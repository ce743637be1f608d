//! Logs that no session names: somebody recorded them and nothing reads them, which a run has to say.

use crate::dialect::{Dialect, is_number};
use crate::discover::Discovery;
use crate::{gzip, log_file};
use flate2::read::MultiGzDecoder;
use pipeline_base::diagnostics::{Diagnostic, Severity};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// How much of a file is looked at, bytes.
const HEAD: u64 = 4096;

/// A table of numbers has at least so many lines of them; notes hardly ever have.
const LINES_OF_NUMBERS: usize = 2;

/// How many names a message has.
const NAMES: usize = 3;

/// Notes the files below the raw directories that look like logs and that no session names, a warning for each folder. Files beside a session
/// that cannot be used are left alone: what it names is not known.
///
/// `files` are all files but descriptions, each with the name of its folder in messages.
pub fn note(found: &mut Discovery, files: Vec<(PathBuf, String)>) {
    let named: BTreeSet<PathBuf> = found
        .sessions
        .iter()
        .flat_map(|s| s.files().map(|file| without_dots(&s.directory.join(file))))
        .collect();
    let unread: BTreeSet<String> = found.unusable.iter().map(|u| u.relative.clone()).collect();
    let mut unnamed: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, folder) in files {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
        let Some(name) = name.filter(|n| !n.starts_with(['.', '~'])) else {
            continue;
        };
        if !unread.contains(&folder) && !named.contains(&without_dots(&path)) && is_log(&path) {
            unnamed.entry(folder).or_default().insert(name);
        }
    }
    let has_session: BTreeSet<&str> = found.sessions.iter().map(|s| s.relative.as_str()).collect();
    let warnings = unnamed.into_iter().map(|(folder, names)| {
        let hint = if has_session.contains(folder.as_str()) {
            "add a [[log]] for each to session.toml, or move them elsewhere"
        } else {
            "write a session.toml beside them (`pipeline new-session` drafts one), or move them elsewhere"
        };
        Diagnostic::error(
            folder,
            format!("{}, which no session names", listed(&names)),
            "logs that a session names",
            format!("{hint}; they were not read"),
        )
        .with_severity(Severity::Warning)
    });
    let warnings: Vec<Diagnostic> = warnings.collect();
    found.diagnostics.extend(warnings);
}

fn listed(names: &BTreeSet<String>) -> String {
    let first: Vec<&str> = names.iter().take(NAMES).map(String::as_str).collect();
    let first = first.join(", ");
    match names.len().saturating_sub(NAMES) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// A path whose `..` and `.` are resolved by its words: sessions share zero logs as `../zero.csv`.
fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(plain.components().next_back(), Some(Component::Normal(_))) =>
            {
                plain.pop();
            }
            part => plain.push(part),
        }
    }
    plain
}

/// Whether a file looks like a log: a format that is no text, or lines of numbers.
fn is_log(path: &Path) -> bool {
    let Ok(mut bytes) = head(path) else {
        return false;
    };
    if gzip::is_compressed(&bytes) {
        let mut plain = Vec::new();
        // The end was cut off, which is an error: what comes before it is enough.
        let _cut = MultiGzDecoder::new(&bytes[..])
            .take(HEAD)
            .read_to_end(&mut plain);
        bytes = plain;
    }
    log_file::is_known_binary(&bytes) || has_numbers(&bytes)
}

fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(head)
}

/// Whether lines of a text are rows of numbers.
fn has_numbers(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let dialect = Dialect::of(&text);
    let is_row = |line: &&str| {
        let cells = || line.split(dialect.separator);
        let numbers = cells().filter(|c| is_number(c.trim(), dialect.decimal_comma));
        let numbers = numbers.count();
        numbers > 1 && 2 * numbers >= cells().count()
    };
    text.lines().filter(is_row).count() >= LINES_OF_NUMBERS
}
