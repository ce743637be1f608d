//! Where things are.

use crate::documented::Comments;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

documented! {
/// Where things are. No result depends on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathOptions {
    /// Raw directories, read-only.
    pub raw: Vec<PathBuf>,
    /// The cache and the tidy data.
    pub derived: PathBuf,
    /// Reports, tables and figures.
    pub reports: PathBuf,
    /// Golden tables and golden.toml, for `pipeline check`.
    pub golden: PathBuf,
}
}

impl Default for PathOptions {
    fn default() -> Self {
        Self {
            raw: vec!["raw".into()],
            derived: "derived".into(),
            reports: "reports".into(),
            golden: "tests/golden".into(),
        }
    }
}

impl PathOptions {
    /// The same paths from the folder in which the command runs, of a file in `folder`.
    pub(crate) fn from(self, folder: &Path) -> Self {
        Self {
            raw: self.raw.iter().map(|raw| folder.join(raw)).collect(),
            derived: folder.join(self.derived),
            reports: folder.join(self.reports),
            golden: folder.join(self.golden),
        }
    }
}
