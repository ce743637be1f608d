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
pub mod explore;
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
use messages::{Described, Messages};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::error::{Error, Result};
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::session::Kind;
use pipeline_config::Config;
use pipeline_formats::discover::{Discovery, Located, discover};
use pipeline_inspect::plausible::Doubt;
use pipeline_report::left_out::LeftOut;
use pipeline_torque::doubt;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
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

impl RunOptions {
    /// A run with all defaults, of nothing yet, whose results go below a folder.
    pub fn below(folder: &Path) -> Self {
        Self {
            raw: Vec::new(),
            derived: folder.join("derived"),
            reports: folder.join("reports"),
            config: Config::default(),
            jobs: 0,
            force: None,
            dry_run: false,
            keep_going: false,
            only: None,
        }
    }
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
    /// Sessions without a result, the unusable ones first.
    pub rejected: Vec<Rejected>,
    /// Logs left out.
    pub rejected_logs: Vec<Rejected>,
    /// Sessions that their owner keeps out of every fit: id, and why.
    pub excluded: Vec<(String, String)>,
    /// Sessions of torque that their notes call in doubt, which keeps them out of the fits of the others: id, and the clause that does.
    pub doubted: Vec<(String, String)>,
    /// What is wrong with the inputs.
    pub diagnostics: Vec<Diagnostic>,
    /// Sessions whose readings no such actuator gives.
    #[serde(default)]
    pub doubtful: Vec<Doubtful>,
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
}

/// A session with readings that no such actuator gives.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Doubtful {
    /// Id of the session.
    pub session: String,
    /// Its campaign.
    pub campaign: String,
    /// Its folder relative to its raw directory.
    pub relative: String,
    /// The same as the user reaches it.
    pub folder: PathBuf,
    /// What is doubtful.
    pub doubt: Doubt,
}

/// A session or a log that was left out.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Rejected {
    /// Id of the session, or its folder where its description cannot be used.
    pub session: String,
    /// The log; empty where it is the whole session.
    pub log: String,
    /// Why.
    pub reason: String,
    /// Whether one of the diagnostics says so.
    pub has_diagnostic: bool,
    /// Where its logs were looked for; nothing unless it is a session of whose logs none is there.
    #[serde(default)]
    pub looked_for: Vec<PathBuf>,
}

impl Rejected {
    fn of(reject: Reject, has_diagnostic: bool) -> Self {
        Self {
            session: reject.session,
            log: reject.log,
            reason: reject.reason,
            has_diagnostic,
            looked_for: Vec::new(),
        }
    }
}

/// Where the logs of a session were looked for of which none is there.
fn looked_for(located: &Located) -> Vec<PathBuf> {
    let logs = located.session.logs.iter();
    if logs.clone().any(|log| !located.lacks(log)) {
        return Vec::new();
    }
    logs.map(|log| located.directory.join(&log.file)).collect()
}

impl Outcome {
    /// Whether no session is left from which anything could follow.
    pub fn has_nothing_usable(&self) -> bool {
        let rejected = self.rejected.iter().map(|r| r.session.as_str());
        let excluded = self.excluded.iter().map(|(id, _)| id.as_str());
        let lost: BTreeSet<&str> = rejected.chain(excluded).collect();
        lost.len() >= self.sessions + self.unusable
    }
}

/// Hears how far a run is.
pub trait Progress: Sync {
    /// So many units of each stage are to come.
    fn begin(&self, stages: &[(&'static str, usize)]);
    /// A stage is at work on a unit.
    fn at(&self, stage: &'static str, unit: &str);
    /// It has done that, or found the result there.
    fn done(&self, stage: &'static str, unit: &str);
    /// Something that the user should know now.
    fn note(&self, message: &str);
}

/// Hears it and says nothing.
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &[(&'static str, usize)]) {}
    fn at(&self, _: &'static str, _: &str) {}
    fn done(&self, _: &'static str, _: &str) {}
    fn note(&self, _: &str) {}
}

/// Does some work on a unit, which `progress` hears of.
fn watched<T>(
    progress: &dyn Progress,
    (stage, unit): (&'static str, &str),
    work: impl FnOnce() -> T,
) -> T {
    progress.at(stage, unit);
    let done = work();
    progress.done(stage, unit);
    done
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
    check_apart(options)?;
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
    progress.begin(&steps(discovery, config));
    let made = walk.all(progress)?;
    let done = reports::Done {
        discovery,
        made: &made,
    };
    let report = stages::report::STAGE.stage.name;
    let tables = watched(progress, (report, "tables"), || {
        pool.install(|| reports::tables(engine, &done, options))
    })?;
    let figures = parallel::each(jobs, made.of(Scope::Group), |group| {
        let unit = format!("figures of {}", group.unit.name);
        watched(progress, (report, &unit), || {
            pool.install(|| figures::process(engine, group, config))
        })
    })?;
    let only_look = options.dry_run || options.only.is_some();
    let described = Described { discovery, config };
    let sessions = made.of(Scope::Session);
    let messages = messages::all(engine, sessions, &described, (jobs, only_look))?;
    let implausible = { messages.iter() }.filter(|(_, m)| !m.doubts.is_empty());
    let implausible: Vec<String> = implausible.map(|(id, _)| id.clone()).collect();
    let written = watched(progress, (report, "documents"), || {
        let drawn = (figures.as_slice(), implausible.as_slice());
        pool.install(|| reports::pages(engine, &done, drawn, tables, options))
    })?;
    let mut outcome = summary(discovery, config, messages);
    outcome.pdfs = written.pdfs;
    outcome.written = written.changed;
    outcome.findings_file = written.findings;
    outcome.left_out = written.left_out;
    Ok(outcome)
}

/// How many units each stage has to look at; the report those of its figures, its tables and its documents.
fn steps(discovery: &Discovery, config: &Config) -> Vec<(&'static str, usize)> {
    let groups = Scope::Group.units(discovery, config).len();
    let of_stage = |declared: &rule::Declared| {
        let units = declared
            .rules
            .iter()
            .map(|r| r.units(discovery, config).len());
        (declared.stage.name, units.sum())
    };
    let stages = stages::LIST.iter().map(of_stage);
    let report = (stages::report::STAGE.stage.name, groups + 2);
    stages.filter(|(_, n)| *n > 0).chain([report]).collect()
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
///
/// # Errors
/// `output`, which `option` named, is in `raw`.
pub fn check_outside(raw: &Path, output: &Path, option: &str) -> Result<()> {
    let absolute = std::path::absolute(output).map_err(Error::io("find", output))?;
    let there = absolute.ancestors().find_map(|a| {
        let canonical = a.canonicalize().ok()?;
        Some(canonical.join(absolute.strip_prefix(a).ok()?))
    });
    match (raw.canonicalize(), there) {
        (Ok(raw), Some(there)) if there.starts_with(&raw) => Err(Error::Usage(format!(
            "{option} {} is inside the raw directory {}, where nothing is written; choose another folder",
            output.display(),
            raw.display()
        ))),
        _ => Ok(()),
    }
}

/// Reports and cache each need a folder of their own: what lies in one is removed by rules that do not know the other.
fn check_apart(options: &RunOptions) -> Result<()> {
    let absolute = |path: &Path| std::path::absolute(path).map_err(Error::io("find", path));
    let (derived, reports) = (absolute(&options.derived)?, absolute(&options.reports)?);
    let kept = ["cache", materialize::SESSIONS].map(|folder| derived.join(folder));
    if derived == reports || kept.iter().any(|folder| reports.starts_with(folder)) {
        return Err(Error::Usage(format!(
            "--reports {} is where the cache and the tidy data are (--derived {}); choose a folder of its own for the reports",
            options.reports.display(),
            options.derived.display()
        )));
    }
    Ok(())
}

fn no_sessions(options: &RunOptions, discovery: &Discovery) -> String {
    let roots: Vec<String> = options
        .raw
        .iter()
        .map(|r| r.display().to_string())
        .collect();
    let mut message = format!(
        "no session.toml below {}; a session is a folder with a session.toml and its logs: `pipeline new-session LOG` writes a first one, and --raw DIR names another place",
        roots.join(", ")
    );
    for diagnostic in &discovery.diagnostics {
        message.push_str(&format!("\n{diagnostic}"));
    }
    message
}

/// The sessions that take part in no fit because their owner says so.
fn excluded(discovery: &Discovery) -> Vec<(String, String)> {
    let sessions = discovery.sessions.iter().map(|l| &l.session);
    let excluded = sessions.filter_map(|s| Some((s.id.clone(), s.exclude.clone()?)));
    excluded.collect()
}

/// The sessions of torque that are kept apart because of a word in their notes.
fn doubted(discovery: &Discovery, config: &Config) -> Vec<(String, String)> {
    let words = &config.torque.doubtful_words;
    let sessions = discovery.sessions.iter().map(|l| &l.session);
    let of_torque = sessions.filter(|s| s.kind == Kind::KneeTorque && s.exclude.is_none());
    of_torque
        .filter_map(|s| Some((s.id.clone(), doubt::of(s.notes.as_deref()?, words)?)))
        .collect()
}

/// The messages about the inputs.
fn summary(
    discovery: &Discovery,
    config: &Config,
    mut messages: BTreeMap<String, Messages>,
) -> Outcome {
    let mut outcome = Outcome {
        sessions: discovery.sessions.len(),
        unusable: discovery.unusable.len(),
        diagnostics: discovery.diagnostics.clone(),
        excluded: excluded(discovery),
        doubted: doubted(discovery, config),
        ..Outcome::default()
    };
    for unusable in &discovery.unusable {
        let why = unusable.diagnostics.first().map_or_else(String::new, |d| {
            let place = d.column.as_deref().unwrap_or("session.toml");
            format!("{place}: found {}, expected {}", d.found, d.expected)
        });
        outcome.rejected.push(Rejected {
            session: unusable.relative.clone(),
            log: String::new(),
            reason: why,
            has_diagnostic: true,
            looked_for: Vec::new(),
        });
        outcome
            .diagnostics
            .extend(unusable.diagnostics.iter().cloned());
    }
    for located in &discovery.sessions {
        let Some(session) = messages.remove(&located.session.id) else {
            continue;
        };
        outcome.diagnostics.extend(session.diagnostics);
        let doubtful = session.doubts.into_iter().map(|doubt| Doubtful {
            session: located.session.id.clone(),
            campaign: located.session.campaign.clone(),
            relative: located.relative.clone(),
            folder: located.directory.clone(),
            doubt,
        });
        outcome.doubtful.extend(doubtful);
        let unreadable = session.unreadable.into_iter();
        let logs = unreadable.map(|r| Rejected::of(r, true));
        outcome.rejected_logs.extend(logs);
        for r in session.rejects {
            match r.extent {
                Extent::Session => outcome.rejected.push(Rejected {
                    looked_for: looked_for(located),
                    ..Rejected::of(r, false)
                }),
                _ => outcome.rejected_logs.push(Rejected::of(r, false)),
            }
        }
    }
    outcome
}
