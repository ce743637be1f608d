//! Report: tables, figures, pages and the summary, from what the other stages left.

use crate::audit::audit;
use crate::base::columns::is_reserved;
use crate::base::error::{Error, Result};
use crate::base::reject::Extent;
use crate::base::row::{self, Row, role_name};
use crate::base::session::{Phase, Sampling};
use crate::cache::Digest;
use crate::cache::store::Outputs;
use crate::config::Config;
use crate::findings::{CampaignFindings, Findings, SCHEMA};
use crate::report::audit::audit_pdf;
use crate::report::extent::{MOST_ROWS_PRINTED, SIDE_BY_SIDE};
use crate::report::figures::found::Kind;
use crate::report::figures::{self, Drawn, Named};
use crate::report::force::{date_of, force_pdf};
use crate::report::knee::{self, knee_pdf};
use crate::report::render::{self, Renderer};
use crate::report::residual::{self, residual_pdf};
use crate::report::table::{Cell, Column, Table};
use crate::report::tables;
use crate::report::typeset::Pdf;
use crate::report::wording::sentence::sentences;
use crate::stages::compare::GroupComparison;
use crate::stages::fit::{GroupFit, is_usable, split};
use crate::stages::torque::tidy;
use rayon::prelude::*;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};

pub use crate::report::extent::with_section;
pub use crate::report::input::{
    GroupFigures, GroupInput, KneeInput, Provenance, ReportInput, SessionInput, Trace,
};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// What the pages need of the figures of a group: [`GroupFigures`] as JSON.
pub const DRAWN: &str = "drawn.json";

/// The figures of one group: their files below `reports/`, and [`DRAWN`].
///
/// # Errors
/// A figure without room.
pub fn group_figures(group: &GroupInput, config: &Config) -> Result<Outputs> {
    let drawn = GroupFigures {
        group: draw(&figures::of_group(group, config))?,
        diagnosis: draw_kinds(figures::of_diagnosis(group))?,
    };
    let all = drawn
        .group
        .iter()
        .chain(drawn.diagnosis.iter().map(|(_, d)| d));
    let files = figure_files(all, config.report.png_dpi)?;
    let mut outputs: Outputs = files.into_iter().collect();
    let json = serde_json::to_vec(&drawn).map_err(Error::internal)?;
    outputs.insert(DRAWN.to_owned(), json);
    Ok(outputs)
}

/// Everything else that goes below `reports/`, and the tidy table of all rows below `derived/`.
///
/// # Errors
/// A template that does not compile, a figure without room.
pub fn report(input: &ReportInput, config: &Config) -> Result<Outputs> {
    let traces = draw(&figures::plateaus(input))?;
    let torque: Vec<Vec<Drawn>> = input
        .torque()
        .map(|c| draw(&figures::knee::of_campaign(c)))
        .collect::<Result<_>>()?;
    let (legs, once) = (
        draw(&figures::knee::legs(input))?,
        draw(&figures::knee::once(input))?,
    );
    let knees = knee::Figures {
        campaigns: &torque,
        legs: &legs,
        once: &once,
    };
    let found = found_figures(input)?;
    let split = split_csv(input, config);
    let split_digest = Digest::of(&split).to_string();
    let fits: Vec<&GroupFit> = input.groups.iter().map(|g| &g.fit).collect();
    let comparisons: Vec<&GroupComparison> = input.groups.iter().map(|g| &g.comparison).collect();
    let audit = audit(&fits, &comparisons);
    let date = date_of(input, &config.report);
    let force_pages = || force_pdf(input, &traces, config, &split_digest);
    let other_pages = || -> Result<(Pdf, Option<Pdf>, Option<Pdf>)> {
        let audit = audit_pdf(&audit, &input.input_digest, date)?;
        let residual = residual_pdf(input, &found, date)?;
        Ok((audit, residual, knee_pdf(input, &knees, date)?))
    };
    let figures = || {
        let knees = torque.iter().flatten().chain(&legs).chain(&once);
        let all = traces.iter().chain(knees).chain(found.all());
        figure_files(all, config.report.png_dpi)
    };
    let (force_pages, (other_pages, files)) = if input.sessions.len() > SIDE_BY_SIDE {
        let others = rayon::join(other_pages, figures);
        (force_pages(), others)
    } else {
        rayon::join(force_pages, || rayon::join(other_pages, figures))
    };
    let (force_pages, (audit_pages, residual_pages, knee_pages)) = (force_pages?, other_pages?);
    let mut outputs = Outputs::from([
        ("reports/force.pdf".to_owned(), force_pages.bytes),
        ("reports/audit.pdf".to_owned(), audit_pages.bytes),
        (
            "derived/rows.parquet".to_owned(),
            row::to_frame(&input.rows)
                .with_units(units_of_extras(input))
                .to_parquet()?,
        ),
    ]);
    if let Some(pages) = residual_pages {
        outputs.insert("reports/residual.pdf".to_owned(), pages.bytes);
    }
    if let Some(pages) = knee_pages {
        let readings = tidy::frame(input.torque()).to_parquet()?;
        outputs.insert("reports/knee.pdf".to_owned(), pages.bytes);
        outputs.insert("derived/torque.parquet".to_owned(), readings);
    }
    outputs.insert("derived/fits.json".to_owned(), fits_json(&fits)?);
    outputs.insert("derived/split.csv".to_owned(), split);
    outputs.extend(files?);
    let mut names = Vec::new();
    let every = tables::ALL.iter().chain(tables::knee::ALL);
    let made = every.map(|make| make(input));
    for table in made.chain([tables::audit(&audit)]) {
        let table = tables::naming_groups(table);
        names.push(format!("tables/{}.csv", table.id));
        outputs.extend(table_files(table));
    }
    outputs.insert("reports/findings.json".to_owned(), findings_json(input)?);
    outputs.insert("reports/summary.json".to_owned(), summary(input, &names)?);
    Ok(outputs)
}

/// Units of the columns that no stage knows, where all sessions that have one agree.
fn units_of_extras(input: &ReportInput) -> BTreeMap<String, String> {
    let mut units: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let sessions = input.sessions.iter().map(|s| &s.ingest.session);
    for spec in sessions.flat_map(|session| &session.columns) {
        if !is_reserved(&spec.column) {
            units.entry(&spec.column).or_default().insert(&spec.unit);
        }
    }
    let agreed = units.into_iter().filter(|(_, units)| units.len() == 1);
    let named = agreed.filter_map(|(name, units)| Some((name, units.into_iter().next()?)));
    let given = named.filter(|(_, unit)| !unit.is_empty());
    given
        .map(|(name, unit)| (name.to_owned(), unit.to_owned()))
        .collect()
}

/// `reports/findings.json`: what was found in every campaign. A number that is not finite is null.
fn findings_json(input: &ReportInput) -> Result<Vec<u8>> {
    let findings = Findings {
        schema: SCHEMA.to_owned(),
        campaigns: input.all_findings().cloned().collect(),
    };
    let mut bytes = serde_json::to_vec_pretty(&findings).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// `derived/fits.json`: every fit with its refits, for `pipeline predict` and for other programs.
fn fits_json(fits: &[&GroupFit]) -> Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec_pretty(fits).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// `derived/split.csv`: on which side of each split every isometric reading lies. Leave-one-specimen-out folds are the specimens.
fn split_csv(input: &ReportInput, config: &Config) -> Vec<u8> {
    let rows: Vec<&Row> = input.rows.iter().filter(|r| is_usable(r)).collect();
    let parts = split::by_row(&rows, &config.fit);
    let names = ["session", "log", "first_row", "specimen", "role", "by_row"];
    let columns = names.map(|n| Column::text(n, n)).to_vec();
    let mut table = Table::new("split", "", columns);
    for (row, part) in rows.iter().zip(parts) {
        table.push(vec![
            Cell::text(&row.session),
            Cell::text(&row.log),
            Cell::Integer(row.first_row),
            Cell::text(&row.specimen),
            row.role.map_or(Cell::Empty, |r| Cell::text(role_name(r))),
            part.map_or(Cell::Empty, |p| Cell::text(p.name())),
        ]);
    }
    render::csv::Csv.render(&table).into_bytes()
}

/// A table in every format: the data file complete, the others as far as people read.
fn table_files(table: Table) -> Outputs {
    let render = |renderers: &[&&dyn Renderer], table: &Table| -> Vec<(String, Vec<u8>)> {
        let name = |r: &dyn Renderer| format!("reports/tables/{}.{}", table.id, r.extension());
        let file = |r: &&&dyn Renderer| (name(**r), r.render(table).into_bytes());
        renderers.iter().map(file).collect()
    };
    let (data, print): (Vec<_>, Vec<_>) = render::ALL.iter().partition(|r| r.is_data());
    let mut files = render(&data, &table);
    files.extend(render(&print, &table.first_rows(MOST_ROWS_PRINTED)));
    files.into_iter().collect()
}

fn draw(figures: &[Named]) -> Result<Vec<Drawn>> {
    figures.par_iter().map(Named::draw).collect()
}

fn draw_kinds(figures: Vec<(Kind, Named)>) -> Result<Vec<(Kind, Drawn)>> {
    let drawn = figures.into_par_iter();
    drawn
        .map(|(kind, named)| Ok((kind, named.draw()?)))
        .collect()
}

/// The figures of what was found that belong to no group of rows: the budget of all, and those of every joint.
fn found_figures(input: &ReportInput) -> Result<residual::Figures> {
    let shown = residual::on_the_first_page(input);
    let budget = figures::found::budget(&shown).map(|named| named.draw());
    let joints = input.torque().flat_map(|c| &c.diagnoses);
    Ok(residual::Figures {
        budget: budget.transpose()?,
        joints: joints
            .map(|j| draw_kinds(figures::of_joint(j)))
            .collect::<Result<_>>()?,
    })
}

fn figure_files<'a>(
    figures: impl Iterator<Item = &'a Drawn>,
    png_dpi: f64,
) -> Result<Vec<(String, Vec<u8>)>> {
    let all: Vec<&Drawn> = figures.collect();
    let files: Vec<Vec<(String, Vec<u8>)>> = all
        .par_iter()
        .map(|drawn| figures::files(drawn, png_dpi))
        .collect::<Result<_>>()?;
    let below = |(name, bytes)| (format!("reports/figures/{name}"), bytes);
    Ok(files.into_iter().flatten().map(below).collect())
}

/// `summary.json`: versions, digest of the inputs, sessions used and rejected with reasons, verdicts, paths of the tables.
fn summary(input: &ReportInput, tables: &[String]) -> Result<Vec<u8>> {
    let mut rejected: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (name, diagnostics) in &input.unusable {
        rejected.insert(name, diagnostics.iter().map(ToString::to_string).collect());
    }
    for reject in input.sessions.iter().flat_map(|s| s.rejects()) {
        if reject.extent == Extent::Session {
            rejected
                .entry(&reject.session)
                .or_default()
                .push(reject.reason.clone());
        }
    }
    let used = input
        .sessions
        .iter()
        .map(|s| &s.ingest.session)
        .filter(|s| !rejected.contains_key(s.id.as_str()));
    let session = |s: &crate::base::session::Session| {
        json!({
            "id": s.id, "campaign": s.campaign, "kind": row::kind_name(s.kind), "simulated": s.is_simulated(), "exclude": s.exclude,
        })
    };
    let logs: Vec<_> = input
        .sessions
        .iter()
        .flat_map(|s| s.rejects())
        .filter(|r| r.extent == Extent::Log)
        .map(|r| json!({ "session": r.session, "log": r.log, "reason": r.reason }))
        .collect();
    let verdicts: Vec<_> = input.all_findings().map(verdict_json).collect();
    let summary = json!({
        "schema": "bpa-summary/1",
        "version": env!("CARGO_PKG_VERSION"),
        "input": input.input_digest,
        "sessions_used": used.map(session).collect::<Vec<_>>(),
        "sessions_rejected": rejected.iter().map(|(id, why)| json!({ "session": id, "reasons": why })).collect::<Vec<_>>(),
        "logs_rejected": logs,
        "readings": input.rows.len(),
        "findings": "findings.json",
        "verdicts": verdicts,
        "tables": tables,
    });
    let mut bytes = serde_json::to_vec_pretty(&summary).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The answer of one campaign, pool or joint in `summary.json`.
fn verdict_json(found: &CampaignFindings) -> serde_json::Value {
    json!({
        "campaign": found.campaign, "part": found.part, "diameter_mm": found.diameter_mm, "kind": found.kind,
        "verdict": found.verdict, "unit": found.unit,
        "rmse_heldout_before": found.before.rmse_heldout, "rmse_heldout_after": found.after.rmse_heldout,
        "expected_rmse_heldout": found.expected_rmse_heldout, "sentences": sentences(found),
    })
}

/// The logs that the report draws, as positions of session and log: of every campaign of time series the log with most readings that
/// was both filled and vented.
pub fn traces_wanted(sessions: &[SessionInput], rows: &[Row]) -> Vec<(usize, usize)> {
    let mut of_log: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in rows {
        let log = of_log.entry((&row.session, &row.log)).or_default();
        log.push(row);
    }
    let mut best: BTreeMap<&str, (bool, usize, (usize, usize))> = BTreeMap::new();
    for (place, session) in sessions.iter().enumerate() {
        let s = &session.ingest.session;
        if s.sampling != Sampling::Timeseries {
            continue;
        }
        for (log, header) in session.ingest.logs.iter().enumerate() {
            let name = header.spec.name();
            let Some(readings) = of_log.get(&(s.id.as_str(), name.as_str())) else {
                continue;
            };
            let phases: BTreeSet<Option<Phase>> = readings.iter().map(|r| r.phase).collect();
            let candidate = (phases.len() > 1, readings.len(), (place, log));
            let slot = best.entry(&s.campaign).or_insert(candidate);
            if (candidate.0, candidate.1) > (slot.0, slot.1) {
                *slot = candidate;
            }
        }
    }
    best.into_values().map(|(_, _, at)| at).collect()
}
