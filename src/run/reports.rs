//! The report stage over everything: first a unit of the tables, which are in place before any figure is drawn, then one of the pages.

use crate::RunOptions;
use crate::engine::Engine;
use crate::made::{Made, UnitMade};
use crate::materialize::{Shelf, Written};
use crate::stages::normalize::{self, REJECTS, ROWS};
use crate::stages::report::{STAGE, read, reads};
use crate::stages::torque::{self, REFERENCE, TORQUE};
use crate::stages::{clean, compare, fit, ingest};
use crate::step::Step;
use crate::units::Scope;
use crate::{explore, figures};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_base::row::Row;
use pipeline_cache::Entry;
use pipeline_compare::Predictions;
use pipeline_config::FitOptions;
use pipeline_fit::zeros::{usual_of_pulled, with_usual_zeros};
use pipeline_formats::discover::{Discovery, Unusable};
use pipeline_report::explorer::sample::Extent;
use pipeline_report::predictions::{Columns, Predicted};
use pipeline_report::stage as report;
use pipeline_report::stage::{GroupInput, KneeInput, Provenance, ReportInput, SessionInput, Trace};
use std::collections::BTreeMap;

/// The unit of everything that needs no page.
const TABLES: &str = "tables";
/// The unit of the pages.
const PAGES: &str = "reports";
/// The options that tables read, and pages.
const OF_TABLES: &[&str] = &["fit"];
const OF_PAGES: &[&str] = &["report", "fit"];

/// What the other stages have done.
#[derive(Clone, Copy)]
pub struct Done<'a> {
    /// What is below the raw directories.
    pub discovery: &'a Discovery,
    /// What the stages before have made.
    pub made: &'a Made,
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
            let step = engine.waits(STAGE.stage, TABLES, &on)?;
            look_at_sessions(&mut shelf, done, options)?;
            return Ok(Tables { step, shelf });
        }
    };
    let input_digest = Digest::of_named(inputs.iter());
    let part = options.config.part(OF_TABLES)?;
    let step = engine.step(STAGE.stage, TABLES, part.keyed, inputs, || {
        let input = gather(engine, done, &options.config.fit, &input_digest)?;
        report::tables(&input, &part.config)
    })?;
    if step.entry().is_some() {
        shelf.put(&step)?;
        shelf.put_sessions(done.made.of(Scope::Session), done.discovery)?;
        shelf.remember()?;
    } else {
        look_at_sessions(&mut shelf, done, options)?;
    }
    let step = step.settled();
    Ok(Tables { step, shelf })
}

/// A dry run says what is missing of the sessions even where the tables are out of date.
fn look_at_sessions(shelf: &mut Shelf, done: &Done, options: &RunOptions) -> Result<()> {
    if options.dry_run {
        shelf.link_sessions(done.made.of(Scope::Session))?;
    }
    Ok(())
}

/// Brings the pages up to date, and puts them and the figures where people look for them. `implausible`: ids of sessions whose readings no such
/// actuator gives.
///
/// # Errors
/// System errors, damaged entries.
pub fn pages(
    engine: &Engine,
    done: &Done,
    (figures, implausible): (&[Step], &[String]),
    tables: Tables,
    options: &RunOptions,
) -> Result<Written> {
    let mut shelf = tables.shelf;
    let (results, drawn) = (results(done)?, figures_drawn(done, figures));
    let listed = digest_of(&tables.step, report::TABLES, || TABLES.to_owned());
    let (mut inputs, drawn, listed) = match (results, drawn, listed) {
        (Ok(results), Ok(drawn), Ok(listed)) => (results, drawn, listed),
        (Err(on), ..) | (_, Err(on), _) | (.., Err(on)) => {
            engine.waits(STAGE.stage, PAGES, &on)?;
            return Ok(shelf.unfinished());
        }
    };
    // Of what was measured: the figures and tables say the same once more.
    let input_digest = Digest::of_named(inputs.iter());
    inputs.extend(drawn);
    inputs.insert(report::TABLES.to_owned(), listed);
    let doubted = serde_json::to_vec(implausible).map_err(Error::internal)?;
    inputs.insert("implausible sessions".to_owned(), Digest::of(&doubted));
    let part = options.config.part(OF_PAGES)?;
    let step = engine.step(STAGE.stage, PAGES, part.keyed, inputs, || {
        let input = gather(engine, done, &options.config.fit, &input_digest)?;
        let mut input = with_figures(engine, input, (done, figures), &tables.step)?;
        input.implausible = implausible.to_vec();
        report::pages(&input, &part.config)
    })?;
    if step.entry().is_none() {
        return Ok(shelf.unfinished());
    }
    figures
        .iter()
        .chain([&step])
        .try_for_each(|s| shelf.put(s))?;
    let mut written = shelf.finish(done.made.of(Scope::Session))?;
    written.left_out = figures::left_out(engine, &step)?;
    Ok(written)
}

/// Digests by name; or the first result that is not there yet.
pub(crate) type Inputs = std::result::Result<BTreeMap<String, Digest>, String>;

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

/// What was found and the outputs of the other stages.
///
/// # Errors
/// What was found cannot be written as JSON.
pub(crate) fn results(done: &Done) -> Result<Inputs> {
    let found = discovery_digest(done.discovery)?;
    Ok(of_stages(done).map(|mut inputs| {
        inputs.insert("sessions found".to_owned(), found);
        inputs
    }))
}

/// The outputs of the other stages.
fn of_stages(done: &Done) -> Inputs {
    let mut inputs = BTreeMap::new();
    for (scope, made) in done.made.all() {
        let name = &made.unit.name;
        for (stage, output) in reads(made) {
            let digest = output.ok_or_else(|| match scope {
                Scope::Session => format!("session {name}"),
                _ => format!("{stage} of {name}"),
            })?;
            inputs.insert(format!("{name} {stage}"), digest.clone());
        }
    }
    Ok(inputs)
}

/// The figures of the groups.
fn figures_drawn(done: &Done, figures: &[Step]) -> Inputs {
    let both = done.made.of(Scope::Group).iter().zip(figures);
    let one = both.map(|(group, step)| {
        let name = &group.unit.name;
        let digest = digest(step, || format!("figures of {name}"))?;
        Ok((format!("{name} figures"), digest))
    });
    one.collect()
}

/// What went into every session, fit and campaign of torque, and what came out.
fn provenance(done: &Done) -> Vec<Provenance> {
    let entry = |made: &UnitMade, stage| made.step(stage).and_then(Step::entry).cloned();
    let row = |unit: String, kind, inputs: Digest, last: &Entry| Provenance {
        unit,
        kind,
        inputs: inputs.to_string(),
        outputs: last.digest().to_string(),
    };
    let read_by = |entry: &Entry| Digest::of_named(entry.parts.inputs.iter());
    let of_sessions = done.made.of(Scope::Session).iter().filter_map(|s| {
        let (first, last) = (entry(s, ingest::NAME)?, entry(s, normalize::NAME)?);
        Some(row(s.unit.name.clone(), "session", first.digest(), &last))
    });
    let of_groups = done.made.of(Scope::Group).iter().filter_map(|g| {
        let (group, fit) = (g.unit.group.as_ref()?, entry(g, fit::NAME)?);
        let unit = format!("{}, {} mm", group.campaign, group.diameter_mm);
        Some(row(unit, "fit", read_by(&fit), &fit))
    });
    let of_torque = done.made.of(Scope::TorqueCampaign).iter().filter_map(|c| {
        let found = entry(c, torque::NAME)?;
        Some(row(c.unit.name.clone(), "torque", read_by(&found), &found))
    });
    of_sessions.chain(of_groups).chain(of_torque).collect()
}

fn discovery_digest(discovery: &Discovery) -> Result<Digest> {
    let unusable: Vec<_> = discovery
        .unusable
        .iter()
        .map(|u| (&u.relative, &u.diagnostics))
        .collect();
    let json = serde_json::to_vec(&(unusable, &discovery.diagnostics)).map_err(Error::internal)?;
    Ok(Digest::of(&json))
}

/// What tables are made of.
pub(crate) fn gather(
    engine: &Engine,
    done: &Done,
    options: &FitOptions,
    input_digest: &Digest,
) -> Result<ReportInput> {
    let made = done.made.of(Scope::Session);
    let (mut sessions, mut rows) = (Vec::with_capacity(made.len()), Vec::new());
    for session in made {
        let session_rows = read(engine, session, &ROWS)?;
        sessions.push(SessionInput {
            readings: session_rows.len(),
            ingest: read(engine, session, &ingest::HEADER)?,
            clean: read(engine, session, &clean::HEADER)?,
            normalize_rejects: read(engine, session, &REJECTS)?,
        });
        rows.extend(session_rows);
    }
    let usual_zeros = usual_of_pulled(&rows, options);
    let rows = with_usual_zeros(rows, options);
    let made = done.made.of(Scope::Group);
    let groups = made
        .iter()
        .map(|g| figures::input(engine, g, Predictions::default()));
    let groups = groups.collect::<Result<Vec<GroupInput>>>()?;
    let predicted = predicted(engine, made, &groups, &rows)?;
    let unusable = done.discovery.unusable.iter();
    Ok(ReportInput {
        unusable: unusable.map(name_and_reasons).collect(),
        diagnostics: done.discovery.diagnostics.clone(),
        sessions,
        usual_zeros,
        rows,
        predicted,
        groups,
        figures: Vec::new(),
        left_out: Vec::new(),
        tables: Vec::new(),
        implausible: Vec::new(),
        knee: knee(engine, done)?,
        traces: Vec::new(),
        logs: Vec::new(),
        provenance: provenance(done),
        input_digest: input_digest.to_string(),
    })
}

/// What models and the residual search expect of the rows.
fn predicted(
    engine: &Engine,
    made: &[UnitMade],
    groups: &[GroupInput],
    rows: &[Row],
) -> Result<Predicted> {
    let mut columns = Columns::new(rows);
    for (made, group) in made.iter().zip(groups) {
        compare::place(engine, made, &mut columns)?;
        if let Some(diagnosis) = &group.diagnosis {
            columns.put_search(group.fit.group.is_pool(), &diagnosis.residuals);
        }
    }
    Ok(columns.finish())
}

/// What was found of torque; none where nobody has measured it.
fn knee(engine: &Engine, done: &Done) -> Result<Option<KneeInput>> {
    let [shipped] = done.made.of(Scope::ShippedKnees) else {
        return Ok(None);
    };
    let campaigns = done.made.of(Scope::TorqueCampaign).iter();
    let campaigns = campaigns.map(|c| read(engine, c, &TORQUE));
    Ok(Some(KneeInput {
        campaigns: campaigns.collect::<Result<_>>()?,
        reference: read(engine, shipped, &REFERENCE)?,
    }))
}

fn name_and_reasons(unusable: &Unusable) -> (String, Vec<Diagnostic>) {
    (unusable.relative.clone(), unusable.diagnostics.clone())
}

/// The same with everything that pages show besides.
fn with_figures(
    engine: &Engine,
    mut input: ReportInput,
    (done, figures): (&Done, &[Step]),
    tables: &Step,
) -> Result<ReportInput> {
    input.traces = traces(
        engine,
        done.made.of(Scope::Session),
        &input.sessions,
        &input.rows,
    )?;
    input.logs = explore::logs(engine, done, &input, Extent::Laboratory)?;
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
    sessions: &[UnitMade],
    inputs: &[SessionInput],
    rows: &[Row],
) -> Result<Vec<Trace>> {
    report::traces_wanted(inputs, rows)
        .into_iter()
        .map(|(session, log)| {
            let (made, input) = (&sessions[session], &inputs[session]);
            let header = &input.ingest.logs[log];
            Ok(Trace {
                session: made.unit.name.clone(),
                campaign: input.ingest.session.campaign.clone(),
                log: header.spec.name(),
                simulated: input.ingest.session.is_simulated(),
                samples: made.table(engine, ingest::NAME, &header.output)?,
            })
        })
        .collect()
}
