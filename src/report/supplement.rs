//! The pages of `supplement.pdf`: what stands behind the other reports and nobody needs to follow them. Specimens, statistics, intervals and
//! further figures group by group; geometry, models and further figures of torque; sessions, zeros and provenance.

use crate::extent::{MOST_GROUPS, MOST_ROWS_ON_PAGES, SIDE_BY_SIDE};
use crate::figures::{self, Drawn, slug};
use crate::input::{GroupInput, ReportInput};
use crate::knee;
use crate::pages::{Included, PageData, Picture, date_of};
use crate::residual;
use crate::table::Table;
use crate::tables;
use crate::typeset::Pdf;
use crate::wording::name::model_name;
use crate::wording::sentence::counted;
use pipeline_base::error::Result;
use pipeline_config::Config;
use pipeline_torque::{CampaignTorque, Test};
use serde::Serialize;

const TEMPLATE: &str = include_str!("templates/supplement.typ");

/// The data of the template.
#[derive(Serialize)]
struct Own {
    /// The tables that the document has once.
    once: Vec<Included>,
    groups: Vec<Group>,
    torque: Vec<Torque>,
    /// Tables of the legs and routes, by id.
    geometry: Vec<Included>,
    legs: Vec<Picture>,
    /// What was found, for what varies from group to group and the coefficients.
    residual: Vec<residual::Campaign>,
    traces: Vec<Picture>,
    split: Split,
}

/// How readings were parted.
#[derive(Serialize)]
struct Split {
    seed: u64,
    train_percent: f64,
    digest: String,
}

/// One group of rows.
#[derive(Serialize)]
struct Group {
    name: String,
    simulated: bool,
    tables: Vec<Included>,
    domain: Vec<String>,
    figures: Vec<Picture>,
}

/// One campaign of torque.
#[derive(Serialize)]
struct Torque {
    name: String,
    simulated: bool,
    tables: Vec<Included>,
    /// What their owners say of tests: session, words.
    notes: Vec<(String, String)>,
    figures: Vec<Picture>,
}

/// The figures that no group has for itself.
pub struct Figures<'a> {
    /// The logs with their plateaus.
    pub traces: &'a [Option<Drawn>],
    /// Of torque.
    pub knee: &'a knee::Figures<'a>,
    /// Of what was found.
    pub found: &'a residual::Figures,
}

/// Typesets `supplement.pdf`.
///
/// # Errors
/// A template that does not compile.
pub fn supplement_pdf(
    input: &ReportInput,
    figures: &Figures,
    config: &Config,
    split_digest: &str,
) -> Result<Pdf> {
    let traces = &figures.traces[..figures.traces.len().min(MOST_GROUPS)];
    let geometry: Vec<_> = tables::knee::supplementary(input).collect();
    let once = tables::supplementary(input);
    let split = Split {
        seed: config.fit.seed,
        train_percent: 100.0 * config.fit.train_fraction,
        digest: split_digest.to_owned(),
    };
    let own = pages(input, figures, traces, [&once, &geometry], split);
    let sessions = input.sessions.iter();
    let simulated = sessions.map(|s| s.ingest.session.is_simulated());
    let of_groups = input.with_section();
    let of_groups = of_groups.flat_map(|(g, _)| tables::supplementary_of_group(g));
    let of_torque = input.torque().iter();
    let of_torque = of_torque.flat_map(tables::knee::supplementary_of_campaign);
    let all = once.into_iter().chain(of_groups);
    let all = all.chain(geometry).chain(of_torque);
    let document = PageData::new(&input.input_digest, simulated, own)
        .document(TEMPLATE, date_of(input, &config.report))?
        .with_tables(all.map(|t| t.first_rows(MOST_ROWS_ON_PAGES)))
        .with_figures(drawn(input, figures, traces));
    if input.sessions.len() > SIDE_BY_SIDE {
        return document.forgotten().compile();
    }
    document.compile()
}

/// The data of the template, from the tables that the document has once and those of legs and routes.
fn pages(
    input: &ReportInput,
    figures: &Figures,
    traces: &[Option<Drawn>],
    [once, geometry]: [&[Table]; 2],
    split: Split,
) -> Own {
    let of_campaigns = input.torque().iter().zip(figures.knee.campaigns);
    let legs = figures.knee.legs.iter().flatten();
    let sections = residual::sections(input, figures.found).into_iter();
    let traces = traces.iter().zip(&input.traces);
    Own {
        groups: input
            .with_section()
            .map(|(g, drawn)| group(g, &drawn.group))
            .collect(),
        torque: of_campaigns.map(|(c, drawn)| torque(c, drawn)).collect(),
        once: once.iter().map(Included::new).collect(),
        geometry: geometry.iter().map(Included::new).collect(),
        legs: legs.map(Picture::new).collect(),
        residual: sections.filter(residual::Campaign::varies).collect(),
        traces: traces
            .filter_map(|(drawn, trace)| {
                Some(Picture::new(drawn.as_ref()?).simulated(trace.simulated))
            })
            .collect(),
        split,
    }
}

/// Every figure that the pages may show.
fn drawn<'a>(
    input: &'a ReportInput,
    figures: &'a Figures,
    traces: &'a [Option<Drawn>],
) -> impl Iterator<Item = &'a Drawn> {
    let legs = figures.knee.legs.iter().flatten();
    let of_groups = input.with_section().flat_map(|(_, drawn)| &drawn.group);
    let of_torque = figures.knee.campaigns.iter().flatten().flatten();
    let of_residual = input.with_section().flat_map(|(_, drawn)| &drawn.diagnosis);
    let of_residual = of_residual.chain(figures.found.joints.iter().flatten());
    let of_residual = of_residual.map(|(_, drawn)| drawn);
    traces
        .iter()
        .flatten()
        .chain(legs)
        .chain(of_groups)
        .chain(of_torque)
        .chain(of_residual)
}

fn group(input: &GroupInput, drawn: &[Drawn]) -> Group {
    let of = &input.fit.group;
    let name = slug(input);
    let filled = tables::supplementary_of_group(input).filter(|t| !t.rows.is_empty());
    let further = drawn.iter().filter(|d| figures::is_supplementary(d, &name));
    Group {
        name: format!("{}, {} mm", of.campaign, of.diameter_mm),
        simulated: of.simulated,
        tables: filled.map(|t| Included::new(&t)).collect(),
        domain: domain(input),
        figures: further.map(Picture::new).collect(),
    }
}

fn torque(c: &CampaignTorque, drawn: &[Option<Drawn>]) -> Torque {
    let tests = c.configurations.iter().flat_map(|c| &c.tests);
    let note = |t: &Test| Some((t.session.clone(), t.notes.clone()?));
    let filled = tables::knee::supplementary_of_campaign(c).filter(|t| !t.rows.is_empty());
    Torque {
        name: c.campaign.clone(),
        simulated: c.simulated,
        tables: filled.map(|t| Included::new(&t)).collect(),
        notes: tests.filter_map(note).collect(),
        figures: knee::further_configurations(c, drawn)
            .map(Picture::new)
            .collect(),
    }
}

/// Where models end, as sentences.
fn domain(input: &GroupInput) -> Vec<String> {
    let comparisons = &input.comparison.comparisons;
    let title = |id| {
        let found = comparisons.iter().find(|c| c.model == id);
        found.map_or(id, |c| model_name(id, &c.title))
    };
    let notes = input.comparison.domain.iter();
    notes
        .map(|note| {
            let what = if note.excluded {
                "no prediction for"
            } else {
                "extrapolates for"
            };
            format!(
                "{}: {what} {} ({})",
                title(note.model.as_str()),
                counted(note.count, "reading", "readings"),
                note.reason
            )
        })
        .collect()
}
