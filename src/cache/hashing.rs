//! SHA-256 digests of bytes and files.

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fmt;
use std::io::Read;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The SHA-256 of some bytes, written `sha256:` and 64 hexadecimal digits.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Digest(String);

impl Digest {
    /// The digest of these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self::tagged(Sha256::digest(bytes).as_slice())
    }

    /// One digest over digests with names, in the order given.
    pub fn of_named<'a>(digests: impl Iterator<Item = (&'a String, &'a Digest)>) -> Self {
        let lines: Vec<String> = digests.map(|(name, d)| format!("{name:?} {d}\n")).collect();
        Self::of(lines.concat().as_bytes())
    }

    fn tagged(hash: &[u8]) -> Self {
        let hex: String = hash.iter().map(|b| format!("{b:02x}")).collect();
        Self(format!("sha256:{hex}"))
    }

    /// The 64 hexadecimal digits.
    pub fn hex(&self) -> &str {
        self.0.strip_prefix("sha256:").unwrap_or(&self.0)
    }

    /// The first twelve digits, enough for a person.
    pub fn short(&self) -> &str {
        let hex = self.hex();
        &hex[..hex.len().min(12)]
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.short())
    }
}

/// The digest of a file, read in pieces.
///
/// # Errors
/// What the system says.
pub fn of_file(path: &Path) -> std::io::Result<Digest> {
    let mut file = std::fs::File::open(path)?;
    let mut hasher = Sha256::new();
    let mut piece = vec![0_u8; 1 << 18];
    loop {
        let n = file.read(&mut piece)?;
        if n == 0 {
            return Ok(Digest::tagged(hasher.finalize().as_slice()));
        }
        hasher.update(&piece[..n]);
    }
}

/// The largest file whose bytes are kept between hashing and reading.
pub const LARGEST_IN_MEMORY: u64 = 64 << 20;

/// A file's size and time of change, with the digest that its contents had then.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Seen {
    size: u64,
    modified_ns: u64,
    digest: Digest,
}

/// A file that was changed so short a time before it was hashed may change again without a new time stamp.
const TOO_FRESH: Duration = Duration::from_secs(2);

/// Digests of raw files, remembered by size and time of change so that an untouched file need not be read again.
///
/// Only a saving: a file that differs in either is hashed, and a file changed within two seconds of its hashing is not remembered.
#[derive(Debug, Default)]
pub struct FileHashes {
    known: BTreeMap<String, Seen>,
    current: Mutex<BTreeMap<String, Seen>>,
}

impl FileHashes {
    /// Takes up what an earlier run remembered; damaged contents are forgotten.
    pub fn from_json(bytes: &[u8]) -> Self {
        Self {
            known: serde_json::from_slice(bytes).unwrap_or_default(),
            current: Mutex::default(),
        }
    }

    /// What this run has seen, for the next; `None` where it is what was known already.
    pub fn to_json(&self) -> Option<Vec<u8>> {
        let current = self.current.lock().ok()?;
        if *current == self.known {
            return None;
        }
        serde_json::to_vec(&*current).ok()
    }

    /// What this run has seen beside what `others` have written down; `None` where they knew it already. Of two processes that do this at
    /// once one may be forgotten, which costs no more than hashing again.
    pub fn to_json_with(&self, others: &[u8]) -> Option<Vec<u8>> {
        let mut all = Self::from_json(others).known;
        let known = all.clone();
        all.extend(self.current.lock().ok()?.clone());
        (all != known).then(|| serde_json::to_vec(&all).ok())?
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
        let modified = metadata.modified().unwrap_or(UNIX_EPOCH);
        let since_epoch = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
        let (size, modified_ns) = (metadata.len(), since_epoch.as_nanos() as u64);
        if let Some(seen) = self.known.get(name)
            && (seen.size, seen.modified_ns) == (size, modified_ns)
        {
            self.remember(name, seen.clone());
            return Ok((seen.digest.clone(), None));
        }
        let (digest, bytes) = if size <= LARGEST_IN_MEMORY {
            let bytes = std::fs::read(path)?;
            (Digest::of(&bytes), Some(bytes))
        } else {
            (of_file(path)?, None)
        };
        let age = SystemTime::now()
            .duration_since(modified)
            .unwrap_or_default();
        if age > TOO_FRESH {
            self.remember(
                name,
                Seen {
                    size,
                    modified_ns,
                    digest: digest.clone(),
                },
            );
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
    fn the_digest_is_the_standard_one() {
        assert_eq!(
            Digest::of(b"abc").to_string(),
            "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    #[test]
    fn a_file_changed_just_now_is_hashed_again_even_if_size_and_time_agree() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        std::fs::write(&path, b"one").unwrap();
        let time = std::fs::metadata(&path).unwrap().modified().unwrap();
        let hashes = FileHashes::default();
        let first = hashes.digest("log.csv", &path).unwrap().0;
        let hashes = FileHashes::from_json(&hashes.to_json().unwrap_or_default());
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
        let next = FileHashes::from_json(&hashes.to_json().unwrap());
        assert_eq!(next.digest("log.csv", &path).unwrap(), (first, None));
        assert!(next.to_json().is_none(), "nothing new was seen");
        set(b"two", 50);
        assert_eq!(next.digest("log.csv", &path).unwrap().0, Digest::of(b"two"));
    }
}
