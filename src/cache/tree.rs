//! The fingerprint of a tree of files: which there are, how large and from when. None of them is read.

use crate::seen;
use pipeline_base::digest::Digest;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// The fingerprint of everything at and below `root`, with links followed if `follow` says so.
///
/// None where it would prove nothing: something cannot be looked at or opened, which may be otherwise for another user, or was changed so short a time
/// ago that it may change again without a new time stamp ([`seen`]).
pub fn fingerprint(root: &Path, follow: bool) -> Option<Digest> {
    let mut lines = String::new();
    for entry in WalkDir::new(root).follow_links(follow).sort_by_file_name() {
        let entry = entry.ok()?;
        let metadata = entry.metadata().ok()?;
        let name = entry.path().strip_prefix(root).ok()?;
        if metadata.is_dir() {
            // Its time says no more than the names below it.
            writeln!(lines, "{name:?}").ok()?;
            continue;
        }
        let (modified, described) = (seen::modified_ns(&metadata), seen::described_ns(&metadata));
        if !seen::is_settled(modified.max(described)) {
            return None;
        }
        if !is_open_to_all(&metadata) && std::fs::File::open(entry.path()).is_err() {
            return None;
        }
        let (size, number) = (metadata.len(), seen::number(&metadata));
        writeln!(lines, "{name:?} {size} {modified} {described} {number}").ok()?;
    }
    Some(Digest::of(lines.as_bytes()))
}

/// Whether the permissions let everybody read.
#[cfg(unix)]
fn is_open_to_all(metadata: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    metadata.mode() & 0o444 == 0o444 || !metadata.is_file()
}

#[cfg(not(unix))]
fn is_open_to_all(metadata: &std::fs::Metadata) -> bool {
    !metadata.is_file()
}

/// What lies directly in a folder, sorted: parts of its tree, whose fingerprints can be taken side by side. The folder itself where it
/// cannot be listed.
pub fn parts(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return vec![folder.to_path_buf()];
    };
    let mut parts: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    parts.sort();
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{File, create_dir, remove_file, write};
    use std::time::{Duration, SystemTime};

    fn put(path: &Path, text: &str, age_s: u64) {
        write(path, text).unwrap();
        let file = File::options().write(true).open(path).unwrap();
        let time = SystemTime::now() - Duration::from_secs(age_s);
        file.set_modified(time).unwrap();
    }

    /// Waits until what was just described is old enough.
    fn settle() {
        std::thread::sleep(Duration::from_millis(2100));
    }

    #[test]
    fn every_change_shows_and_what_is_too_young_has_no_fingerprint() {
        let directory = tempfile::tempdir().unwrap();
        let root = directory.path();
        let of = || fingerprint(root, true);
        create_dir(root.join("a")).unwrap();
        let log = root.join("a/log.csv");
        put(&log, "one", 100);
        assert_eq!(of(), None, "described just now");
        settle();
        let first = of();
        assert!(first.is_some());
        create_dir(root.join("empty")).unwrap();
        let second = of();
        assert_ne!(second, first, "a new folder");
        put(&log, "two", 100);
        put(&root.join("b.csv"), "", 100);
        settle();
        let third = of();
        assert!(third.is_some() && third != second, "other contents");
        remove_file(root.join("b.csv")).unwrap();
        assert!(![first, second, third].contains(&of()), "a file less");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_a_loop_of_them_has_no_fingerprint() {
        let (directory, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let linked = other.path().join("log.csv");
        put(&linked, "one", 100);
        std::os::unix::fs::symlink(&linked, directory.path().join("log.csv")).unwrap();
        settle();
        let of = || fingerprint(directory.path(), true);
        let first = of();
        assert!(first.is_some());
        put(&linked, "longer", 100);
        settle();
        assert_ne!(of(), first);
        std::os::unix::fs::symlink(directory.path(), directory.path().join("up")).unwrap();
        assert_eq!(of(), None);
    }
}
