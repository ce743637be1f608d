#![warn(missing_docs)]
//! Drives the stages: asks the cache, executes, records, explains.
//!
//! ```text
//! raw/…/session.toml + logs ── ingest ── clean ── normalize ──┐   one unit a session, in parallel
//!                                                             ├── fit ── compare ──┐   one unit a group
//!                                                             ├── diagnose ────────┤   one unit a campaign and diameter
//!                                                             ├── torque ──────────┤   one unit a campaign of torque
//!                                                             └────────────────────┴── report   tables; figures, one unit a group; pages
//! ```
//! The tables are in place before a figure is drawn or a page typeset, and a figure or document that cannot be built is left out and named.
//!
//! A stage is a declaration ([`rule`]), one file each in [`stages`]: on what it works, from what, with which options, and the function. [`walk`]
//! takes the units of one kind side by side through the stages of the list, and [`engine::Engine::step`] derives the key of each step. The
//! function of a stage is pure: it sees what is declared ([`given`]) and returns bytes; [`artifact`] makes values of them and back. `report` has
//! a name in the list and no rules, since its results are put in place between its units ([`reports`]).
//!
//! Where no file has changed at all no stage is asked ([`unchanged`]). The result is independent of the number of threads, because units meet
//! only in sorted collections. The units can also be brought up to date one by one, by many processes on one cache ([`jobs`]).

pub mod ancestry;
pub mod artifact;
pub mod cache;
pub mod code;
pub mod defect;
pub mod engine;
pub mod figures;
#[cfg(test)]
mod fingerprint;
#[cfg(test)]
mod fingerprint_tests;
pub mod given;
pub mod jobs;
pub mod made;
pub mod materialize;
pub mod messages;
pub mod parallel;
pub mod raw;
pub mod reports;
pub mod rule;
pub mod stages;
pub mod step;
pub mod unchanged;
pub mod units;
pub mod walk;

use engine::Engine;
use made::Made;
use messages::Messages;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::error::{Error, Result};
use pipeline_base::reject::Extent;
use pipeline_config::Config;
use pipeline_findings::CampaignFindings;
use pipeline_formats::discover::{Discovery, discover};
use pipeline_report::left_out::LeftOut;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use step::{Failure, Work};
use unchanged::Watch;
use units::Scope;
use walk::Walk;

pub use stages::NAMES as STAGES;

/// What a run is to do.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Raw directories, read-only.
    pub raw: Vec<PathBuf>,
    /// Cache and tidy data.
    pub derived: PathBuf,
    /// Tables, figures and reports.
    pub reports: PathBuf,
    /// Options of the stages.
    pub config: Config,
    /// Threads; 0 for as many as there are cores.
    pub jobs: usize,
    /// A stage that is done again whatever the cache holds.
    pub force: Option<String>,
    /// Look, and do nothing.
    pub dry_run: bool,
    /// A defect in one unit does not stop the units that do not need it.
    pub keep_going: bool,
    /// One job, `STAGE:UNIT`: only the cache is brought up to date for it, beside other jobs ([`jobs`]).
    pub only: Option<String>,
}

/// What a run did. What it remembers of itself for the next is without the work.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Every unit that was computed (or would be), in the order of stages and units.
    #[serde(skip)]
    pub work: Vec<Work>,
    /// Units whose results were there already.
    pub fresh: usize,
    /// Units that could not be computed, and those that need them; none unless the run was to keep going.
    #[serde(skip)]
    pub failed: Vec<Failure>,
    /// Usable sessions found.
    pub sessions: usize,
    /// Sessions whose `session.toml` cannot be used.
    pub unusable: usize,
    /// Sessions without a result, the unusable ones first: id or folder, and why.
    pub rejected: Vec<(String, String)>,
    /// Logs left out: session, log, why.
    pub rejected_logs: Vec<(String, String, String)>,
    /// What is wrong with the inputs.
    pub diagnostics: Vec<Diagnostic>,
    /// Files written below `reports/` (or that would be), because they were missing or had other contents.
    #[serde(skip)]
    pub written: Vec<PathBuf>,
    /// Reports that exist now.
    pub pdfs: Vec<PathBuf>,
    /// Figures and documents that could not be built; everything else is there.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
    /// Where the findings are, of everything that was diagnosed.
    pub findings_file: Option<PathBuf>,
    /// The answers that are new.
    #[serde(skip)]
    pub answers: Vec<CampaignFindings>,
}

/// Hears how far a run is.
pub trait Progress: Sync {
    /// So many units of a stage are to come.
    fn begin(&self, stage: &str, units: usize);
    /// One unit is done.
    fn tick(&self);
    /// Something that the user should know now.
    fn note(&self, message: &str);
}

/// Runs every stage whose inputs changed.
///
/// # Errors
/// There is nothing to work on, or a file of `derived/` or `reports/` cannot be written.
pub fn run(options: &RunOptions, progress: &dyn Progress) -> Result<Outcome> {
    for raw in &options.raw {
        check_raw(raw)?;
        check_outside(raw, &options.derived, "--derived")?;
        check_outside(raw, &options.reports, "--reports")?;
    }
    let (watch, unchanged) = Watch::begin(options, progress)?;
    if let Some(outcome) = unchanged {
        return Ok(outcome);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.jobs)
        .build()
        .map_err(Error::internal)?;
    let mut discovery = pool.install(|| discover(&options.raw));
    if discovery.sessions.is_empty() && discovery.unusable.is_empty() {
        return Err(Error::Usage(no_sessions(options, &discovery)));
    }
    let mut asked = None;
    if let Some(name) = &options.only {
        let job = jobs::named(name, &discovery, &options.config)?;
        asked = Some(job.steps(&discovery));
        discovery = job.narrowed(&discovery);
    }
    let engine = Engine::open(options, asked, progress)?;
    let mut outcome = loop {
        match drive(&engine, options, &discovery, &pool, progress) {
            Err(Error::Damaged(what)) => {
                progress.note(&format!("damaged cache: {what}; computing it again"));
                engine.restart()?;
            }
            other => break other?,
        }
    };
    if !options.dry_run {
        engine.close()?;
    }
    (outcome.work, outcome.fresh, outcome.failed) = engine.take_work()?;
    if let Some(watch) = watch
        && !options.dry_run
        && outcome.failed.is_empty()
    {
        watch.end(&engine, &outcome)?;
    }
    Ok(outcome)
}

fn drive(
    engine: &Engine,
    options: &RunOptions,
    discovery: &Discovery,
    pool: &rayon::ThreadPool,
    progress: &dyn Progress,
) -> Result<Outcome> {
    let (jobs, config) = (options.jobs, &options.config);
    let walk = Walk {
        engine,
        discovery,
        config,
        pool,
        jobs,
    };
    let made = walk.all(progress)?;
    let done = reports::Done {
        discovery,
        made: &made,
    };
    progress.begin("tables", 1);
    let tables = pool.install(|| reports::tables(engine, &done, options))?;
    progress.tick();
    let groups = made.of(Scope::Group);
    progress.begin("figures", groups.len());
    let figures = parallel::each(jobs, groups, |group| {
        let step = pool.install(|| figures::process(engine, group, config));
        progress.tick();
        step
    })?;
    progress.begin("report", 1);
    let written = pool.install(|| reports::pages(engine, &done, &figures, tables, options))?;
    progress.tick();
    let only_look = options.dry_run || options.only.is_some();
    let messages = pool.install(|| messages::all(engine, made.of(Scope::Session), only_look))?;
    let mut outcome = summary(discovery, messages);
    outcome.pdfs = written.pdfs;
    outcome.written = written.changed;
    outcome.findings_file = written.findings;
    outcome.left_out = written.left_out;
    outcome.answers = answers(engine, &made)?;
    Ok(outcome)
}

/// The answers that this run has computed.
fn answers(engine: &Engine, made: &Made) -> Result<Vec<CampaignFindings>> {
    let mut answers = Vec::new();
    for group in made.of(Scope::Group) {
        answers.extend(stages::diagnose::fresh_findings(engine, group)?);
    }
    for campaign in made.of(Scope::TorqueCampaign) {
        answers.extend(stages::torque::fresh_findings(engine, campaign)?);
    }
    Ok(answers)
}

fn check_raw(raw: &Path) -> Result<()> {
    match std::fs::read_dir(raw) {
        Ok(_) => Ok(()),
        Err(e) => Err(Error::Usage(format!(
            "cannot read the raw directory {}: {e}; give it with --raw DIR",
            raw.display()
        ))),
    }
}

/// Nothing below a raw directory is ever written.
fn check_outside(raw: &Path, output: &Path, option: &str) -> Result<()> {
    let absolute = std::path::absolute(output).map_err(Error::io("find", output))?;
    let there = absolute.ancestors().find_map(|a| {
        let canonical = a.canonicalize().ok()?;
        Some(canonical.join(absolute.strip_prefix(a).ok()?))
    });
    match (raw.canonicalize(), there) {
        (Ok(raw), Some(there)) if there.starts_with(&raw) => Err(Error::Usage(format!(
            "{option} {} lies in the raw directory {}, in which nothing is written; choose another place",
            output.display(),
            raw.display()
        ))),
        _ => Ok(()),
    }
}

fn no_sessions(options: &RunOptions, discovery: &Discovery) -> String {
    let roots: Vec<String> = options
        .raw
        .iter()
        .map(|r| r.display().to_string())
        .collect();
    let mut message = format!(
        "no session.toml below {}; a session is a folder with a session.toml and its logs (see README.md, With your own sessions)",
        roots.join(", ")
    );
    for diagnostic in &discovery.diagnostics {
        message.push_str(&format!("\n{diagnostic}"));
    }
    message
}

/// The messages about the inputs.
fn summary(discovery: &Discovery, messages: Vec<Messages>) -> Outcome {
    let mut outcome = Outcome {
        sessions: discovery.sessions.len(),
        unusable: discovery.unusable.len(),
        diagnostics: discovery.diagnostics.clone(),
        ..Outcome::default()
    };
    for unusable in &discovery.unusable {
        let why = unusable.diagnostics.first().map_or_else(String::new, |d| {
            let place = d.column.as_deref().unwrap_or("session.toml");
            format!("{place}: found {}, expected {}", d.found, d.expected)
        });
        outcome.rejected.push((unusable.relative.clone(), why));
        outcome
            .diagnostics
            .extend(unusable.diagnostics.iter().cloned());
    }
    for session in messages {
        outcome.diagnostics.extend(session.diagnostics);
        for r in session.rejects {
            match r.extent {
                Extent::Session => outcome.rejected.push((r.session, r.reason)),
                _ => outcome.rejected_logs.push((r.session, r.log, r.reason)),
            }
        }
    }
    outcome
}
