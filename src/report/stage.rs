//! Report: tables, figures, pages and the summary, from what the other stages left.

use crate::audit::audit_pdf;
use crate::described::Described;
use crate::explorer;
use crate::explorer::sample::Extent;
use crate::extent::{MOST_ROWS_PRINTED, SIDE_BY_SIDE};
use crate::figures::found::Kind;
use crate::figures::{self, Built, Composed, Drawn, common_readings};
use crate::force::{self, force_pdf};
use crate::knee::{self, knee_pdf};
use crate::layout::Layout;
use crate::left_out::{LeftOut, Part, Task, attempt};
use crate::pages::date_of;
use crate::render::{self, Renderer};
use crate::residual::{self, residual_pdf};
use crate::summary::summary;
use crate::supplement::{self, supplement_pdf};
use crate::table::{Table, Unit};
use crate::tables;
use crate::typeset::Pdf;
use pipeline_audit::audit;
use pipeline_audit::findings::Audit;
use pipeline_base::columns::is_reserved;
use pipeline_base::digest::Digest;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Values;
use pipeline_base::row::{self, Row, role_name};
use pipeline_base::session::{Phase, Sampling};
use pipeline_compare::GroupComparison;
use pipeline_config::{Config, ReportOptions};
use pipeline_diagnose::mixed_law::MixedLaw;
use pipeline_findings::{Findings, SCHEMA};
use pipeline_fit::{GroupFit, is_usable, split};
use pipeline_torque::tidy;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

pub use crate::extent::with_section;
pub use crate::input::{
    GroupFigures, GroupInput, KneeInput, Provenance, ReportInput, SessionInput, Trace,
};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// What the pages need of the figures of a group: [`GroupFigures`] as JSON.
pub const DRAWN: &str = "drawn.json";
/// What a unit could not build: a list of [`LeftOut`] as JSON.
pub const LEFT_OUT: &str = "left_out.json";
/// Names of the tables in their order, below `reports/`, as JSON.
pub const TABLES: &str = "tables.json";

/// The figures of one group: their files below `reports/`, [`DRAWN`], and those that could not be built in [`LEFT_OUT`].
///
/// # Errors
/// None that a figure could cause.
pub fn group_figures(group: &GroupInput, config: &Config) -> Result<Outputs> {
    let build = |composed: Vec<Composed>| {
        let composed = composed.into_iter().map(Some).collect();
        figures::build(composed, &config.report)
    };
    let of_group = build(figures::of_group(group, config));
    let (kinds, composed) = figures::of_diagnosis(group).into_iter().unzip();
    outputs_of_group(of_group, kinds, build(composed))
}

fn outputs_of_group(of_group: Built, kinds: Vec<Kind>, of_diagnosis: Built) -> Result<Outputs> {
    let drawn = GroupFigures {
        group: of_group.drawn.into_iter().flatten().collect(),
        diagnosis: with_kinds(kinds, of_diagnosis.drawn),
    };
    let left_out: Vec<LeftOut> = [of_group.left_out, of_diagnosis.left_out].concat();
    let mut outputs = below_figures(of_group.files.into_iter().chain(of_diagnosis.files));
    outputs.insert(DRAWN.to_owned(), json_bytes(&drawn)?);
    outputs.insert(LEFT_OUT.to_owned(), json_bytes(&left_out)?);
    Ok(outputs)
}

/// Drawings with what they show; without those that were left out.
fn with_kinds(kinds: Vec<Kind>, drawn: Vec<Option<Drawn>>) -> Vec<(Kind, Drawn)> {
    let both = kinds.into_iter().zip(drawn);
    both.filter_map(|(kind, drawn)| Some((kind, drawn?)))
        .collect()
}

fn below_figures(files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Outputs {
    let below = |(name, bytes)| (format!("reports/figures/{name}"), bytes);
    files.into_iter().map(below).collect()
}

fn json_bytes(value: &impl Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec(value).map_err(Error::internal)
}

/// Every table and what other programs read: all below `reports/` and `derived/` that needs neither a figure nor a page. They come first,
/// so that they are there whatever becomes of the rest.
///
/// # Errors
/// A table that cannot be written as Parquet or JSON.
pub fn tables(input: &ReportInput, config: &Config) -> Result<Outputs> {
    let rows = row::to_frame(&input.rows).with_units(units_of_extras(input));
    let predicted = input.predicted.iter();
    let rows = predicted.fold(rows, |frame, (name, forces)| {
        frame.with(name, Values::Number(forces.clone()))
    });
    let mut outputs = Outputs::from([
        ("derived/rows.parquet".to_owned(), rows.to_parquet()?),
        ("derived/split.csv".to_owned(), split_csv(input, config)),
        ("derived/fits.json".to_owned(), fits_json(input)?),
        (
            "derived/mixed_laws.json".to_owned(),
            mixed_laws_json(input)?,
        ),
        ("reports/findings.json".to_owned(), findings_json(input)?),
    ]);
    if input.knee.is_some() {
        let readings = tidy::frame(input.torque().iter()).to_parquet()?;
        outputs.insert("derived/torque.parquet".to_owned(), readings);
    }
    let mut names = Vec::new();
    let every = tables::ALL.iter().chain(tables::knee::ALL);
    let made = every.map(|of| of.all(input));
    for table in made.chain([tables::audit(&audit_of(input))]) {
        let print = tables::naming_groups(tables::in_print(&table, input));
        names.push(format!("tables/{}.csv", table.id));
        outputs.extend(table_files(&tables::naming_groups(table), print));
    }
    outputs.insert(TABLES.to_owned(), json_bytes(&names)?);
    Ok(outputs)
}

fn audit_of(input: &ReportInput) -> Audit {
    let fits: Vec<&GroupFit> = input.groups.iter().map(|g| &g.fit).collect();
    let comparisons: Vec<&GroupComparison> = input.groups.iter().map(|g| &g.comparison).collect();
    audit(&fits, &comparisons)
}

/// The pages with the figures that no group has for itself, and the summary. A figure or document that cannot be built is left out: it is in
/// the summary and in [`LEFT_OUT`], with those of the groups.
///
/// # Errors
/// None that a figure or document could cause.
pub fn pages(input: &ReportInput, config: &Config) -> Result<Outputs> {
    let built = Pictures::build(input, &config.report);
    let mut left_out = input.left_out.clone();
    left_out.extend(built.left_out);
    let made = documents(input, &built.pictures, config, &left_out);
    let mut outputs = below_figures(built.files);
    let mut layouts = BTreeMap::new();
    for (name, document) in made {
        match document {
            Ok(Some(pages)) => {
                outputs.insert(format!("reports/{name}"), pages.bytes);
                let layout = Layout {
                    sheets: pages.sheets,
                    warnings: pages.warnings,
                };
                layouts.insert(name, layout);
            }
            Ok(None) => {}
            Err(failed) => left_out.push(failed),
        }
    }
    match attempt(Part::Document, explorer::FILE, Task::Writing, || {
        explorer::html(input, Extent::Laboratory)
    }) {
        Ok(page) => {
            outputs.insert(format!("reports/{}", explorer::FILE), page.into_bytes());
        }
        Err(failed) => left_out.push(failed),
    }
    left_out.sort();
    outputs.insert(LEFT_OUT.to_owned(), json_bytes(&left_out)?);
    outputs.insert("derived/layout.json".to_owned(), json_bytes(&layouts)?);
    let summary = summary(input, &left_out)?;
    outputs.insert("reports/summary.json".to_owned(), summary);
    Ok(outputs)
}

/// The figures that no group has for itself, in the places that the pages look for them.
#[derive(Default)]
struct Pictures {
    first: Option<Drawn>,
    traces: Vec<Option<Drawn>>,
    torque: Vec<Vec<Option<Drawn>>>,
    legs: Vec<Option<Drawn>>,
    once: Vec<Option<Drawn>>,
    found: residual::Figures,
}

/// [`Pictures`] with their files, and those that could not be built.
#[derive(Default)]
struct BuiltPictures {
    pictures: Pictures,
    files: Vec<(String, Vec<u8>)>,
    left_out: Vec<LeftOut>,
}

impl Pictures {
    fn build(input: &ReportInput, options: &ReportOptions) -> BuiltPictures {
        let mut all = BuiltPictures::default();
        let mut build = |composed| {
            let built = figures::build(composed, options);
            all.files.extend(built.files);
            all.left_out.extend(built.left_out);
            built.drawn
        };
        let first = figures::compose(common_readings::NAME, || common_readings::figure(input));
        let first = build(vec![first]).into_iter().flatten().next();
        let traces = build(figures::plateaus(input));
        let campaigns = input.torque().iter().map(figures::knee::of_campaign);
        let torque = campaigns.map(&mut build).collect();
        let legs = build(figures::knee::legs(input));
        let once = build(figures::knee::once(input));
        let shown = residual::on_the_first_page(input);
        let budget = figures::compose("budget", || figures::found::budget(&shown));
        let budget = build(vec![budget]).into_iter().flatten().next();
        let joints = input.torque().iter().flat_map(|c| &c.diagnoses);
        let joints = joints.map(|joint| {
            let (kinds, composed): (Vec<_>, Vec<_>) = figures::of_joint(joint).into_iter().unzip();
            with_kinds(kinds, build(composed.into_iter().map(Some).collect()))
        });
        let joints = joints.collect();
        all.pictures = Pictures {
            first,
            traces,
            torque,
            legs,
            once,
            found: residual::Figures { budget, joints },
        };
        all
    }
}

type Document = (&'static str, std::result::Result<Option<Pdf>, LeftOut>);

/// Typesets the documents; none where there is nothing to say. `figures_left_out` are those that the pages miss.
fn documents(
    input: &ReportInput,
    pictures: &Pictures,
    config: &Config,
    figures_left_out: &[LeftOut],
) -> Vec<Document> {
    let date = date_of(input, &config.report);
    let of_force = force::Figures {
        first: pictures.first.as_ref(),
        traces: &pictures.traces,
    };
    let force = || force_pdf(input, of_force, config, figures_left_out).map(Some);
    let audit = || {
        let typeset = || audit_pdf(&audit_of(input), &input.input_digest, date);
        config.report.audit.then(typeset).transpose()
    };
    let residual = || residual_pdf(input, &pictures.found, date);
    let of_knee = knee::Figures {
        campaigns: &pictures.torque,
        legs: &pictures.legs,
        once: &pictures.once,
    };
    let knee = || knee_pdf(input, &of_knee, date);
    let supplement = || {
        let split_digest = Digest::of(&split_csv(input, config)).to_string();
        let figures = supplement::Figures {
            traces: &pictures.traces,
            knee: &of_knee,
            found: &pictures.found,
        };
        supplement_pdf(input, &figures, config, &split_digest).map(Some)
    };
    let force = || document("force.pdf", &force);
    let others = || {
        [
            document("audit.pdf", &audit),
            document("residual.pdf", &residual),
            document("knee.pdf", &knee),
            document("supplement.pdf", &supplement),
        ]
    };
    let (force, others) = if input.sessions.len() > SIDE_BY_SIDE {
        let others = others();
        (force(), others)
    } else {
        rayon::join(force, others)
    };
    [force].into_iter().chain(others).collect()
}

fn document(name: &'static str, typeset: &dyn Fn() -> Result<Option<Pdf>>) -> Document {
    let made = attempt(Part::Document, name, Task::Typesetting, typeset);
    (name, made)
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

/// `derived/fits.json`: every fit with its refits and with what is in doubt of its readings, for `pipeline predict` and for other programs.
fn fits_json(input: &ReportInput) -> Result<Vec<u8>> {
    let fit = |g: &GroupInput| GroupFit {
        doubtful: g.doubtful().cloned().collect(),
        ..g.fit.clone()
    };
    let fits: Vec<GroupFit> = input.groups.iter().map(fit).collect();
    let mut bytes = serde_json::to_vec_pretty(&fits).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// `derived/mixed_laws.json`: what the mixed models say of further readings, for `pipeline predict` and `pipeline export model`.
fn mixed_laws_json(input: &ReportInput) -> Result<Vec<u8>> {
    let diagnoses = input.groups.iter().filter_map(|g| g.diagnosis.as_ref());
    let all: Vec<&MixedLaw> = diagnoses.filter_map(|d| d.mixed_law.as_ref()).collect();
    let mut bytes = serde_json::to_vec(&all).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// `derived/split.csv`: on which side of each split every isometric reading lies. Leave-one-specimen-out folds are the specimens.
fn split_csv(input: &ReportInput, config: &Config) -> Vec<u8> {
    let rows: Vec<&Row> = input.rows.iter().filter(|r| is_usable(r)).collect();
    let parts = split::by_row(&rows, &config.fit);
    let table = Described::<(&Row, Option<split::Part>)>::new("split", "")
        .text("session", "", |(row, _)| &row.session)
        .text("log", "", |(row, _)| &row.log)
        .count("first_row", "", Unit::One, |(row, _)| row.first_row)
        .text("specimen", "", |(row, _)| &row.specimen)
        .text("role", "", |(row, _)| row.role.map(role_name))
        .text("by_row", "", |(_, part)| part.map(|p| p.name()))
        .rows(rows.into_iter().zip(parts));
    render::csv::Csv.render(&table).into_bytes()
}

/// A table in every format: the data file complete, the others as people read it and as far as they do.
fn table_files(table: &Table, in_print: Table) -> Outputs {
    let render = |renderers: &[&&dyn Renderer], table: &Table| -> Vec<(String, Vec<u8>)> {
        let name = |r: &dyn Renderer| format!("reports/tables/{}.{}", table.id, r.extension());
        let file = |r: &&&dyn Renderer| (name(**r), r.render(table).into_bytes());
        renderers.iter().map(file).collect()
    };
    let (data, print): (Vec<_>, Vec<_>) = render::ALL.iter().partition(|r| r.is_data());
    let mut files = render(&data, table);
    files.extend(render(&print, &in_print.first_rows(MOST_ROWS_PRINTED)));
    files.into_iter().collect()
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
