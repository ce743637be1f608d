//! Where things are: what the command line says, else `pipeline.toml`, else the usual names.

use crate::args::{DerivedArgs, PlaceArgs, ResultArgs};
use pipeline_base::error::Result;
use pipeline_config::Config;
use pipeline_run::check_outside;
use std::path::{Path, PathBuf};

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

impl Places {
    /// Nothing below a raw directory is ever written.
    ///
    /// # Errors
    /// `output`, which `option` named, is in one.
    pub(super) fn check_outside_raw(&self, output: Option<&Path>, option: &str) -> Result<()> {
        let Some(output) = output else { return Ok(()) };
        let mut raw = self.raw.iter();
        raw.try_for_each(|raw| check_outside(raw, output, option))
    }
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
