//! Where things are: what the command line says, else `pipeline.toml`, else the usual names.

use crate::args::{DerivedArgs, PlaceArgs, ResultArgs};
use pipeline_base::error::Result;
use pipeline_config::Config;
use std::path::PathBuf;

/// The places of a command, and the options.
pub(super) struct Places {
    /// Raw directories.
    pub raw: Vec<PathBuf>,
    /// The cache and the tidy data.
    pub derived: PathBuf,
    /// Reports, tables and figures.
    pub reports: PathBuf,
    /// Golden tables.
    pub golden: PathBuf,
    /// All options.
    pub config: Config,
}

impl DerivedArgs {
    /// The places that are meant.
    ///
    /// # Errors
    /// A configuration that cannot be read or understood.
    pub(super) fn places(&self) -> Result<Places> {
        let config = Config::load(self.config.as_deref())?;
        let paths = config.paths.clone();
        Ok(Places {
            raw: paths.raw,
            derived: self.derived.clone().unwrap_or(paths.derived),
            reports: paths.reports,
            golden: paths.golden,
            config,
        })
    }
}

impl ResultArgs {
    /// The places that are meant.
    ///
    /// # Errors
    /// A configuration that cannot be read or understood.
    pub(super) fn places(&self) -> Result<Places> {
        let mut places = self.cache.places()?;
        if let Some(reports) = &self.reports {
            places.reports.clone_from(reports);
        }
        Ok(places)
    }
}

impl PlaceArgs {
    /// The places that are meant.
    ///
    /// # Errors
    /// A configuration that cannot be read or understood.
    pub(super) fn places(&self) -> Result<Places> {
        let mut places = self.results.places()?;
        if !self.raw.is_empty() {
            places.raw.clone_from(&self.raw);
        }
        Ok(places)
    }
}
