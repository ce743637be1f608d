//! Jobs: what can be brought up to date by itself, so that other machines may share the work of a run.
//!
//! Which units there are follows from the `session.toml`s alone, so that the jobs of a campaign are known before anything has been read. A
//! job computes what it needs and does not find, so that any order of jobs is right; jobs in order never compute anything twice.

use crate::engine::name_of;
use crate::rule::Rule;
use crate::stages::{self, rules};
use crate::units::Scope;
use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_formats::discover::Discovery;
use std::collections::BTreeSet;
use std::fmt;

/// One unit of one stage. Displayed as `STAGE:UNIT`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// One of [`of_stages`].
    pub stage: &'static str,
    /// Session, group or campaign of torque, as the stage names its unit.
    pub unit: String,
    /// The sessions that it reads, as places in [`Discovery::sessions`].
    pub sessions: Vec<usize>,
    /// Stages that the same unit goes through before this one.
    pub before: Vec<&'static str>,
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.stage, self.unit)
    }
}

impl Job {
    /// The sessions of this job alone.
    pub fn narrowed(&self, discovery: &Discovery) -> Discovery {
        let sessions = self.sessions.iter().map(|k| discovery.sessions[*k].clone());
        Discovery {
            sessions: sessions.collect(),
            ..Discovery::default()
        }
    }

    /// Names of all steps that the job is made of: its own, and those before it, which are found done where jobs keep their order.
    pub fn steps(&self, discovery: &Discovery) -> BTreeSet<String> {
        let own = self.before.iter().chain([&self.stage]);
        let mut steps: BTreeSet<String> = own.map(|stage| name_of(stage, &self.unit)).collect();
        let of_sessions = stages::of_sessions();
        for k in &self.sessions {
            let id = &discovery.sessions[*k].session.id;
            steps.extend(of_sessions.iter().map(|stage| name_of(stage, id)));
        }
        steps
    }
}

/// The job of each session: all its stages, called after the last of them. Each is short, and reads what the one before it has just written.
pub fn of_session() -> &'static str {
    stages::of_sessions().last().copied().unwrap_or_default()
}

/// The stages whose units are jobs, in order; `report` is an ordinary run, when the others are done.
pub fn of_stages() -> Vec<&'static str> {
    let mut stages: Vec<&str> = jobs().map(|(stage, _)| stage).collect();
    stages.dedup();
    stages
}

/// The rules whose units are jobs: of those of sessions, the last.
fn jobs() -> impl Iterator<Item = (&'static str, &'static Rule)> {
    rules().filter(|(stage, rule)| rule.scope != Scope::Session || *stage == of_session())
}

/// The stages that a unit goes through before a rule can be applied to it.
fn before(rule: &Rule) -> Vec<&'static str> {
    if rule.scope == Scope::Session {
        let mut before = stages::of_sessions();
        before.pop();
        return before;
    }
    let mut before = BTreeSet::new();
    let mut open: Vec<&str> = rule.reads_own().collect();
    while let Some(stage) = open.pop() {
        let makers = rules().filter(|(name, maker)| *name == stage && maker.scope == rule.scope);
        open.extend(makers.flat_map(|(_, maker)| maker.reads_own()));
        before.insert(stage);
    }
    before.into_iter().collect()
}

/// All jobs, by stage.
pub fn all(discovery: &Discovery, config: &Config) -> Vec<Job> {
    let of_rule = |(stage, rule): (&'static str, &Rule)| {
        let units = rule.units(discovery, config).into_iter();
        let before = before(rule);
        let job = |unit: crate::units::Unit| Job {
            stage,
            unit: unit.name,
            sessions: unit.sessions,
            before: before.clone(),
        };
        units.map(job).collect::<Vec<Job>>()
    };
    jobs().flat_map(of_rule).collect()
}

/// The job of that name, `STAGE:UNIT`.
///
/// # Errors
/// There is none.
pub fn named(name: &str, discovery: &Discovery, config: &Config) -> Result<Job> {
    let jobs = all(discovery, config);
    let names: Vec<String> = jobs.iter().map(ToString::to_string).collect();
    let hint = match nearest(name, names.iter().map(String::as_str)) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None => "`pipeline export snakemake --json` lists them".to_owned(),
    };
    let place = names.iter().position(|n| n == name).ok_or_else(|| {
        Error::Usage(format!(
            "no job is called \"{name}\"; a job is STAGE:UNIT, with a stage of {}; {hint}",
            of_stages().join(", ")
        ))
    })?;
    Ok(jobs[place].clone())
}
