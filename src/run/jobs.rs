//! Jobs: what can be brought up to date by itself, so that other machines may share the work of a run.
//!
//! Which units there are follows from the `session.toml`s alone, so that the jobs of a campaign are known before anything has been read. A
//! job computes what it needs and does not find, so that any order of jobs is right; jobs in order never compute anything twice.

use crate::engine::name_of;
use crate::{diagnosis, groups, torque};
use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_formats::discover::Discovery;
use std::collections::BTreeSet;
use std::fmt;

/// The stages of one session, which are one job: each is short, and reads what the one before it has just written.
const OF_SESSIONS: &[&str] = &["ingest", "clean", "normalize"];
/// The stage after which a session's rows are there.
pub const ROWS: &str = "normalize";

/// The stages whose units are jobs, in order; `report` is an ordinary run, when the others are done.
pub const STAGES: &[&str] = &[ROWS, "fit", "compare", "diagnose", "torque"];

/// One unit of one stage. Displayed as `STAGE:UNIT`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// One of [`STAGES`].
    pub stage: &'static str,
    /// Session, group or campaign of torque, as the stage names its unit.
    pub unit: String,
    /// The sessions that it reads, as places in [`Discovery::sessions`].
    pub sessions: Vec<usize>,
    /// Stages that the same unit goes through before this one.
    pub before: &'static [&'static str],
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
        for k in &self.sessions {
            let id = &discovery.sessions[*k].session.id;
            steps.extend(OF_SESSIONS.iter().map(|stage| name_of(stage, id)));
        }
        steps
    }
}

/// All jobs, by stage.
pub fn all(discovery: &Discovery, config: &Config) -> Vec<Job> {
    let job = |stage, unit: String, sessions: &[usize], before| Job {
        stage,
        unit,
        sessions: sessions.to_vec(),
        before,
    };
    let sessions = discovery.sessions.iter().enumerate();
    let mut jobs: Vec<Job> = sessions
        .map(|(k, l)| job(ROWS, l.session.id.clone(), &[k], &OF_SESSIONS[..2]))
        .collect();
    for group in groups::of(discovery, &config.fit) {
        let members = places(discovery, |s| groups::belongs(&group, s));
        let unit = groups::unit(&group);
        jobs.push(job("fit", unit.clone(), &members, &[]));
        jobs.push(job("compare", unit.clone(), &members, &["fit"]));
        if diagnosis::is_asked(&group, discovery, &config.diagnose) {
            jobs.push(job("diagnose", unit, &members, &[]));
        }
    }
    let campaigns = torque::campaigns(discovery);
    for campaign in &campaigns {
        let members = places(discovery, |s| torque::belongs(campaign, s));
        jobs.push(job("torque", (*campaign).to_owned(), &members, &[]));
    }
    // What needs no session is asked for where there is one of torque.
    if let Some(first) = campaigns.first() {
        let members = places(discovery, |s| torque::belongs(first, s));
        jobs.push(job(
            "torque",
            torque::SHIPPED.to_owned(),
            &members[..1],
            &[],
        ));
    }
    jobs.sort_by_key(|job| STAGES.iter().position(|stage| *stage == job.stage));
    jobs
}

fn places(
    discovery: &Discovery,
    belongs: impl Fn(&pipeline_base::session::Session) -> bool,
) -> Vec<usize> {
    let sessions = discovery.sessions.iter().enumerate();
    let members = sessions.filter(|(_, located)| belongs(&located.session));
    members.map(|(k, _)| k).collect()
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
            STAGES.join(", ")
        ))
    })?;
    Ok(jobs[place].clone())
}
