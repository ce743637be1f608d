//! The pages of `residual.pdf`: for every campaign, pool and joint the answer, what the error is made of, and the evidence, for somebody who has
//! to decide. Everything is made of [`pipeline_findings`]; what is said in sentences comes from [`super::wording`].
//!
//! | module | part of the page |
//! |---|---|
//! | [`front`] | the first page: sentences, errors, budget |
//! | [`effects`] | effects with their facts, alias sets, what was tested, what stays without a name |
//! | [`groups`] | scatter, misfit, recording errors |
//! | [`held_out`] | errors by unit, coefficients, alternatives of the law |
//! | [`limits`] | what could not have been seen, what to measure next |

mod effects;
mod front;
mod groups;
mod held_out;
mod limits;

use crate::extent::{MOST_GROUPS, MOST_ROWS_ON_PAGES};
use crate::figures::Drawn;
use crate::figures::found::Kind;
use crate::force::{doubtful_zeros, replaced_zeros};
use crate::input::{GroupInput, ReportInput};
use crate::knee;
use crate::pages::{PageData, Picture};
use crate::typeset::Pdf;
use crate::wording::name;
use crate::wording::number::unit;
use crate::wording::sentence::{LawAlone, implausible};
use crate::wording::{CLEARLY_LOWER, COMES_IN};
use pipeline_base::error::Result;
use pipeline_compare::{NEW, NEW_PUBLISHED};
use pipeline_findings::CampaignFindings;
use pipeline_torque::CampaignTorque;
use serde::Serialize;
use std::collections::BTreeMap;

const TEMPLATE: &str = include_str!("../templates/residual.typ");

/// Most rows of a table that has one for each held-out unit, or each recording error; the data files have all.
const MOST_ROWS: usize = 40;

/// The profiles of so many effects stand beside the effects; of more they fill a page that nobody needs to judge them.
const PROFILES_BESIDE: usize = 2;

/// The figures that belong to no group of rows.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// The budgets of all that is on the first page; none where there is none.
    pub budget: Option<Drawn>,
    /// Of every joint, in the order of the input.
    pub joints: Vec<Vec<(Kind, Drawn)>>,
}

impl Figures {
    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &Drawn> {
        let joints = self.joints.iter().flatten().map(|(_, drawn)| drawn);
        self.budget.iter().chain(joints)
    }
}

/// The data of the template.
#[derive(Serialize)]
struct Own {
    /// Those with a section.
    campaigns: Vec<Campaign>,
    /// Names of those that were not assessed, by the reason.
    not_assessed: BTreeMap<String, Vec<String>>,
    /// The errors of these on held-out units.
    errors: Vec<front::ErrorRow>,
    /// Those without a section: name, answer.
    others: Vec<[String; 2]>,
    budget: Option<Picture>,
    /// Sessions whose readings no such actuator gives, in a sentence; empty where there are none.
    implausible: String,
    /// How many sessions have a zero log that holds a pull.
    replaced_zeros: usize,
    /// How many have a zero that is far from those of the others, and was taken off.
    doubtful_zeros: usize,
    /// What the words for the strength of the evidence mean; empty where nothing was found.
    evidence: String,
}

/// A section.
#[derive(Serialize)]
pub(crate) struct Campaign {
    /// What labels of its tables end with.
    key: String,
    name: String,
    simulated: bool,
    verdict: &'static str,
    verdict_words: &'static str,
    unit: String,
    /// One and several of what is held out, one and several set-ups.
    nouns: [&'static str; 4],
    /// What each search was made without.
    without_one: &'static str,
    answer: front::Said,
    /// The same for the first page.
    in_brief: front::Brief,
    design: String,
    budget: Vec<[String; 4]>,
    expected: String,
    effects: Vec<effects::Effect>,
    /// Whether the profiles of the effects fill a page, and so stand in the supplement.
    profiles_apart: bool,
    alias_sets: Vec<effects::AliasRow>,
    tested: Vec<effects::TestedRow>,
    tested_in_all: usize,
    /// Whether a candidate that its linearised gain would let in is no part of the answer.
    tested_not_accepted: bool,
    /// Below which a candidate comes in.
    level: f64,
    /// A remark on the shuffled column; empty where there is nothing to say.
    shuffled: String,
    unexplained: Vec<[String; 4]>,
    scatter: Vec<[String; 7]>,
    misfit: String,
    recording_errors: Vec<[String; 6]>,
    recording_errors_left_out: usize,
    units: Vec<[String; 8]>,
    /// Whether the units have errors with their own values and a predictive distribution.
    predictive: bool,
    units_left_out: usize,
    black_box: String,
    coefficients: Vec<[String; 5]>,
    alternatives: Vec<[String; 6]>,
    alternatives_sentence: String,
    limits: Vec<[String; 4]>,
    /// Beside what these would have been found.
    limits_beside: &'static str,
    /// The pairs that the readings do not tell apart, in a sentence; empty where there is none.
    limits_alike: String,
    /// What was measured: "force" or "torque".
    load: &'static str,
    not_measurable: Vec<limits::Cannot>,
    next: Vec<[String; 2]>,
    worth_withheld: String,
    figures: Vec<Picture>,
}

impl Campaign {
    /// Whether the supplement has anything of it.
    pub(crate) fn varies(&self) -> bool {
        self.profiles_apart || !self.scatter.is_empty() || !self.coefficients.is_empty()
    }
}

/// One campaign, pool or joint, with its figures where it has a section.
struct Entry<'a> {
    found: &'a CampaignFindings,
    figures: Option<&'a [(Kind, Drawn)]>,
    /// The error of something simpler on the same unseen readings, where there is such.
    simpler: Option<Simpler>,
}

/// Something simpler than the model with its effects, and its error on unseen units.
#[derive(Clone, Copy)]
struct Simpler {
    words: &'static str,
    error: f64,
}

/// What has a section, in the order of the pages, what was measured before what was simulated: its budget stands on the first page.
pub fn on_the_first_page(input: &ReportInput) -> Vec<&CampaignFindings> {
    let groups = input
        .with_section()
        .filter_map(|(g, _)| g.diagnosis.as_ref());
    let joints = input.torque_findings().take(MOST_GROUPS);
    let mut all: Vec<&CampaignFindings> = groups.map(|d| &d.findings).chain(joints).collect();
    all.sort_by_key(|found| found.simulated);
    all
}

/// The law alone with its error on unseen specimens, fitted by least squares or as it is published, whichever has the smaller one; none where nothing was
/// left out.
fn law_alone(group: &GroupInput) -> Option<LawAlone> {
    let fitted = LawAlone {
        is_published: false,
        rmse_n: of_all_readings(group, NEW)?,
    };
    let published = published_n(group).map(|rmse_n| LawAlone {
        is_published: true,
        rmse_n,
    });
    let better = published.filter(|p| p.rmse_n < fitted.rmse_n);
    Some(better.unwrap_or(fitted))
}

/// The error of the new model with its published coefficients on all readings of a group, N; none where it does not answer all of them.
pub(crate) fn published_n(group: &GroupInput) -> Option<f64> {
    of_all_readings(group, NEW_PUBLISHED)
}

/// The error of a law on the readings of specimens that it has not seen, N, where it answers all readings.
fn of_all_readings(group: &GroupInput, model: &str) -> Option<f64> {
    let mut all = group.comparison.comparisons.iter();
    let of_model = all.find(|c| c.model == model && c.split == "loso")?;
    of_model.rmse.filter(|_| of_model.n_excluded == 0)
}

/// The same where it is clearly below that of the search.
pub(crate) fn better_law_alone(group: &GroupInput) -> Option<LawAlone> {
    let found = &group.diagnosis.as_ref()?.findings;
    let own = found.rmse_of_answer()?;
    law_alone(group).filter(|law| law.rmse_n < CLEARLY_LOWER * own)
}

fn entries<'a>(input: &'a ReportInput, figures: &'a Figures) -> Vec<Entry<'a>> {
    let groups = input.groups.iter().zip(&input.figures);
    let groups = groups.filter_map(|(group, drawn)| {
        Some(Entry {
            found: &group.diagnosis.as_ref()?.findings,
            figures: drawn.as_ref().map(|d| d.diagnosis.as_slice()),
            simpler: law_alone(group).map(|law| Simpler {
                words: law.name(),
                error: law.rmse_n,
            }),
        })
    });
    let of_campaign = |c: &'a CampaignTorque| {
        let found = c.diagnoses.iter().map(|d| &d.findings);
        found.map(move |found| (knee::one_length(c, found), found))
    };
    let joints = input.torque().iter().flat_map(of_campaign);
    let joints = joints.enumerate().map(|(k, (one_length, found))| Entry {
        found,
        simpler: one_length.map(|error| Simpler {
            words: "one length of the end fittings alone",
            error,
        }),
        figures: figures
            .joints
            .get(k)
            .filter(|_| k < MOST_GROUPS)
            .map(Vec::as_slice),
    });
    let mut all: Vec<Entry> = groups.chain(joints).collect();
    all.sort_by_key(|entry| entry.found.simulated);
    all
}

/// Typesets `residual.pdf`. None where nothing was diagnosed.
///
/// # Errors
/// A template that does not compile.
pub fn residual_pdf(
    input: &ReportInput,
    figures: &Figures,
    date: Option<(i32, u8, u8)>,
) -> Result<Option<Pdf>> {
    let entries = entries(input, figures);
    if entries.is_empty() {
        return Ok(None);
    }
    let with_section = || entries.iter().filter_map(|e| Some((e.found, e.figures?)));
    let without = entries.iter().filter(|e| e.figures.is_none());
    let own = Own {
        campaigns: sections(input, figures),
        implausible: implausible(&input.implausible).unwrap_or_default(),
        replaced_zeros: replaced_zeros(input).len(),
        doubtful_zeros: doubtful_zeros(input).len(),
        not_assessed: front::not_assessed(with_section().map(|(found, _)| found)),
        errors: with_section()
            .flat_map(|(found, _)| front::errors(found))
            .collect(),
        others: without
            .take(MOST_ROWS_ON_PAGES)
            .map(|e| front::in_short(e.found))
            .collect(),
        budget: figures.budget.as_ref().map(Picture::new),
        evidence: front::evidence(with_section().map(|(found, _)| found)),
    };
    let simulated = entries.iter().map(|e| e.found.simulated);
    let drawn = with_section().flat_map(|(_, f)| f.iter().map(|(_, drawn)| drawn));
    let document = PageData::new(&input.input_digest, simulated, own)
        .document(TEMPLATE, date)?
        .with_figures(drawn.chain(&figures.budget));
    document.compile().map(Some)
}

/// The sections, in the order of the pages.
pub(crate) fn sections(input: &ReportInput, figures: &Figures) -> Vec<Campaign> {
    let entries = entries(input, figures);
    let with_section = entries
        .iter()
        .filter_map(|e| Some((e.found, e.figures?, e.simpler)));
    with_section
        .enumerate()
        .map(|(k, (found, figures, simpler))| campaign(k, found, figures, simpler))
        .collect()
}

fn campaign(
    place: usize,
    found: &CampaignFindings,
    figures: &[(Kind, Drawn)],
    simpler: Option<Simpler>,
) -> Campaign {
    let nouns = name::nouns(found);
    Campaign {
        key: place.to_string(),
        name: name::campaign(found),
        simulated: found.simulated,
        verdict: name::verdict_id(found.verdict),
        verdict_words: name::verdict(found.verdict),
        unit: unit(&found.unit).to_owned(),
        nouns: [nouns.unit, nouns.units, nouns.setup, nouns.setups],
        without_one: name::without_one(found),
        answer: front::answer(found),
        in_brief: front::in_brief(found, simpler),
        design: front::design(found),
        budget: front::budget(found),
        expected: front::expected(found),
        effects: effects::effects(found),
        profiles_apart: found.effects.len() > PROFILES_BESIDE,
        alias_sets: effects::alias_sets(found),
        tested: effects::tested(found),
        tested_in_all: found.tested.len(),
        tested_not_accepted: effects::is_some_not_accepted(found),
        level: COMES_IN,
        shuffled: effects::shuffled(found),
        unexplained: { found.unexplained.iter() }
            .map(|u| effects::unexplained(found, u))
            .collect(),
        scatter: found.scatter.iter().map(groups::scatter).collect(),
        misfit: groups::beside_scatter(found),
        recording_errors: groups::recording_errors(found),
        recording_errors_left_out: found.recording_errors.len().saturating_sub(MOST_ROWS),
        units: held_out::units(found),
        predictive: held_out::is_predictive(found),
        units_left_out: found.by_unit.len().saturating_sub(MOST_ROWS),
        black_box: held_out::black_box(found),
        coefficients: held_out::coefficients(found),
        alternatives: held_out::alternatives(found),
        alternatives_sentence: held_out::alternatives_sentence(found),
        limits: limits::limits(found),
        limits_beside: limits::beside(found),
        limits_alike: limits::alike(found),
        load: name::load(found),
        not_measurable: limits::not_measurable(found),
        next: limits::next(found),
        worth_withheld: limits::worth_withheld(found),
        figures: figures
            .iter()
            .map(|(kind, drawn)| Picture::new(drawn).of_kind(*kind))
            .collect(),
    }
}
