//! Which files belong to a bundle: what the last run wrote down of itself, never what happens to lie in a folder.

use crate::{Contents, Packed, Places, RAW};
use pipeline_base::digest::{self, Digest};
use pipeline_base::error::{Error, Result};
use pipeline_base::names::plain_path;
use pipeline_config::Config;
use pipeline_formats::discover::{Discovery, SESSION_FILE};
use pipeline_run::ancestry::Ancestry;
use pipeline_run::materialize::PROVENANCE;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The file of the options in a bundle.
pub(super) const CONFIG: &str = "pipeline.toml";
/// The file that says what the program is: the standard wants an address for it.
pub(super) const CITATION: &str = "CITATION.cff";
const CITATION_TEXT: &str = include_str!("../../CITATION.cff");
const REPORTS: &str = "reports/";
const DERIVED: &str = "derived/";

/// Everything that the last run put below `reports/` and `derived/`, but the cache and the data session by session.
pub(super) fn results(places: &Places) -> Result<Vec<Packed>> {
    let ancestry = Ancestry::load(&places.derived)?;
    let outputs = ancestry.units.iter().flat_map(|u| &u.entry.outputs);
    let made: BTreeMap<&str, &Digest> = outputs
        .map(|(name, object)| (name.as_str(), &object.digest))
        .collect();
    let made = made.into_iter().filter_map(|(name, digest)| {
        let on_disk = match (name.strip_prefix(REPORTS), name.strip_prefix(DERIVED)) {
            (Some(rest), _) => places.reports.join(rest),
            (_, Some(rest)) => places.derived.join(rest),
            _ => return None,
        };
        Some(as_made(name, on_disk, digest))
    });
    let provenance = places.reports.join(PROVENANCE);
    made.chain([on_disk(format!("{REPORTS}{PROVENANCE}"), provenance)])
        .collect()
}

/// Every option as the run had it, with the folders as they are in the bundle: unpacked with its raw files, the bundle is a project.
pub(super) fn configuration(config: &Config, roots: usize) -> Result<Packed> {
    let mut config = config.clone();
    config.paths.raw = (0..roots)
        .map(|k| root_in_bundle(k, roots).into())
        .collect();
    config.paths.derived = "derived".into();
    config.paths.reports = "reports".into();
    config.paths.golden = "golden".into();
    Ok(of_text(CONFIG, config.to_commented_toml()?))
}

/// How to cite the program.
pub(super) fn citation() -> Packed {
    of_text(CITATION, CITATION_TEXT.to_owned())
}

/// A file that is made for the bundle.
fn of_text(name: &str, text: String) -> Packed {
    let bytes = text.into_bytes();
    Packed {
        path: name.to_owned(),
        digest: Digest::of(&bytes),
        size: bytes.len() as u64,
        contents: Contents::Bytes(bytes),
    }
}

/// The raw files of every session, usable or not: descriptions, logs, and what they share.
pub(super) fn raw_files(
    places: &Places,
    discovery: &Discovery,
    with_raw: bool,
) -> Result<Vec<Packed>> {
    let roots = &places.raw;
    // What several sessions share, such as a campaign.toml, is one file.
    let mut found: BTreeMap<String, PathBuf> = BTreeMap::new();
    let mut add = |root: usize, below: &Path| {
        let path = roots[root].join(below);
        if let (true, Some(below)) = (path.is_file(), plain_path(below)) {
            let root = root_in_bundle(root, roots.len());
            found.entry(format!("{root}/{below}")).or_insert(path);
        }
    };
    for located in &discovery.sessions {
        let is_below = |root: &PathBuf| located.directory.starts_with(root);
        let Some(root) = roots.iter().position(is_below) else {
            continue;
        };
        let folder = Path::new(&located.relative);
        for name in located.files() {
            add(root, &folder.join(name));
        }
    }
    for unusable in &discovery.unusable {
        for root in 0..roots.len() {
            add(root, &Path::new(&unusable.relative).join(SESSION_FILE));
        }
    }
    let packed = found.into_iter().map(|(name, path)| {
        let mut file = on_disk(name, path)?;
        if !with_raw {
            file.contents = Contents::Absent;
        }
        Ok(file)
    });
    packed.collect()
}

/// The name of a raw directory in the bundle: one of its own where there are several, since two may have folders of one name.
fn root_in_bundle(root: usize, of: usize) -> String {
    let raw = RAW.trim_end_matches('/');
    match of {
        0 | 1 => raw.to_owned(),
        _ => format!("{raw}/{}", root + 1),
    }
}

/// A file as it lies there.
fn on_disk(name: String, path: PathBuf) -> Result<Packed> {
    let digest = digest::of_file(&path).map_err(Error::io("read", &path))?;
    let size = std::fs::metadata(&path).map_err(Error::io("read", &path))?;
    Ok(Packed {
        path: name,
        digest,
        size: size.len(),
        contents: Contents::File(path),
    })
}

/// A file that has to be as the run made it.
fn as_made(name: &str, path: PathBuf, made: &Digest) -> Result<Packed> {
    let shown = path.display().to_string();
    match on_disk(name.to_owned(), path) {
        Ok(file) if file.digest == *made => Ok(file),
        _ => Err(Error::Usage(format!(
            "{shown} is not as the last run made it; `pipeline run` puts it back"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_raw_directories_have_names_of_their_own() {
        assert_eq!(root_in_bundle(0, 1), "raw");
        assert_eq!(
            [root_in_bundle(0, 2), root_in_bundle(1, 2)],
            ["raw/1", "raw/2"]
        );
    }
}
