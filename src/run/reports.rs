//! The report stage: one unit, over everything.

use crate::base::error::{Error, Result};
use crate::base::row::Row;
use crate::cache::{Digest, Entry};
use crate::config::flatten;
use crate::formats::discover::Discovery;
use crate::run::RunOptions;
use crate::run::engine::{self, Engine};
use crate::run::figures;
use crate::run::groups::GroupResult;
use crate::run::materialize::{Written, materialize};
use crate::run::sessions::SessionResult;
use crate::run::step::{Stage, Step};
use crate::run::torque::TorqueResult;
use crate::stages::compare::Predictions;
use crate::stages::report::{
    self, GroupInput, KneeInput, Provenance, ReportInput, SessionInput, Trace,
};
use std::collections::BTreeMap;

/// The stage.
pub const REPORT: Stage = Stage {
    name: "report",
    version: report::VERSION,
    code: engine::REPORT,
};

/// What the other stages have done.
#[derive(Clone, Copy)]
pub struct Done<'a> {
    /// Session by session.
    pub sessions: &'a [SessionResult],
    /// Group by group.
    pub groups: &'a [GroupResult],
    /// Their figures.
    pub figures: &'a [Step],
    /// Campaign by campaign of torque.
    pub torque: &'a TorqueResult,
}

/// Brings tables, figures and reports up to date, and puts them where people look for them.
///
/// # Errors
/// System errors, damaged entries, a template that does not compile.
pub fn process(
    engine: &Engine,
    discovery: &Discovery,
    done: &Done,
    options: &RunOptions,
) -> Result<Written> {
    const UNIT: &str = "reports";
    let (mut inputs, figures) = match (results(done), figures_drawn(done)) {
        (Ok(results), Ok(figures)) => (results, figures),
        (Err(on), _) | (_, Err(on)) => {
            engine.waits(REPORT, UNIT, &on)?;
            return Ok(Written::default());
        }
    };
    inputs.insert("sessions found".to_owned(), discovery_digest(discovery)?);
    // Of what was measured: the figures say the same once more.
    let input_digest = Digest::of_named(inputs.iter());
    inputs.extend(figures);
    let mut keyed = flatten("report", &options.config.report)?;
    keyed.extend(flatten("fit", &options.config.fit)?);
    let step = engine.step(REPORT, UNIT, keyed, inputs, || {
        let input = gather(engine, discovery, done, &input_digest)?;
        report::report(&input, &options.config)
    })?;
    if step.entry().is_none() {
        return Ok(Written::default());
    }
    let steps: Vec<&Step> = done.figures.iter().chain([&step]).collect();
    materialize(engine, &steps, done.sessions, discovery, options)
}

/// Digests by name; or the first result that is not there yet.
type Inputs = std::result::Result<BTreeMap<String, Digest>, String>;

/// The digest of a step's outputs, or what is to be waited for.
fn digest(step: &Step, waits_on: impl FnOnce() -> String) -> std::result::Result<Digest, String> {
    step.entry().map(Entry::digest).ok_or_else(waits_on)
}

/// What the other stages gave.
fn results(done: &Done) -> Inputs {
    let mut inputs = BTreeMap::new();
    for session in done.sessions {
        let gave = session
            .gave()
            .ok_or_else(|| format!("session {}", session.id))?;
        inputs.extend(gave.map(|(stage, d)| (format!("{} {stage}", session.id), d.clone())));
    }
    for group in done.groups {
        for (stage, step) in group.steps() {
            let digest = digest(step, || format!("{stage} of {}", group.unit()))?;
            inputs.insert(format!("{} {stage}", group.unit()), digest);
        }
    }
    let knee = done.torque.campaigns.iter().map(|(id, s)| (id.as_str(), s));
    let shipped = done.torque.reference.iter().map(|s| ("shipped knees", s));
    for (name, step) in knee.chain(shipped) {
        let digest = digest(step, || format!("torque of {name}"))?;
        inputs.insert(format!("{name} torque"), digest);
    }
    Ok(inputs)
}

/// The figures of the groups.
fn figures_drawn(done: &Done) -> Inputs {
    let both = done.groups.iter().zip(done.figures);
    let one = both.map(|(group, step)| {
        let name = format!("{} figures", group.unit());
        digest(step, || format!("figures of {}", group.unit())).map(|d| (name, d))
    });
    one.collect()
}

/// What went into every session and fit, and what came out.
fn provenance(done: &Done) -> Vec<Provenance> {
    let row = |unit: String, kind, inputs: Digest, last: &Step| {
        Some(Provenance {
            unit,
            kind,
            inputs: inputs.to_string(),
            outputs: last.entry()?.digest().to_string(),
        })
    };
    let of_sessions = done.sessions.iter().filter_map(|s| {
        let read = s.ingest.entry()?.digest();
        row(s.id.clone(), "session", read, &s.normalize)
    });
    let of_groups = done.groups.iter().filter_map(|g| {
        let unit = format!("{}, {} mm", g.group.campaign, g.group.diameter_mm);
        row(
            unit,
            "fit",
            Digest::of_named(g.fit.entry()?.parts.inputs.iter()),
            &g.fit,
        )
    });
    let of_torque = done.torque.campaigns.iter().filter_map(|(campaign, step)| {
        let inputs = Digest::of_named(step.entry()?.parts.inputs.iter());
        row(campaign.clone(), "torque", inputs, step)
    });
    of_sessions.chain(of_groups).chain(of_torque).collect()
}

fn discovery_digest(discovery: &Discovery) -> Result<Digest> {
    let unusable: Vec<_> = discovery
        .unusable
        .iter()
        .map(|u| (&u.id, &u.relative, &u.diagnostics))
        .collect();
    let json = serde_json::to_vec(&(unusable, &discovery.diagnostics)).map_err(Error::internal)?;
    Ok(Digest::of(&json))
}

fn gather(
    engine: &Engine,
    discovery: &Discovery,
    done: &Done,
    input_digest: &Digest,
) -> Result<ReportInput> {
    let (sessions, groups) = (done.sessions, done.groups);
    let mut inputs = Vec::with_capacity(sessions.len());
    let mut rows: Vec<Row> = Vec::new();
    for result in sessions {
        let Some((ingest, clean)) = result.headers(engine)? else {
            return Err(Error::internal("a report without its sessions"));
        };
        let session_rows = result.rows(engine)?;
        inputs.push(SessionInput {
            readings: session_rows.len(),
            ingest,
            clean,
            normalize_rejects: result.normalize_rejects(engine)?,
        });
        rows.extend(session_rows);
    }
    let traces = traces(engine, sessions, &inputs, &rows)?;
    let provenance = provenance(done);
    let reference = done.torque.reference(engine)?;
    let campaigns = done.torque.campaigns(engine)?;
    let knee = reference.map(|reference| KneeInput {
        campaigns,
        reference,
    });
    let groups = groups.iter();
    let groups: Vec<GroupInput> = groups
        .map(|g| figures::input(engine, g, Predictions::default()))
        .collect::<Result<_>>()?;
    let with_section = report::with_section(&groups).into_iter();
    let figures = with_section
        .zip(done.figures)
        .map(|(shown, step)| shown.then(|| figures::drawn(engine, step)).transpose());
    let figures = figures.collect::<Result<_>>()?;
    Ok(ReportInput {
        unusable: discovery
            .unusable
            .iter()
            .map(|u| {
                (
                    u.id.clone().unwrap_or_else(|| u.relative.clone()),
                    u.diagnostics.clone(),
                )
            })
            .collect(),
        diagnostics: discovery.diagnostics.clone(),
        sessions: inputs,
        rows,
        groups,
        figures,
        knee,
        traces,
        provenance,
        input_digest: input_digest.to_string(),
    })
}

/// The samples of the logs that the report draws.
fn traces(
    engine: &Engine,
    sessions: &[SessionResult],
    inputs: &[SessionInput],
    rows: &[Row],
) -> Result<Vec<Trace>> {
    report::traces_wanted(inputs, rows)
        .into_iter()
        .map(|(session, log)| {
            let (result, input) = (&sessions[session], &inputs[session]);
            let header = &input.ingest.logs[log];
            Ok(Trace {
                session: result.id.clone(),
                campaign: input.ingest.session.campaign.clone(),
                log: header.spec.name(),
                simulated: input.ingest.session.is_simulated(),
                samples: result.samples(engine, &header.output)?,
            })
        })
        .collect()
}
