#![warn(missing_docs)]
//! The work of a run as a workflow for an engine that runs jobs on many machines.
//!
//! A task is one job ([`jobs`]): `pipeline run --only STAGE:UNIT`, which fills the cache. Tasks know which tasks come before them and
//! which raw files they read, and an ordinary `pipeline run` ends the workflow: it finds every result in the cache and makes the reports.
//! What it gives is what it would give alone, byte for byte.
//!
//! An engine is one file with a function from [`Plan`] to text, and one line in [`ENGINES`].

mod snakemake;

use pipeline_base::error::{Error, Result};
use pipeline_base::names::file_name;
use pipeline_formats::discover::{Discovery, Located};
use pipeline_run::jobs::{self, Job};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What runs workflows.
#[derive(Clone, Copy, Debug)]
pub struct Engine {
    /// As it is named in commands.
    pub name: &'static str,
    /// The text of a plan's workflow; an error for a path that the engine cannot have.
    pub workflow: fn(&Plan) -> Result<String>,
}

/// Every engine.
pub const ENGINES: &[Engine] = &[Engine {
    name: "snakemake",
    workflow: snakemake::workflow,
}];

/// Where the workflow finds and leaves things, as every machine sees it.
#[derive(Clone, Debug)]
pub struct Places {
    /// Raw directories.
    pub raw: Vec<PathBuf>,
    /// Cache and tidy data.
    pub derived: PathBuf,
    /// Tables, figures and reports.
    pub reports: PathBuf,
    /// Configuration, if there is a file.
    pub config: Option<PathBuf>,
}

/// One job with what it waits for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Task {
    /// The job, as `--only` takes it.
    pub only: String,
    /// Its stage.
    pub stage: &'static str,
    /// Its unit as a file name.
    pub name: String,
    /// Raw files that it reads, and the configuration.
    pub files: Vec<String>,
    /// The tasks that come before it, as places in [`Plan::tasks`].
    pub after: Vec<usize>,
}

/// The work of a run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Where things are.
    pub places: Places,
    /// Threads of one job.
    pub threads: usize,
    /// Every job but the last run, each behind those that come before it.
    pub tasks: Vec<Task>,
}

impl Plan {
    /// The tasks of these jobs ([`jobs::all`]).
    ///
    /// # Errors
    /// A path that is no Unicode, which a workflow cannot hold.
    pub fn new(
        places: Places,
        threads: usize,
        discovery: &Discovery,
        jobs: &[Job],
    ) -> Result<Self> {
        let numbered = jobs.iter().enumerate();
        let at: BTreeMap<(&str, &str), usize> = numbered
            .map(|(k, job)| ((job.stage, job.unit.as_str()), k))
            .collect();
        let tasks = jobs
            .iter()
            .map(|job| task(job, &at, discovery, places.config.as_deref()));
        Ok(Self {
            tasks: tasks.collect::<Result<_>>()?,
            places,
            threads,
        })
    }

    /// Arguments of `pipeline run` that say where things are.
    ///
    /// # Errors
    /// A path that is no Unicode.
    pub fn arguments(&self) -> Result<Vec<String>> {
        let raw = self.places.raw.iter().map(|p| ("--raw", p));
        let results = [
            ("--derived", &self.places.derived),
            ("--reports", &self.places.reports),
        ];
        let config = self.places.config.iter().map(|p| ("--config", p));
        let mut arguments = Vec::new();
        for (option, path) in raw.chain(results).chain(config) {
            arguments.push(option.to_owned());
            arguments.push(text(path)?);
        }
        Ok(arguments)
    }
}

/// A job behind the jobs that come before it: those of its sessions and the stages of its own unit; `at`: where each job is, by stage and
/// unit. One that comes behind none reads raw files.
fn task(
    job: &Job,
    at: &BTreeMap<(&str, &str), usize>,
    discovery: &Discovery,
    config: Option<&Path>,
) -> Result<Task> {
    let sessions = || job.sessions.iter().map(|k| &discovery.sessions[*k]);
    let of_sessions = sessions().map(|located| (jobs::of_session(), located.session.id.as_str()));
    let of_unit = job.before.iter().map(|stage| (*stage, job.unit.as_str()));
    let before = of_sessions.chain(of_unit);
    let own = (job.stage, job.unit.as_str());
    let after: Vec<usize> = before
        .filter(|name| *name != own)
        .filter_map(|name| at.get(&name).copied())
        .collect();
    let mut files: Vec<String> = config.map(text).into_iter().collect::<Result<_>>()?;
    if after.is_empty() {
        for located in sessions() {
            files.extend(raw_files(located)?);
        }
    }
    Ok(Task {
        only: job.to_string(),
        stage: job.stage,
        name: file_name(&job.unit),
        files,
        after,
    })
}

/// The files of a session that are there: a log that is missing is reported when the session is read.
fn raw_files(located: &Located) -> Result<Vec<String>> {
    let paths = located.files().map(|name| located.directory.join(name));
    paths.filter(|p| p.is_file()).map(|p| text(&p)).collect()
}

/// A path as text.
fn text(path: &Path) -> Result<String> {
    path.to_str().map(ToOwned::to_owned).ok_or_else(|| {
        Error::Usage(format!(
            "the path {} is no Unicode, which a workflow has to be; rename it",
            path.display()
        ))
    })
}
