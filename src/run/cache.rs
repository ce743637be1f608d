//! The cache directory of one `derived/`, opened and locked.

use crate::base::error::{Error, Result};
use crate::cache::{State, Store};
use crate::run::Progress;
use std::fs::File;
use std::path::Path;

/// What the last run left of every unit.
pub const STATE: &str = "state.jsonl";
const LOCK: &str = "lock";

/// A store with what the last run used of it. While it lives, no other process writes there.
pub struct Cache {
    store: Store,
    last: State,
    _lock: Option<File>,
}

impl Cache {
    /// Opens the cache below `derived/`; waits for another run on it to end, unless it is only looked at.
    ///
    /// # Errors
    /// The directory cannot be made or written.
    pub fn open(derived: &Path, only_look: bool, progress: &dyn Progress) -> Result<Self> {
        let root = derived.join("cache");
        let lock = if only_look {
            None
        } else {
            std::fs::create_dir_all(&root).map_err(Error::io("create the folder", &root))?;
            lock(&root.join(LOCK), progress)?
        };
        let store = Store::new(&root);
        Ok(Self {
            last: store.read_aside(STATE),
            store,
            _lock: lock,
        })
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
fn lock(path: &Path, progress: &dyn Progress) -> Result<Option<File>> {
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path)
        .map_err(Error::io("open the lock", path))?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(std::fs::TryLockError::WouldBlock) => {
            progress.note("another run works on this directory; waiting for it to end");
            file.lock().map_err(Error::io("lock", path))?;
            Ok(Some(file))
        }
        Err(std::fs::TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => {
            progress
                .note("this file system has no locks: let nobody else run on this directory now");
            Ok(None)
        }
        Err(std::fs::TryLockError::Error(e)) => Err(Error::io("lock", path)(e)),
    }
}
