//! The report stage: one unit, over everything.

use crate::base::error::{Error, Result};
use crate::base::row::Row;
use crate::cache::Digest;
use crate::config::flatten;
use crate::formats::discover::Discovery;
use crate::run::RunOptions;
use crate::run::engine::{self, Engine, Stage, Step};
use crate::run::groups::GroupResult;
use crate::run::materialize::{Written, materialize};
use crate::run::sessions::SessionResult;
use crate::run::torque::TorqueResult;
use crate::stages::report::{
    self, GroupInput, KneeInput, Provenance, ReportInput, SessionInput, Trace,
};
use std::collections::BTreeMap;

const REPORT: Stage = Stage {
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
    let (sessions, groups) = (done.sessions, done.groups);
    const UNIT: &str = "reports";
    let discovered = discovery_digest(discovery)?;
    let mut inputs = BTreeMap::from([("sessions found".to_owned(), discovered)]);
    for session in sessions {
        let (Some(i), Some(c), Some(n)) = (
            session.ingest.entry(),
            session.clean.entry(),
            session.normalize.entry(),
        ) else {
            engine.waits(REPORT, UNIT, &format!("session {}", session.id))?;
            return Ok(Written::default());
        };
        for (stage, entry) in [("ingest", i), ("clean", c), ("normalize", n)] {
            inputs.insert(format!("{} {stage}", session.id), entry.digest());
        }
    }
    for result in groups {
        let (Some(f), Some(c)) = (result.fit.entry(), result.compare.entry()) else {
            engine.waits(REPORT, UNIT, &format!("fit of {}", result.group.campaign))?;
            return Ok(Written::default());
        };
        let name = format!("{} {} mm", result.group.campaign, result.group.diameter_mm);
        inputs.insert(format!("{name} fit"), f.digest());
        inputs.insert(format!("{name} compare"), c.digest());
        if let Some(diagnose) = &result.diagnose {
            let Some(d) = diagnose.entry() else {
                engine.waits(REPORT, UNIT, &format!("diagnose of {name}"))?;
                return Ok(Written::default());
            };
            inputs.insert(format!("{name} diagnose"), d.digest());
        }
    }
    let knee = done.torque.campaigns.iter().map(|(id, s)| (id.as_str(), s));
    let shipped = done.torque.reference.iter().map(|s| ("shipped knees", s));
    for (name, step) in knee.chain(shipped) {
        let Some(entry) = step.entry() else {
            engine.waits(REPORT, UNIT, &format!("torque of {name}"))?;
            return Ok(Written::default());
        };
        inputs.insert(format!("{name} torque"), entry.digest());
    }
    let mut keyed = flatten("report", &options.config.report)?;
    keyed.extend(flatten("fit", &options.config.fit)?);
    let input_digest = Digest::of_named(inputs.iter());
    let step = engine.step(REPORT, UNIT, keyed, inputs, || {
        let input = gather(engine, discovery, done, &input_digest)?;
        report::report(&input, &options.config)
    })?;
    if step.entry().is_none() {
        return Ok(Written::default());
    }
    materialize(engine, &step, sessions, options)
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
    let groups = groups
        .iter()
        .map(|g| {
            Ok(GroupInput {
                fit: g.fitted(engine)?,
                comparison: g.compared(engine)?,
                predictions: g.predictions(engine)?,
                diagnosis: g.diagnosed(engine)?,
            })
        })
        .collect::<Result<_>>()?;
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
