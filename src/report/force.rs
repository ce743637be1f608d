//! The pages of `force.pdf`: what was measured, what was left out, the model, its coefficients, the comparison, the figures.

use crate::extent::{MOST_NAMED, MOST_ROWS_ON_PAGES, SIDE_BY_SIDE};
use crate::figures::{Drawn, is_supplementary, slug};
use crate::input::{GroupInput, ReportInput, SessionInput};
use crate::left_out::LeftOut;
use crate::number::Rounding;
use crate::opening;
use crate::pages::{Included, PageData, Picture, date_of};
use crate::tables;
use crate::typeset::Pdf;
use crate::wording::name::{capitalised, loss, model_name};
use crate::wording::number::{error, error_or_none, percent, rounded, with_unit};
use crate::wording::sentence::{implausible, in_doubt};
use pipeline_base::error::Result;
use pipeline_base::reject::Extent;
use pipeline_base::session::{Kind, Session};
use pipeline_clean::zero::ZeroSource;
use pipeline_compare::NEW;
use pipeline_config::Config;
use pipeline_fit::equations::JOINT;
use pipeline_fit::zeros::{FAR_FROM_OTHERS, beside_others};
use pipeline_mechanics::models::new;
use serde::Serialize;

const TEMPLATE: &str = include_str!("templates/force.typ");

/// The data of the template.
#[derive(Serialize)]
struct Own {
    title: String,
    authors: Vec<String>,
    counts: Counts,
    opening: Vec<opening::Line>,
    models: Vec<&'static str>,
    /// The figure of the first page.
    first_figure: Option<Picture>,
    campaigns: Vec<Campaign>,
    groups: Vec<Group>,
    further_groups: Vec<String>,
    /// A log with its plateaus.
    trace: Option<Picture>,
    /// Zeros that hold a pull and gave way to the usual one of their campaign.
    replaced_zeros: Vec<DoubtfulZero>,
    more_replaced_zeros: usize,
    /// Zeros that are far from those of the other sessions of their campaign, and were taken off.
    doubtful_zeros: Vec<DoubtfulZero>,
    more_doubtful_zeros: usize,
    /// Sessions whose readings no such actuator gives, in a sentence; empty where there are none.
    implausible: String,
    unusable: Vec<String>,
    more_unusable: usize,
    /// Figures that could not be built.
    left_out: Vec<String>,
    more_left_out: usize,
}

#[derive(Serialize)]
struct Counts {
    sessions: usize,
    rejected_sessions: usize,
    rows: String,
    readings: String,
    /// How many of the readings are torques; empty where none is.
    torques: String,
    rejected_logs: usize,
}

#[derive(Serialize)]
struct Campaign {
    id: String,
    simulated: bool,
    excluded: Vec<Excluded>,
    sessions: usize,
    knee: bool,
}

/// A zero in doubt: session, what its log says, and the median of the others.
#[derive(Serialize)]
pub(crate) struct DoubtfulZero {
    session: String,
    logged: String,
    others: String,
}

/// Sessions that are kept out of every fit for one reason.
#[derive(Serialize)]
struct Excluded {
    why: String,
    /// The first of them.
    named: Vec<String>,
    /// How many more there are.
    more: usize,
}

impl Excluded {
    fn add(excluded: &mut Vec<Self>, why: &str, session: &str) {
        let place = excluded.iter().position(|e| e.why == why);
        let place = place.unwrap_or_else(|| {
            excluded.push(Self {
                why: why.to_owned(),
                named: Vec::new(),
                more: 0,
            });
            excluded.len() - 1
        });
        let of_reason = &mut excluded[place];
        if of_reason.named.len() < MOST_NAMED {
            of_reason.named.push(session.to_owned());
        } else {
            of_reason.more += 1;
        }
    }
}

#[derive(Serialize)]
struct Group {
    campaign: String,
    pooled: Vec<String>,
    diameter_mm: u32,
    simulated: bool,
    rows: usize,
    specimens: usize,
    kept_out: usize,
    excluded: usize,
    ci_method: String,
    loss: String,
    rmse_train: String,
    rmse_unseen: Option<String>,
    /// A published model that is better on unseen specimens, and its error.
    better: Option<(String, String)>,
    borrowed: bool,
    notes: Vec<String>,
    tables: Vec<Included>,
    figures: Vec<Picture>,
}

/// The figures that no group has for itself.
#[derive(Clone, Copy)]
pub struct Figures<'a> {
    /// That of the first page.
    pub first: Option<&'a Drawn>,
    /// The logs with their plateaus, in the order of the input.
    pub traces: &'a [Option<Drawn>],
}

/// Typesets `force.pdf`; `left_out` are all figures that could not be built.
///
/// # Errors
/// A template that does not compile.
pub fn force_pdf(
    input: &ReportInput,
    figures: Figures,
    config: &Config,
    left_out: &[LeftOut],
) -> Result<Pdf> {
    let options = &config.report;
    let trace = figures.traces.iter().zip(&input.traces);
    let trace = trace.filter_map(|(drawn, trace)| Some((drawn.as_ref()?, trace)));
    let trace = trace.min_by_key(|(_, trace)| trace.simulated);
    let own = Own {
        first_figure: figures.first.map(Picture::new),
        trace: trace.map(|(drawn, trace)| Picture::new(drawn).simulated(trace.simulated)),
        more_left_out: left_out.len().saturating_sub(MOST_NAMED),
        left_out: names_of(left_out),
        ..own(input, config)
    };
    let simulated = input
        .sessions
        .iter()
        .map(|s| s.ingest.session.is_simulated());
    let tables_of_groups = input.with_section().flat_map(|(g, _)| tables::of_group(g));
    let tables = tables::once(input).into_iter().chain(tables_of_groups);
    let of_groups = input.with_section().flat_map(|(_, f)| &f.group);
    let once = figures
        .first
        .into_iter()
        .chain(trace.map(|(drawn, _)| drawn));
    let document = PageData::new(&input.input_digest, simulated, own)
        .document(TEMPLATE, date_of(input, options))?
        .with_tables(tables.map(|t| t.first_rows(MOST_ROWS_ON_PAGES)))
        .with_figures(once.chain(of_groups));
    if input.sessions.len() > SIDE_BY_SIDE {
        return document.forgotten().compile();
    }
    document.compile()
}

/// The zeros that are far from those of the other sessions of their campaign, in the order of the sessions, but for those that were replaced.
pub(crate) fn doubtful_zeros(input: &ReportInput) -> Vec<DoubtfulZero> {
    let zeros: Vec<(&Session, f64)> = logged_zeros(input).collect();
    let doubtful = |(session, logged): &(&Session, f64)| {
        let others = zeros
            .iter()
            .filter(|(other, _)| other.campaign == session.campaign && other.id != session.id);
        let others: Vec<f64> = others.map(|(_, n)| *n).collect();
        let beside = beside_others(*logged, &others)?;
        let is_far = beside.deviations.abs() > FAR_FROM_OTHERS;
        let is_taken_off = !input.usual_zeros.contains_key(&session.id);
        (is_far && is_taken_off).then(|| DoubtfulZero::of(session, *logged, beside.median))
    };
    zeros.iter().filter_map(doubtful).collect()
}

/// The zeros that hold a pull, in the order of the sessions.
pub(crate) fn replaced_zeros(input: &ReportInput) -> Vec<DoubtfulZero> {
    let replaced = logged_zeros(input).filter_map(|(session, logged)| {
        let usual = input.usual_zeros.get(&session.id)?;
        Some(DoubtfulZero::of(session, logged, *usual))
    });
    replaced.collect()
}

/// What the clean stage found of the zeros of the sessions, N.
fn logged_zeros(input: &ReportInput) -> impl Iterator<Item = (&Session, f64)> {
    input.sessions.iter().filter_map(|s| {
        let zero = s.clean.zero.as_ref()?;
        (zero.source != ZeroSource::None).then_some((&s.ingest.session, zero.applied_n))
    })
}

impl DoubtfulZero {
    fn of(session: &Session, logged: f64, others: f64) -> Self {
        let newtons = |x: f64| with_unit(&rounded(x, Rounding::Decimals(1)), "N");
        Self {
            session: session.id.clone(),
            logged: newtons(logged),
            others: newtons(others),
        }
    }
}

/// A count with its thousands apart.
fn grouped(count: f64) -> String {
    rounded(count, Rounding::Decimals(0))
}

/// The names of the first figures that could not be built.
fn names_of(left_out: &[LeftOut]) -> Vec<String> {
    let named = left_out.iter().take(MOST_NAMED);
    named.map(|l| l.name.clone()).collect()
}

fn own(input: &ReportInput, config: &Config) -> Own {
    let options = &config.report;
    let rejects = || input.sessions.iter().flat_map(|s| s.rejects());
    let of_extent = |extent: Extent| rejects().filter(|r| r.extent == extent).count();
    let authors = options
        .author
        .split(',')
        .map(|a| a.trim().to_owned())
        .filter(|a| !a.is_empty());
    let unusable = input.unusable.iter().flat_map(|(_, all)| all);
    let doubtful_zeros = doubtful_zeros(input);
    let replaced_zeros = replaced_zeros(input);
    Own {
        title: options.title.clone(),
        authors: authors.collect(),
        counts: Counts {
            sessions: input.sessions.len(),
            rejected_sessions: input.unusable.len() + of_extent(Extent::Session),
            rows: grouped(input.sessions.iter().map(|s| s.clean.rows).sum::<u64>() as f64),
            readings: grouped(input.rows.len() as f64),
            torques: match torques(input) {
                0 => String::new(),
                n => grouped(n as f64),
            },
            rejected_logs: of_extent(Extent::Log),
        },
        opening: opening::lines(input),
        models: opening::models(),
        first_figure: None,
        campaigns: campaigns(input),
        more_replaced_zeros: replaced_zeros.len().saturating_sub(MOST_NAMED),
        replaced_zeros: replaced_zeros.into_iter().take(MOST_NAMED).collect(),
        more_doubtful_zeros: doubtful_zeros.len().saturating_sub(MOST_NAMED),
        doubtful_zeros: doubtful_zeros.into_iter().take(MOST_NAMED).collect(),
        groups: input
            .with_section()
            .map(|(g, f)| group(g, &f.group))
            .collect(),
        further_groups: further_groups(input),
        trace: None,
        implausible: implausible(&input.implausible).unwrap_or_default(),
        left_out: Vec::new(),
        more_left_out: 0,
        more_unusable: unusable.clone().skip(MOST_ROWS_ON_PAGES).count(),
        unusable: unusable
            .take(MOST_ROWS_ON_PAGES)
            .map(ToString::to_string)
            .collect(),
    }
}

/// The groups that have no section of their own.
fn further_groups(input: &ReportInput) -> Vec<String> {
    let both = input.groups.iter().zip(&input.figures);
    let further = both.filter(|(_, figures)| figures.is_none());
    let name =
        |g: &GroupInput| format!("{} ({} mm)", g.fit.group.campaign, g.fit.group.diameter_mm);
    further.map(|(group, _)| name(group)).collect()
}

fn campaigns(input: &ReportInput) -> Vec<Campaign> {
    let mut campaigns: Vec<Campaign> = Vec::new();
    for session in input.sessions.iter().map(|s| &s.ingest.session) {
        let place = campaigns.iter().position(|c| c.id == session.campaign);
        let place = place.unwrap_or_else(|| {
            campaigns.push(Campaign {
                id: session.campaign.clone(),
                simulated: false,
                excluded: Vec::new(),
                sessions: 0,
                knee: false,
            });
            campaigns.len() - 1
        });
        let campaign = &mut campaigns[place];
        campaign.sessions += 1;
        campaign.simulated |= session.is_simulated();
        campaign.knee |= session.kind == Kind::KneeTorque;
        if let Some(why) = &session.exclude {
            Excluded::add(&mut campaign.excluded, why, &session.id);
        }
    }
    campaigns
}

fn group(input: &GroupInput, figures: &[Drawn]) -> Group {
    let fit = &input.fit;
    let rmse = |model: &str, split: &str| {
        let found = input
            .comparison
            .comparisons
            .iter()
            .find(|c| c.model == model && c.split == split);
        found.and_then(|c| c.rmse)
    };
    let whole = |c: &&pipeline_compare::Comparison| {
        !c.fitted_here && c.model != "martens2017" && c.split == "all" && c.n_excluded == 0
    };
    let best = input
        .comparison
        .comparisons
        .iter()
        .filter(whole)
        .filter_map(|c| Some((model_name(&c.model, &c.title).to_owned(), c.rmse?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let unseen = rmse(NEW, "loso");
    let better = best.filter(|(_, e)| unseen.is_some_and(|unseen| unseen > *e));
    let filled = tables::of_group(input).filter(|t| !t.rows.is_empty());
    let own_name = slug(input);
    let first = figures.iter();
    let first = first.filter(|d| !is_supplementary(d, &own_name));
    Group {
        campaign: fit.group.campaign.clone(),
        pooled: if fit.group.members.len() > 1 {
            fit.group.members.clone()
        } else {
            Vec::new()
        },
        diameter_mm: fit.group.diameter_mm,
        simulated: fit.group.simulated,
        rows: fit.rows,
        specimens: fit.specimens.len(),
        kept_out: fit.rows_kept_out,
        excluded: fit.rows_excluded,
        ci_method: fit
            .equation(JOINT)
            .map_or_else(String::new, |e| e.ci_method.clone()),
        loss: fit
            .equation(JOINT)
            .map_or_else(String::new, |e| loss(&e.loss).to_owned()),
        rmse_train: error_or_none(rmse(NEW, "train"), "N"),
        rmse_unseen: unseen.map(|e| error(e, "N")),
        better: better.map(|(name, e)| (name, error(e, "N"))),
        borrowed: fit
            .equation(JOINT)
            .is_some_and(|e| e.folds.iter().any(|f| !f.held.is_empty())),
        notes: fit
            .notes
            .iter()
            .cloned()
            .chain(
                fit.equation(JOINT)
                    .and_then(|e| at_free_length(&e.values())),
            )
            .chain(in_doubt(input.doubtful()).map(|s| capitalised(&s)))
            .collect(),
        tables: filled.map(|t| Included::new(&t)).collect(),
        figures: first.map(Picture::new).collect(),
    }
}

/// A fitted law that leaves more than this share of F_620 at the free length is said to.
const LEFT_AT_FREE_LENGTH: f64 = 0.03;

/// What the joint fit leaves of the force where there is none by definition, at eps* = 1 and 620 kPa, if that is much: a sentence without its full
/// stop.
fn at_free_length(joint: &[f64]) -> Option<String> {
    let [_, _, c0, c1, c2] = *joint else {
        return None;
    };
    let left = new::surface([c0, c1, c2], 1.0, 1.0);
    (left > LEFT_AT_FREE_LENGTH).then(|| {
        format!(
            "At eps* = 1 and 620 kPa, where no force is left by definition, the fitted law has {} of F_620: by it a free muscle contracts further \
             than was measured",
            percent(left)
        )
    })
}

/// Readings of torque, which are part of `knee.pdf`.
fn torques(input: &ReportInput) -> usize {
    let is_torque = |s: &&SessionInput| s.ingest.session.kind == Kind::KneeTorque;
    input
        .sessions
        .iter()
        .filter(is_torque)
        .map(|s| s.readings)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_that_leaves_force_at_the_free_length_says_so() {
        let said = |c2: f64| {
            // With c1 large the law leaves exp(-c2) - c0 there.
            at_free_length(&[300.0, 20.0, 0.5, 1e3, c2])
        };
        assert_eq!(said(-libm::log(0.529)), None);
        assert!(said(-libm::log(0.531)).unwrap().contains(" 3% of F_620"));
        assert_eq!(at_free_length(&[]), None);
    }
}
