//! A fingerprint of the code behind every stage, from the graph of crates: whatever a stage can call enters its key.
//!
//! `build.rs` makes the constants of it when this crate is built, and the tests of this crate edit a copy of the sources. Line ends do not count: a
//! checkout on Windows must not differ from one on Linux.

use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// What the crate of each stage is called, before the stage's own name.
const STAGE_CRATE: &str = "pipeline-";
/// The crate that writes what stages return: it enters every key.
const ENCODES: &str = "pipeline-run";

/// The crates of a workspace, the packages of its lock file, and what the workspace asks of them.
pub struct Graph {
    /// Folder and dependencies of each crate of the workspace, tests' own left out.
    crates: BTreeMap<String, (PathBuf, Vec<String>)>,
    /// Line of identity and dependencies of each package from a registry, by name, or by name and version where there are several.
    packages: BTreeMap<String, (String, Vec<String>)>,
    /// Version and features with which the workspace uses a package, as its manifest has them, by name.
    asked: BTreeMap<String, String>,
}

impl Graph {
    /// Reads the manifests below `src/`, the workspace's and `Cargo.lock`.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn read(root: &Path) -> std::io::Result<Self> {
        let mut crates = BTreeMap::new();
        let mut manifests = Vec::new();
        collect(&root.join("src"), &mut manifests)?;
        manifests.retain(|f| f.file_name().is_some_and(|n| n == "Cargo.toml"));
        for manifest in manifests {
            let text = std::fs::read_to_string(&manifest)?;
            let folder = manifest.parent().unwrap_or(root).to_path_buf();
            if let Some(name) = value(&text, "name") {
                crates.insert(name.to_owned(), (folder, dependencies(&text)));
            }
        }
        let lock = std::fs::read_to_string(root.join("Cargo.lock"))?;
        let mut packages = BTreeMap::new();
        for block in lock.split("[[package]]").skip(1) {
            let of = |key| value(block, key).unwrap_or_default();
            let (name, version) = (of("name"), of("version"));
            let identity = format!("{name} {version} {}", of("checksum"));
            let list = block.split_once("dependencies = [").map_or("", |(_, l)| l);
            let list = list.split(']').next().unwrap_or_default();
            let of_it: Vec<String> = list
                .split(',')
                .map(|d| d.trim().trim_matches('"').to_owned())
                .filter(|d| !d.is_empty())
                .collect();
            packages.insert(name.to_owned(), (identity.clone(), of_it.clone()));
            packages.insert(format!("{name} {version}"), (identity, of_it));
        }
        let workspace = std::fs::read_to_string(root.join("Cargo.toml"))?;
        let asked = entries(&workspace, "[workspace.dependencies]")
            .filter_map(|line| Some((name_of(line)?.to_owned(), line.to_owned())))
            .collect();
        Ok(Self {
            crates,
            packages,
            asked,
        })
    }

    /// Everything that a crate stands on, itself included.
    fn below(&self, name: &str) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        let mut open = vec![name.to_owned()];
        while let Some(next) = open.pop() {
            if !found.insert(next.clone()) {
                continue;
            }
            let of_crate = self.crates.get(&next).map(|(_, d)| d);
            let of_package = self.packages.get(&next).map(|(_, d)| d);
            open.extend(of_crate.or(of_package).into_iter().flatten().cloned());
        }
        found
    }

    /// The fingerprint of every crate's code, by the name of the crate without what all names begin with.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn fingerprints(&self) -> std::io::Result<BTreeMap<&str, String>> {
        let names = self.crates.keys();
        let names = names.filter_map(|name| name.strip_prefix(STAGE_CRATE));
        names.map(|n| Ok((n, self.fingerprint(n)?))).collect()
    }

    /// The fingerprint of a stage's code.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn fingerprint(&self, stage: &str) -> std::io::Result<String> {
        let mut hasher = Sha256::new();
        let mut names = self.below(&format!("{STAGE_CRATE}{stage}"));
        names.insert(ENCODES.to_owned());
        for name in names {
            match (self.crates.get(&name), self.packages.get(&name)) {
                (Some((folder, _)), _) => self.add_sources(folder, &name, &mut hasher)?,
                (None, Some((identity, _))) => {
                    let asked = self.asked.get(&name).map_or("", String::as_str);
                    hasher.update(format!("{identity}\n{asked}\n"));
                }
                (None, None) => hasher.update(format!("{name}\n")),
            }
        }
        let mut hex = String::from("sha256:");
        for byte in hasher.finalize() {
            write!(hex, "{byte:02x}").expect("writing to a string");
        }
        Ok(hex)
    }

    /// Names and contents of a crate's files, without those of crates in its folder.
    fn add_sources(&self, folder: &Path, name: &str, hasher: &mut Sha256) -> std::io::Result<()> {
        let mut files = Vec::new();
        collect(folder, &mut files)?;
        files.sort();
        for file in files {
            let inner = |(other, _): &&(PathBuf, _)| {
                other != folder && other.starts_with(folder) && file.starts_with(other)
            };
            if self.crates.values().any(|c| inner(&c)) {
                continue;
            }
            let place = file.strip_prefix(folder).unwrap_or(&file).to_string_lossy();
            let contents = std::fs::read(&file)?;
            hasher.update(format!("{name} {}\0", place.replace('\\', "/")));
            let contents: Vec<u8> = contents.into_iter().filter(|b| *b != b'\r').collect();
            hasher.update(contents);
            hasher.update(b"\0");
        }
        Ok(())
    }
}

/// The string that stands for a key at the beginning of a line.
fn value<'t>(text: &'t str, key: &str) -> Option<&'t str> {
    let of_line = |line: &'t str| {
        let rest = line.strip_prefix(key)?.trim_start().strip_prefix('=')?;
        Some(rest.trim().trim_matches('"'))
    };
    text.lines().find_map(of_line)
}

/// The names in `[dependencies]`.
fn dependencies(manifest: &str) -> Vec<String> {
    let lines = entries(manifest, "[dependencies]");
    lines.filter_map(name_of).map(str::to_owned).collect()
}

/// The lines of a table of a manifest.
fn entries<'t>(manifest: &'t str, table: &'t str) -> impl Iterator<Item = &'t str> {
    let lines = manifest.lines().skip_while(move |l| l.trim() != table);
    lines.skip(1).take_while(|l| !l.starts_with('['))
}

/// The key of a line of a table; none of an empty line and a comment.
fn name_of(line: &str) -> Option<&str> {
    let name = line.split(['.', ' ', '=']).next()?;
    (!name.is_empty() && !name.starts_with('#')).then_some(name)
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(path)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}
