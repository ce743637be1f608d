//! Where the drafts of `new-session` go, and the ids of their sessions: no two of one call are alike.

use pipeline_base::error::{Error, Result};
use pipeline_base::names::plain_path;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The folder of each log: `out` itself of one log, else one for each in it, or here.
///
/// # Errors
/// Two logs would have one folder.
pub(super) fn folders(logs: &[PathBuf], out: Option<&Path>) -> Result<Vec<PathBuf>> {
    match (out, logs) {
        (Some(out), [_]) => Ok(vec![out.to_owned()]),
        (out, _) => {
            let out = out.unwrap_or(Path::new(""));
            Ok(names(logs)?.iter().map(|name| out.join(name)).collect())
        }
    }
}

/// The id of the session in a folder: its path below a raw directory, elsewhere its name.
pub(super) fn id(folder: &Path, raw: &[PathBuf], log: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let place = absolute(folder);
    let mut below = raw.iter().filter_map(|raw| {
        let below = plain_path(place.strip_prefix(absolute(raw)).ok()?)?;
        Some(below.replace('/', "-"))
    });
    let name = || place.file_name().map(|n| n.to_string_lossy().into_owned());
    let id = below.next().or_else(name).filter(|id| !id.is_empty());
    id.unwrap_or_else(|| stem(log))
}

/// A name for each log: its own without endings, and where several logs have one, the names of as many folders above them as tell them apart.
fn names(logs: &[PathBuf]) -> Result<Vec<String>> {
    let mut alike: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (k, log) in logs.iter().enumerate() {
        alike.entry(stem(log)).or_default().push(k);
    }
    let mut names = vec![String::new(); logs.len()];
    for group in alike.values() {
        let deepest = group.iter().map(|k| above(&logs[*k]).len()).max();
        let with = |depth: usize| group.iter().map(|k| name(&logs[*k], depth)).collect();
        let mut all = (0..=deepest.unwrap_or(0)).map(with);
        let apart = all.find(|names: &Vec<String>| twice(names).is_none());
        for (k, name) in group.iter().zip(apart.unwrap_or_else(|| with(0))) {
            names[*k] = name;
        }
    }
    match twice(&names) {
        None => Ok(names),
        Some((first, second)) => Err(Error::Usage(format!(
            "{} and {} would both become the session {}; nothing was written: give each by itself, with an --out of its own",
            logs[first].display(),
            logs[second].display(),
            names[first]
        ))),
    }
}

/// The places of the first name that occurs twice.
fn twice(names: &[String]) -> Option<(usize, usize)> {
    let pairs = names.iter().enumerate().filter_map(|(second, name)| {
        let first = names[..second].iter().position(|other| other == name)?;
        Some((first, second))
    });
    pairs.min()
}

/// The name of a log behind those of the folders next above it.
fn name(log: &Path, folders: usize) -> String {
    let above = above(log);
    let mut parts: Vec<String> = above.into_iter().take(folders).collect();
    parts.reverse();
    parts.push(stem(log));
    parts.join("-")
}

/// The names of the folders above a log, the nearest first.
fn above(log: &Path) -> Vec<String> {
    let log = std::path::absolute(log).unwrap_or_else(|_| log.to_owned());
    let names = log.ancestors().skip(1).filter_map(Path::file_name);
    names.map(|n| n.to_string_lossy().into_owned()).collect()
}

/// The name of a log without its endings: `test8` of `test8.csv.gz`.
fn stem(log: &Path) -> String {
    let name = log.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.split('.').find(|part| !part.is_empty());
    stem.unwrap_or("log").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folders_of(logs: &[&str]) -> Result<Vec<String>> {
        let logs: Vec<PathBuf> = logs.iter().map(PathBuf::from).collect();
        let folders = folders(&logs, Some(Path::new("raw")))?;
        Ok(folders.iter().map(|f| f.display().to_string()).collect())
    }

    #[test]
    fn logs_of_one_name_are_told_apart_by_as_many_folders_as_it_takes() {
        let near = folders_of(&["a/test8.csv", "b/test8.csv", "b/test9.csv"]);
        assert_eq!(near.unwrap(), ["raw/a-test8", "raw/b-test8", "raw/test9"]);
        let far = folders_of(&["a/x/test8.csv", "b/x/test8.csv"]);
        assert_eq!(far.unwrap(), ["raw/a-x-test8", "raw/b-x-test8"]);
        for alike in [
            ["a/test8.csv", "a/test8.txt", "test9.csv"],
            ["a/test8.csv", "b/test8.csv", "a-test8.csv"],
        ] {
            assert!(folders_of(&alike).is_err(), "{alike:?}");
        }
    }

    #[test]
    fn an_id_is_the_path_below_the_raw_directory() {
        let raw = [PathBuf::from("raw")];
        let id = |folder: &str| id(Path::new(folder), &raw, Path::new("test8.csv"));
        assert_eq!(id("raw/l182/c00"), "l182-c00");
        assert_eq!(id("./raw/a"), "a");
        assert_eq!(id("elsewhere/a"), "a");
        assert_eq!(id("raw"), "test8");
    }
}
