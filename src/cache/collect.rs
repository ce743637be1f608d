//! Throws away what the present state does not need.
//!
//! Live are the entries that the last run used ([`crate`], `state.jsonl`) and the objects that a kept entry names. Everything else is
//! kept for a while, because going back to earlier options or data is then free.

use crate::sealed;
use crate::store::{Entry, Store, UNFINISHED};
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};
use walkdir::WalkDir;

/// What may go.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Entries that the last run did not use go if they are older than this.
    pub older_than: Duration,
    /// If the cache is still larger, the oldest of them go until it is not; bytes.
    pub most_bytes: Option<u64>,
}

/// One file that goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Where it is.
    pub path: PathBuf,
    /// Its bytes.
    pub size: u64,
}

/// What goes and what stays.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Entries that go.
    pub entries: Vec<File>,
    /// Objects that no kept entry names.
    pub objects: Vec<File>,
    /// What killed runs left: temporary files, and files that nothing understands.
    pub leftovers: Vec<File>,
    /// Entries that stay, and how many of them the last run used.
    pub kept: (usize, usize),
    /// Bytes before.
    pub bytes: u64,
}

impl Plan {
    /// Bytes of what goes.
    pub fn freed(&self) -> u64 {
        let all = self
            .entries
            .iter()
            .chain(&self.objects)
            .chain(&self.leftovers);
        all.map(|f| f.size).sum()
    }
}

/// An entry that the last run did not use.
struct Old {
    file: File,
    age: Duration,
    entry: Entry,
}

/// Finds out what may go; `live`: the keys that the last run used.
///
/// # Errors
/// The cache cannot be listed.
pub fn plan(
    store: &Store,
    live: &BTreeSet<Digest>,
    limits: Limits,
    now: SystemTime,
) -> Result<Plan> {
    let mut plan = Plan::default();
    let mut needed: BTreeSet<PathBuf> = BTreeSet::new();
    let mut old: Vec<Old> = Vec::new();
    for (file, age) in files(store, "entries", now)? {
        plan.bytes += file.size;
        let bytes = std::fs::read(&file.path).unwrap_or_default();
        let entry: Option<Entry> = sealed::unseal(&bytes);
        match entry {
            Some(entry) if live.contains(&entry.parts.key()) => {
                plan.kept.1 += 1;
                needed.extend(objects_of(store, &entry));
            }
            Some(entry) => old.push(Old { file, age, entry }),
            None => plan.leftovers.push(file),
        }
    }
    let objects = files(store, "objects", now)?;
    plan.bytes += objects.iter().map(|(f, _)| f.size).sum::<u64>();
    old.sort_by(|a, b| a.age.cmp(&b.age).then(a.file.path.cmp(&b.file.path)));
    // The youngest stay as long as there is room for them.
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(0, |m| m.len());
    let mut room: u64 = needed.iter().map(size).sum();
    for one in old {
        let its: BTreeSet<PathBuf> = objects_of(store, &one.entry).collect();
        let more: u64 = its.difference(&needed).map(size).sum::<u64>() + one.file.size;
        if one.age <= limits.older_than && limits.most_bytes.is_none_or(|most| room + more <= most)
        {
            room += more;
            needed.extend(its);
            plan.kept.0 += 1;
        } else {
            plan.entries.push(one.file);
        }
    }
    plan.kept.0 += plan.kept.1;
    for (file, _) in objects {
        let temporary = file
            .path
            .file_name()
            .is_some_and(|n| n.to_string_lossy().starts_with(UNFINISHED));
        if temporary {
            plan.leftovers.push(file);
        } else if !needed.contains(&file.path) {
            plan.objects.push(file);
        }
    }
    Ok(plan)
}

/// Removes what the plan names: entries first, so that none is ever without its objects.
///
/// # Errors
/// What the system says, a file that is gone already aside.
pub fn carry_out(plan: &Plan) -> Result<()> {
    for file in plan
        .entries
        .iter()
        .chain(&plan.leftovers)
        .chain(&plan.objects)
    {
        match std::fs::remove_file(&file.path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(Error::io("remove", &file.path)(e));
            }
            _ => {}
        }
    }
    Ok(())
}

fn objects_of<'a>(store: &'a Store, entry: &'a Entry) -> impl Iterator<Item = PathBuf> + 'a {
    entry.outputs.values().map(|o| store.object_path(&o.digest))
}

/// Files below a folder of the store with their ages.
fn files(store: &Store, folder: &str, now: SystemTime) -> Result<Vec<(File, Duration)>> {
    let root = store.root().join(folder);
    if !root.exists() {
        return Ok(Vec::new());
    }
    let mut list = Vec::new();
    for found in WalkDir::new(&root).sort_by_file_name() {
        let found = found.map_err(|e| Error::io("list", &root)(e.into()))?;
        if !found.file_type().is_file() {
            continue;
        }
        let metadata = found
            .metadata()
            .map_err(|e| Error::io("list", &root)(e.into()))?;
        let modified = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        let file = File {
            path: found.into_path(),
            size: metadata.len(),
        };
        list.push((file, now.duration_since(modified).unwrap_or_default()));
    }
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::key::KeyParts;
    use pipeline_base::digest::Outputs;

    fn put(store: &Store, stage: &str, outputs: &[(&str, &[u8])]) -> Digest {
        let parts = KeyParts {
            stage: stage.to_owned(),
            version: 1,
            code: String::new(),
            options: Default::default(),
            inputs: Default::default(),
        };
        let outputs: Outputs = outputs
            .iter()
            .map(|(n, b)| ((*n).to_owned(), b.to_vec()))
            .collect();
        store.put(parts.clone(), &outputs).unwrap();
        parts.key()
    }

    const NEVER: Duration = Duration::from_secs(u64::MAX / 4);

    #[test]
    fn what_the_last_run_used_stays_whatever_the_limits() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path());
        let live = put(&store, "live", &[("a", b"shared"), ("b", b"own")]);
        put(&store, "old", &[("a", b"shared"), ("c", b"only old")]);
        std::fs::write(store.root().join("objects/.writing-x"), b"half").unwrap();
        let live = BTreeSet::from([live]);
        let later = SystemTime::now() + Duration::from_secs(3600);
        for limits in [
            Limits {
                older_than: Duration::ZERO,
                most_bytes: None,
            },
            Limits {
                older_than: NEVER,
                most_bytes: Some(0),
            },
        ] {
            let plan = plan(&store, &live, limits, later).unwrap();
            let sizes = |files: &[File]| files.iter().map(|f| f.size).collect::<Vec<u64>>();
            assert_eq!(
                (
                    plan.entries.len(),
                    sizes(&plan.objects),
                    sizes(&plan.leftovers)
                ),
                (1, vec![8], vec![4])
            );
        }
        let plan = plan(
            &store,
            &live,
            Limits {
                older_than: Duration::ZERO,
                most_bytes: None,
            },
            later,
        )
        .unwrap();
        carry_out(&plan).unwrap();
        let key = live.first().unwrap();
        let outputs = store.outputs(key).unwrap().unwrap();
        assert!(outputs.values().all(|o| store.read(o).is_ok()));
    }

    #[test]
    fn what_is_young_stays_while_there_is_room() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path());
        put(&store, "old", &[("c", &[7; 1000])]);
        let limits = |most| Limits {
            older_than: NEVER,
            most_bytes: most,
        };
        let none = BTreeSet::new();
        assert_eq!(
            plan(&store, &none, limits(None), SystemTime::now())
                .unwrap()
                .freed(),
            0
        );
        assert!(
            plan(&store, &none, limits(Some(500)), SystemTime::now())
                .unwrap()
                .freed()
                > 1000
        );
    }
}
