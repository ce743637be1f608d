//! The report stage over everything: first a unit of the tables, which are in place before any figure is drawn, then one of the pages.

use crate::RunOptions;
use crate::engine::{self, Engine};
use crate::figures;
use crate::groups::GroupResult;
use crate::materialize::{Shelf, Written};
use crate::sessions::SessionResult;
use crate::step::{Stage, Step};
use crate::torque::TorqueResult;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_base::row::Row;
use pipeline_cache::Entry;
use pipeline_compare::Predictions;
use pipeline_config::flatten;
use pipeline_formats::discover::{Discovery, Unusable};
use pipeline_report::stage as report;
use pipeline_report::stage::{KneeInput, Provenance, ReportInput, SessionInput, Trace};
use std::collections::BTreeMap;

/// The stage.
pub const REPORT: Stage = Stage {
    name: "report",
    version: report::VERSION,
    code: engine::REPORT,
};

/// The unit of everything that needs no page.
const TABLES: &str = "tables";
/// The unit of the pages.
const PAGES: &str = "reports";

/// What the other stages have done.
#[derive(Clone, Copy)]
pub struct Done<'a> {
    /// What is below the raw directories.
    pub discovery: &'a Discovery,
    /// Session by session.
    pub sessions: &'a [SessionResult],
    /// Group by group.
    pub groups: &'a [GroupResult],
    /// Campaign by campaign of torque.
    pub torque: &'a TorqueResult,
}

/// The tables as they were made, and where everything is put.
pub struct Tables<'a> {
    step: Step,
    shelf: Shelf<'a>,
}

/// Brings the tables and everything else that needs neither figure nor page up to date, and puts them where people look for them.
///
/// # Errors
/// System errors, damaged entries.
pub fn tables<'a>(engine: &'a Engine, done: &Done, options: &'a RunOptions) -> Result<Tables<'a>> {
    let mut shelf = Shelf::new(engine, options);
    let inputs = match results(done)? {
        Ok(inputs) => inputs,
        Err(on) => {
            let step = engine.waits(REPORT, TABLES, &on)?;
            return Ok(Tables { step, shelf });
        }
    };
    let input_digest = Digest::of_named(inputs.iter());
    let keyed = flatten("fit", &options.config.fit)?;
    let step = engine.step(REPORT, TABLES, keyed, inputs, || {
        let input = gather(engine, done, &input_digest)?;
        report::tables(&input, &options.config)
    })?;
    if step.entry().is_some() {
        shelf.put(&step)?;
        shelf.put_sessions(done.sessions, done.discovery)?;
        shelf.remember()?;
    }
    let step = step.settled();
    Ok(Tables { step, shelf })
}

/// Brings the pages up to date, and puts them and the figures where people look for them.
///
/// # Errors
/// System errors, damaged entries.
pub fn pages(
    engine: &Engine,
    done: &Done,
    figures: &[Step],
    tables: Tables,
    options: &RunOptions,
) -> Result<Written> {
    let mut shelf = tables.shelf;
    let (results, drawn) = (results(done)?, figures_drawn(done, figures));
    let listed = digest_of(&tables.step, report::TABLES, || TABLES.to_owned());
    let (mut inputs, drawn, listed) = match (results, drawn, listed) {
        (Ok(results), Ok(drawn), Ok(listed)) => (results, drawn, listed),
        (Err(on), ..) | (_, Err(on), _) | (.., Err(on)) => {
            engine.waits(REPORT, PAGES, &on)?;
            return Ok(shelf.unfinished());
        }
    };
    // Of what was measured: the figures and tables say the same once more.
    let input_digest = Digest::of_named(inputs.iter());
    inputs.extend(drawn);
    inputs.insert(report::TABLES.to_owned(), listed);
    let mut keyed = flatten("report", &options.config.report)?;
    keyed.extend(flatten("fit", &options.config.fit)?);
    let step = engine.step(REPORT, PAGES, keyed, inputs, || {
        let input = gather(engine, done, &input_digest)?;
        let input = with_figures(engine, input, (done, figures), &tables.step)?;
        report::pages(&input, &options.config)
    })?;
    if step.entry().is_none() {
        return Ok(shelf.unfinished());
    }
    figures
        .iter()
        .chain([&step])
        .try_for_each(|s| shelf.put(s))?;
    let mut written = shelf.finish(done.sessions)?;
    written.left_out = figures::left_out(engine, &step)?;
    Ok(written)
}

/// Digests by name; or the first result that is not there yet.
type Inputs = std::result::Result<BTreeMap<String, Digest>, String>;

/// The digest of a step's outputs, or what is to be waited for.
fn digest(step: &Step, waits_on: impl FnOnce() -> String) -> std::result::Result<Digest, String> {
    step.entry().map(Entry::digest).ok_or_else(waits_on)
}

/// The digest of one output of a step, or what is to be waited for.
fn digest_of(
    step: &Step,
    output: &str,
    waits_on: impl FnOnce() -> String,
) -> std::result::Result<Digest, String> {
    let object = step.entry().and_then(|e| e.outputs.get(output));
    object.map(|o| o.digest.clone()).ok_or_else(waits_on)
}

/// What was found and what the other stages gave.
///
/// # Errors
/// What was found cannot be written as JSON.
fn results(done: &Done) -> Result<Inputs> {
    let found = discovery_digest(done.discovery)?;
    Ok(of_stages(done).map(|mut inputs| {
        inputs.insert("sessions found".to_owned(), found);
        inputs
    }))
}

/// What the other stages gave.
fn of_stages(done: &Done) -> Inputs {
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
fn figures_drawn(done: &Done, figures: &[Step]) -> Inputs {
    let both = done.groups.iter().zip(figures);
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

/// What tables are made of.
fn gather(engine: &Engine, done: &Done, input_digest: &Digest) -> Result<ReportInput> {
    let (mut sessions, mut rows) = (Vec::with_capacity(done.sessions.len()), Vec::new());
    for result in done.sessions {
        let Some((ingest, clean)) = result.headers(engine)? else {
            return Err(Error::internal("a report without its sessions"));
        };
        let session_rows = result.rows(engine)?;
        sessions.push(SessionInput {
            readings: session_rows.len(),
            ingest,
            clean,
            normalize_rejects: result.normalize_rejects(engine)?,
        });
        rows.extend(session_rows);
    }
    let campaigns = done.torque.campaigns(engine)?;
    let knee = done.torque.reference(engine)?.map(|reference| KneeInput {
        campaigns,
        reference,
    });
    let groups = done.groups.iter();
    let groups = groups.map(|g| figures::input(engine, g, Predictions::default()));
    let unusable = done.discovery.unusable.iter();
    Ok(ReportInput {
        unusable: unusable.map(name_and_reasons).collect(),
        diagnostics: done.discovery.diagnostics.clone(),
        sessions,
        rows,
        groups: groups.collect::<Result<_>>()?,
        figures: Vec::new(),
        left_out: Vec::new(),
        tables: Vec::new(),
        knee,
        traces: Vec::new(),
        provenance: provenance(done),
        input_digest: input_digest.to_string(),
    })
}

fn name_and_reasons(unusable: &Unusable) -> (String, Vec<Diagnostic>) {
    let name = unusable.id.as_ref().unwrap_or(&unusable.relative);
    (name.clone(), unusable.diagnostics.clone())
}

/// The same with everything that pages show besides.
fn with_figures(
    engine: &Engine,
    mut input: ReportInput,
    (done, figures): (&Done, &[Step]),
    tables: &Step,
) -> Result<ReportInput> {
    input.traces = traces(engine, done.sessions, &input.sessions, &input.rows)?;
    let with_section = report::with_section(&input.groups).into_iter();
    let drawn = with_section
        .zip(figures)
        .map(|(shown, step)| shown.then(|| figures::drawn(engine, step)).transpose());
    input.figures = drawn.collect::<Result<_>>()?;
    for step in figures {
        input.left_out.extend(figures::left_out(engine, step)?);
    }
    let names = engine.read(tables, report::TABLES)?;
    input.tables = serde_json::from_slice(&names).map_err(Error::internal)?;
    Ok(input)
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
