//! The raw logs of a session: hashed for the key, read for the stage, and never of two minds.

use crate::engine::Engine;
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_formats::discover::Located;
use pipeline_formats::log_file;
use pipeline_ingest::LogBytes;
use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};

/// How often a session is begun again whose logs change while they are read.
pub const ATTEMPTS: usize = 3;

/// The logs of one session as they were hashed.
pub struct Logs<'a> {
    located: &'a Located,
    /// In the order of the session's logs.
    hashed: Vec<Hashed>,
    changed: Cell<bool>,
}

struct Hashed {
    path: PathBuf,
    digest: Digest,
    /// The bytes, if they were read for the digest; until they are taken.
    bytes: RefCell<Option<Vec<u8>>>,
}

impl<'a> Logs<'a> {
    /// Hashes the logs of a session, as far as they have changed since the last run.
    pub fn hash(engine: &Engine, located: &'a Located) -> Self {
        let session = &located.session;
        let hashed = session.logs.iter().map(|log| {
            let path = located.directory.join(&log.file);
            let name = format!("{}:{}", session.id, log.file);
            let (digest, bytes) = engine
                .hashes
                .digest(&name, &path)
                .unwrap_or_else(|e| (unreadable_digest(&e), None));
            let bytes = RefCell::new(bytes);
            Hashed {
                path,
                digest,
                bytes,
            }
        });
        Self {
            located,
            hashed: hashed.collect(),
            changed: Cell::new(false),
        }
    }

    /// The digest of each log, by its file.
    pub fn digests(&self) -> impl Iterator<Item = (String, Digest)> {
        self.all()
            .map(|(file, hashed)| (file.clone(), hashed.digest.clone()))
    }

    fn all(&self) -> impl Iterator<Item = (&String, &Hashed)> {
        let logs = self.located.session.logs.iter();
        logs.map(|log| &log.file).zip(&self.hashed)
    }

    /// The logs, each as its bytes or why there are none.
    ///
    /// # Errors
    /// One of them has changed since it was hashed.
    pub fn read(&self) -> Result<Vec<LogBytes>> {
        let mut files = Vec::with_capacity(self.hashed.len());
        for (file, hashed) in self.all() {
            let file = format!("{}/{file}", self.located.relative);
            let (bytes, read) = read_log(&hashed.path, &file, hashed.bytes.take());
            if read.is_some_and(|read| read != hashed.digest) {
                self.changed.set(true);
            }
            files.push(bytes);
        }
        match self.changed.get() {
            true => Err(self.restless()),
            false => Ok(files),
        }
    }

    /// Whether a log has changed between hashing and reading.
    pub fn changed(&self) -> bool {
        self.changed.get()
    }

    fn restless(&self) -> Error {
        Error::Usage(format!(
            "the logs of session {} are being written while they are read; run again when the logger has finished",
            self.located.session.id
        ))
    }
}

/// A file that cannot be read has a digest too, so that its return is a change of input.
fn unreadable_digest(error: &std::io::Error) -> Digest {
    Digest::of(format!("unreadable: {}", error.kind()).as_bytes())
}

/// The bytes of a log, or a diagnostic where it cannot be read; and the digest of what was read, if it was read now.
fn read_log(path: &Path, file: &str, at_hand: Option<Vec<u8>>) -> (LogBytes, Option<Digest>) {
    if let Some(bytes) = at_hand {
        return match log_file::check(file, bytes.len() as u64, bytes.as_slice()) {
            Ok(Err(diagnostic)) => (Err(diagnostic), None),
            _ => (Ok(bytes), None),
        };
    }
    let bytes = log_file::load(path, file);
    let digest = bytes.as_deref().ok().map(Digest::of);
    (bytes, digest)
}
