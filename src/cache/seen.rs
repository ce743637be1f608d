//! Digests of files, remembered by size and times of change, so that an untouched file need not be read again.
//!
//! Only a saving, and a careful one. A file is hashed again if its size, its time of change or, where the system keeps one, the time of change of
//! its description (which no program sets back) is another. A file that was changed within two seconds of being hashed, or in the future
//! of a clock that went back, is not remembered: it may change again without a new time. Git is as careful with its index.

use pipeline_base::digest::{self, Digest};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::Metadata;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The largest file whose bytes are kept between hashing and reading.
pub const LARGEST_IN_MEMORY: u64 = 64 << 20;

/// A file that was changed so short a time before it was hashed may change again without a new time stamp.
const TOO_FRESH: Duration = Duration::from_secs(2);

/// A file's size and times of change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Stamp {
    size: u64,
    modified_ns: u64,
    described_ns: u64,
    /// Of two folders that change places their files keep their times.
    number: u64,
}

impl Stamp {
    fn of(metadata: &Metadata) -> Self {
        Self {
            size: metadata.len(),
            modified_ns: modified_ns(metadata),
            described_ns: described_ns(metadata),
            number: number(metadata),
        }
    }
}

/// Time of change in nanoseconds since 1970; 0 where it is not known.
pub fn modified_ns(metadata: &Metadata) -> u64 {
    let modified = metadata.modified().unwrap_or(UNIX_EPOCH);
    nanoseconds(modified)
}

fn nanoseconds(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH)
        .unwrap_or_default()
        .as_nanos() as u64
}

/// Time of change of the description in nanoseconds since 1970; 0 where the system keeps none.
#[cfg(unix)]
pub fn described_ns(metadata: &Metadata) -> u64 {
    use std::os::unix::fs::MetadataExt;
    (metadata.ctime().unsigned_abs()) * 1_000_000_000 + metadata.ctime_nsec().unsigned_abs()
}

/// Time of change of the description: 0, for the system keeps none.
#[cfg(not(unix))]
pub fn described_ns(_metadata: &Metadata) -> u64 {
    0
}

/// The later of the times of change of contents and description, ns since 1970: whoever sets back the one moves the other.
pub fn changed_ns(metadata: &Metadata) -> u64 {
    modified_ns(metadata).max(described_ns(metadata))
}

/// The number of a file on its file system; 0 where the system keeps none.
#[cfg(unix)]
pub fn number(metadata: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::ino(metadata)
}

/// The number of a file: 0, for the system keeps none.
#[cfg(not(unix))]
pub fn number(_metadata: &Metadata) -> u64 {
    0
}

/// Whether a time of change lies so far back that a later change has another time.
pub fn is_settled(modified_ns: u64) -> bool {
    let now = nanoseconds(SystemTime::now());
    modified_ns > 0 && modified_ns + (TOO_FRESH.as_nanos() as u64) < now
}

/// A file's stamp, with the digest that its contents had then.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    stamp: Stamp,
    digest: Digest,
}

/// Digests of raw files and reports by name.
#[derive(Debug, Default)]
pub struct FileHashes {
    known: BTreeMap<String, Seen>,
    current: Mutex<BTreeMap<String, Seen>>,
}

impl FileHashes {
    /// Takes up what an earlier run learned.
    pub fn new(known: BTreeMap<String, Seen>) -> Self {
        Self {
            known,
            current: Mutex::default(),
        }
    }

    /// What this run has seen, for the next; `None` where it is what was known already.
    pub fn learned(&self) -> Option<BTreeMap<String, Seen>> {
        let current = self.current.lock().ok()?;
        (*current != self.known).then(|| current.clone())
    }

    /// What this run has seen beside what `others` have written down; `None` where they knew it already. Of two processes that do this at
    /// once one may be forgotten, which costs no more than hashing again.
    pub fn learned_beside(&self, others: BTreeMap<String, Seen>) -> Option<BTreeMap<String, Seen>> {
        let mut all = others.clone();
        all.extend(self.current.lock().ok()?.clone());
        (all != others).then_some(all)
    }

    /// The digest of the file at `path`, remembered under `name`, and its bytes if they had to be read for it.
    ///
    /// A file of more than [`LARGEST_IN_MEMORY`] bytes is hashed in pieces and not kept.
    ///
    /// # Errors
    /// What the system says.
    pub fn digest(&self, name: &str, path: &Path) -> std::io::Result<(Digest, Option<Vec<u8>>)> {
        let metadata = std::fs::metadata(path)?;
        if !metadata.is_file() {
            // A pipe or device would be read for ever.
            return Err(std::io::ErrorKind::InvalidInput.into());
        }
        let stamp = Stamp::of(&metadata);
        if let Some(seen) = self.known.get(name).filter(|seen| seen.stamp == stamp) {
            self.remember(name, seen.clone());
            return Ok((seen.digest.clone(), None));
        }
        let (digest, bytes) = if stamp.size <= LARGEST_IN_MEMORY {
            let bytes = std::fs::read(path)?;
            (Digest::of(&bytes), Some(bytes))
        } else {
            (digest::of_file(path)?, None)
        };
        if is_settled(stamp.modified_ns) {
            let digest = digest.clone();
            self.remember(name, Seen { stamp, digest });
        }
        Ok((digest, bytes))
    }

    fn remember(&self, name: &str, seen: Seen) {
        if let Ok(mut current) = self.current.lock() {
            current.insert(name.to_owned(), seen);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_changed_just_now_is_hashed_again_even_if_size_and_time_agree() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        std::fs::write(&path, b"one").unwrap();
        let time = std::fs::metadata(&path).unwrap().modified().unwrap();
        let hashes = FileHashes::default();
        let first = hashes.digest("log.csv", &path).unwrap().0;
        let hashes = FileHashes::new(hashes.learned().unwrap_or_default());
        std::fs::write(&path, b"two").unwrap();
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(time).unwrap();
        assert_ne!(hashes.digest("log.csv", &path).unwrap().0, first);
    }

    #[test]
    fn an_old_file_is_remembered_and_a_changed_one_is_not() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        let set = |contents: &[u8], age: u64| {
            std::fs::write(&path, contents).unwrap();
            let file = std::fs::File::options().write(true).open(&path).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age))
                .unwrap();
        };
        set(b"one", 100);
        let hashes = FileHashes::default();
        let first = hashes.digest("log.csv", &path).unwrap().0;
        let next = FileHashes::new(hashes.learned().unwrap());
        assert_eq!(next.digest("log.csv", &path).unwrap(), (first, None));
        assert!(next.learned().is_none(), "nothing new was seen");
        set(b"two", 50);
        assert_eq!(next.digest("log.csv", &path).unwrap().0, Digest::of(b"two"));
    }

    #[cfg(unix)]
    #[test]
    fn a_time_that_was_set_back_hides_no_change_of_the_same_size() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        let long_ago = SystemTime::now() - Duration::from_secs(100);
        let set = |contents: &[u8]| {
            std::fs::write(&path, contents).unwrap();
            let file = std::fs::File::options().write(true).open(&path).unwrap();
            file.set_modified(long_ago).unwrap();
        };
        set(b"one");
        let hashes = FileHashes::default();
        hashes.digest("log.csv", &path).unwrap();
        let next = FileHashes::new(hashes.learned().unwrap());
        std::thread::sleep(Duration::from_millis(20));
        set(b"two");
        assert_eq!(next.digest("log.csv", &path).unwrap().0, Digest::of(b"two"));
    }

    #[test]
    fn a_file_from_the_future_of_a_clock_that_went_back_is_not_remembered() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        std::fs::write(&path, b"one").unwrap();
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(SystemTime::now() + Duration::from_secs(3600))
            .unwrap();
        let hashes = FileHashes::default();
        hashes.digest("log.csv", &path).unwrap();
        assert!(hashes.learned().is_none());
    }
}
