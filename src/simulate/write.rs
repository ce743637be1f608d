//! Puts a campaign below a folder, and its truth into a file outside of that folder.

use super::Campaign;
use super::session_file::NOTES;
use pipeline_base::error::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Session folders.
    pub sessions: usize,
    /// Files below them.
    pub files: usize,
    /// Bytes of these files.
    pub bytes: u64,
}

/// Writes the sessions below `out` and, where a path is given, the drawn truth to `truth_out`.
///
/// A folder that is not empty is refused. With `replace`, simulated sessions below it are removed first; a folder that holds
/// anything else is refused all the same.
///
/// # Errors
/// [`Error::Usage`] where `out` is not empty or `truth_out` lies below it; system errors.
pub fn write(
    campaign: &Campaign,
    out: &Path,
    truth_out: Option<&Path>,
    replace: bool,
) -> Result<Written> {
    if let Some(file) = truth_out {
        refuse_inside(file, out)?;
    }
    clear(out, replace)?;
    let mut written = Written::default();
    for session in &campaign.sessions {
        let folder = out.join(&session.folder);
        fs::create_dir_all(&folder).map_err(Error::io("create the folder", &folder))?;
        for (name, bytes) in &session.files {
            let path = folder.join(name);
            fs::write(&path, bytes).map_err(Error::io("write", &path))?;
            written.files += 1;
            written.bytes += bytes.len() as u64;
        }
        written.sessions += 1;
    }
    if let Some(file) = truth_out {
        write_truth(campaign, file)?;
    }
    Ok(written)
}

fn write_truth(campaign: &Campaign, file: &Path) -> Result<()> {
    let mut text = serde_json::to_string_pretty(&campaign.drawn).map_err(Error::internal)?;
    text.push('\n');
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    }
    fs::write(file, text).map_err(Error::io("write", file))
}

/// The truth must not lie where the campaign is read from.
fn refuse_inside(file: &Path, out: &Path) -> Result<()> {
    let inside = resolved(file)?.starts_with(resolved(out)?);
    if !inside {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "the truth file {} lies inside the campaign's folder {}; name a file outside of it",
        file.display(),
        out.display()
    )))
}

/// The absolute path, links resolved as far as it exists.
fn resolved(path: &Path) -> Result<PathBuf> {
    let path = std::path::absolute(path).map_err(Error::io("resolve", path))?;
    for ancestor in path.ancestors() {
        if let Ok(real) = ancestor.canonicalize() {
            let rest = path.strip_prefix(ancestor).map_err(Error::internal)?;
            return Ok(if rest.as_os_str().is_empty() {
                real
            } else {
                real.join(rest)
            });
        }
    }
    Ok(path)
}

/// Makes sure that `out` is empty or does not exist.
fn clear(out: &Path, replace: bool) -> Result<()> {
    if !out.exists() || entries(out)?.is_empty() {
        return Ok(());
    }
    if !replace {
        return Err(Error::Usage(format!(
            "{} is not empty; name another folder, or say that it is to be replaced",
            out.display()
        )));
    }
    let mut sessions = Vec::new();
    simulated_below(out, &mut sessions)?;
    for folder in sessions {
        fs::remove_dir_all(&folder).map_err(Error::io("remove the folder", &folder))?;
    }
    Ok(())
}

/// The session folders below `folder`, all of which must be simulated ones.
fn simulated_below(folder: &Path, sessions: &mut Vec<PathBuf>) -> Result<()> {
    let toml = folder.join("session.toml");
    if toml.is_file() {
        let text = fs::read_to_string(&toml).map_err(Error::io("read", &toml))?;
        if !is_simulated(&text) {
            return Err(foreign(&toml));
        }
        sessions.push(folder.to_path_buf());
        return Ok(());
    }
    for path in entries(folder)? {
        if path.is_symlink() || !path.is_dir() {
            return Err(foreign(&path));
        }
        simulated_below(&path, sessions)?;
    }
    Ok(())
}

/// Whether the notes of a `session.toml` are those that this program writes.
fn is_simulated(text: &str) -> bool {
    let table = text.parse::<toml::Table>().unwrap_or_default();
    let notes = table.get("notes").and_then(toml::Value::as_str);
    notes.is_some_and(|n| n.starts_with(NOTES))
}

fn foreign(path: &Path) -> Error {
    Error::Usage(format!(
        "{} was not written by `pipeline simulate`; nothing was replaced; name another folder",
        path.display()
    ))
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let read = || -> std::io::Result<Vec<PathBuf>> {
        fs::read_dir(folder)?.map(|e| Ok(e?.path())).collect()
    };
    let mut entries = read().map_err(Error::io("read the folder", folder))?;
    entries.sort();
    Ok(entries)
}
