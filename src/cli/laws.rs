//! Fits and laws of mixed models that an earlier run left in `derived/`.

use pipeline_base::error::{Error, Result};
use pipeline_diagnose::mixed_law::MixedLaw;
use pipeline_fit::GroupFit;
use pipeline_predict::Laws;
use serde::de::DeserializeOwned;
use std::path::Path;

/// What an earlier run has; nothing where there was no run.
pub(super) fn of_run(derived: &Path) -> Result<Laws> {
    Ok(Laws {
        fits: fits(derived)?,
        mixed: mixed(&derived.join("mixed_laws.json"))?,
    })
}

/// The fits of an earlier run; none where there was no run.
pub(super) fn fits(derived: &Path) -> Result<Vec<GroupFit>> {
    Ok(list(&derived.join("fits.json"))?.unwrap_or_default())
}

/// The laws of its mixed models; none where it left none.
fn mixed(path: &Path) -> Result<Option<Vec<MixedLaw>>> {
    let all: Option<Vec<MixedLaw>> = list(path)?;
    if all.iter().flatten().any(|law| !law.is_sound()) {
        return Err(of_another_version(
            path,
            "its lists do not have the sizes that go with one another",
        ));
    }
    Ok(all)
}

fn list<T: DeserializeOwned>(path: &Path) -> Result<Option<Vec<T>>> {
    let text = match std::fs::read(path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(Error::io("read", path)(e)),
    };
    let all = serde_json::from_slice(&text);
    all.map(Some)
        .map_err(|e| of_another_version(path, &e.to_string()))
}

fn of_another_version(path: &Path, why: &str) -> Error {
    Error::Usage(format!(
        "{} cannot be read ({why}): it is damaged or of another version; `pipeline run` writes it anew",
        path.display()
    ))
}
