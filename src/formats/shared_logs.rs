//! One log under two sessions, or twice in one: its readings would count twice, once with the wrong lengths.
//!
//! Only logs of one size are read to be compared, so that a tree without such a mistake costs a look at the size of each file. Zero logs may be
//! shared: several sessions may stand between two of them.

use crate::discover::{Discovery, Located, SESSION_FILE, Unusable};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::digest::{self, Digest};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A log that measures, by its session's place.
struct Measured {
    session: usize,
    name: String,
    path: PathBuf,
}

/// Of sessions with one log the first in the order of ids stays; the others are unusable, and so is a session that has one log twice.
pub fn reject(found: &mut Discovery) {
    let mut of_size: BTreeMap<(u64, String), Vec<Measured>> = BTreeMap::new();
    for (session, located) in found.sessions.iter().enumerate() {
        for log in located.session.logs.iter().filter(|log| !log.is_zero) {
            let path = located.directory.join(&log.file);
            // A pipe would be read for ever, and of empty files each is reported by itself.
            let metadata = std::fs::metadata(&path);
            let Some(metadata) = metadata.ok().filter(|m| m.is_file() && m.len() > 0) else {
                continue;
            };
            let part = log.part.as_ref().map(|p| p.name.clone());
            let measured = Measured {
                session,
                name: log.name(),
                path,
            };
            let alike = of_size.entry((metadata.len(), part.unwrap_or_default()));
            alike.or_default().push(measured);
        }
    }
    let mut twice: BTreeMap<usize, Diagnostic> = BTreeMap::new();
    for alike in of_size.into_values().filter(|alike| alike.len() > 1) {
        twice.extend(repeated(&alike, &found.sessions));
    }
    take_out(found, twice);
}

/// The sessions of which a log is that of an earlier one.
fn repeated(alike: &[Measured], sessions: &[Located]) -> Vec<(usize, Diagnostic)> {
    let mut first: BTreeMap<Digest, &Measured> = BTreeMap::new();
    let mut repeated = Vec::new();
    for log in alike {
        let Ok(digest) = digest::of_file(&log.path) else {
            continue;
        };
        let Some(original) = first.get(&digest) else {
            first.insert(digest, log);
            continue;
        };
        let [own, other] = [log, *original].map(|l| &sessions[l.session].relative);
        let (found, expected, hint) = if original.session == log.session {
            (
                format!("{}, which is {} byte for byte", log.name, original.name),
                "a log that is named once",
                "remove one of the two, or name the right log",
            )
        } else {
            (
                format!(
                    "{}, which is {other}/{} byte for byte",
                    log.name, original.name
                ),
                "a log that belongs to one session only",
                "name the right log, or remove one of the two sessions",
            )
        };
        let file = format!("{own}/{SESSION_FILE}");
        let diagnostic = Diagnostic::error(file, found, expected, hint).in_column("log");
        let line = line_of_log(&sessions[log.session], log);
        repeated.push((log.session, diagnostic.at_row(line)));
    }
    repeated
}

/// The last line of the session's description that names a log; the first where no line does so in these words.
fn line_of_log(session: &Located, log: &Measured) -> u64 {
    let text = std::fs::read_to_string(session.directory.join(SESSION_FILE)).unwrap_or_default();
    let file = log
        .path
        .strip_prefix(&session.directory)
        .unwrap_or(&log.path);
    let quoted = format!("\"{}\"", file.display());
    let named = text.lines().enumerate().filter(|l| l.1.contains(&quoted));
    named.last().map_or(1, |(line, _)| line as u64 + 1)
}

fn take_out(found: &mut Discovery, mut twice: BTreeMap<usize, Diagnostic>) {
    if twice.is_empty() {
        return;
    }
    let sessions = std::mem::take(&mut found.sessions);
    for (place, located) in sessions.into_iter().enumerate() {
        match twice.remove(&place) {
            None => found.sessions.push(located),
            Some(diagnostic) => found.unusable.push(Unusable {
                relative: located.relative,
                diagnostics: vec![diagnostic],
            }),
        }
    }
    found.unusable.sort_by(|a, b| a.relative.cmp(&b.relative));
}
