//! The cache directory of one `derived/`, opened and locked.

use crate::Progress;
use pipeline_base::error::{Error, Result};
use pipeline_cache::{State, Store};
use std::fs::File;
use std::path::Path;

/// What the last run left of every unit.
pub const STATE: &str = "state.jsonl";
const LOCK: &str = "lock";

/// What a process does with a cache, and who may do what beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads, whatever others do.
    Look,
    /// Adds objects and entries beside others that do: each is written to a temporary place and renamed, and named by what is in it, so that two
    /// processes with the same result write the same bytes.
    Shared,
    /// Writes down the state of a whole run, puts results in place or removes old entries: nobody else writes meanwhile.
    Alone,
}

/// A store with what the last run used of it. While it lives, it has its [`Access`].
pub struct Cache {
    store: Store,
    last: State,
    _lock: Option<File>,
}

impl Cache {
    /// Opens the cache below `derived/`; waits for processes that do not go with this access to end.
    ///
    /// # Errors
    /// The directory cannot be made or written.
    pub fn open(derived: &Path, access: Access, progress: &dyn Progress) -> Result<Self> {
        let lock = Self::lock(derived, access, progress)?;
        let store = Store::new(&derived.join("cache"));
        Ok(Self {
            last: store.read_aside(STATE),
            store,
            _lock: lock,
        })
    }

    /// Takes the lock of the cache below `derived/`, waiting like [`Cache::open`]; it lasts as long as the file lives. None for who only
    /// looks, and where the file system has no locks.
    ///
    /// # Errors
    /// The directory cannot be made or written.
    pub fn lock(derived: &Path, access: Access, progress: &dyn Progress) -> Result<Option<File>> {
        if access == Access::Look {
            return Ok(None);
        }
        let root = derived.join("cache");
        std::fs::create_dir_all(&root).map_err(Error::io("create the folder", &root))?;
        lock(&root.join(LOCK), access == Access::Shared, progress)
    }

    /// Objects and entries.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// What the last run left.
    pub fn last(&self) -> &State {
        &self.last
    }
}

/// Takes the lock of a cache; it dies with the process. None, with a note, on a file system that has no locks.
fn lock(path: &Path, shared: bool, progress: &dyn Progress) -> Result<Option<File>> {
    // Open for reading too: file systems over a network refuse a shared lock on a file that is only written.
    let file = File::options()
        .create(true)
        .truncate(false)
        .read(true)
        .write(true)
        .open(path)
        .map_err(Error::io("open the lock", path))?;
    let attempt = match shared {
        true => file.try_lock_shared(),
        false => file.try_lock(),
    };
    match attempt {
        Ok(()) => Ok(Some(file)),
        Err(std::fs::TryLockError::WouldBlock) => {
            progress.note("another run is working on this directory; waiting for it to end");
            let locked = match shared {
                true => file.lock_shared(),
                false => file.lock(),
            };
            locked.map_err(Error::io("lock", path))?;
            Ok(Some(file))
        }
        Err(std::fs::TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => {
            progress
                .note("this file system has no locks: make sure that nobody else runs pipeline on this directory now");
            Ok(None)
        }
        Err(std::fs::TryLockError::Error(e)) => Err(Error::io("lock", path)(e)),
    }
}
