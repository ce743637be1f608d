#![warn(missing_docs)]
//! Diagnose: where does the error of the base model come from, and what does the law lack?
//!
//! One mixed model of a campaign ([`problem`]) and what is asked of it ([`pipeline_inference`]). Nobody tells this stage what is in the data.
//! For each campaign and diameter, and each small pool of campaigns of one diameter:
//!
//! 1. [`data`]: the readings with everything that is known of each ([`labels`] are words); [`base`]: the law to which effects are added.
//!    [`recording`]: sessions and specimens that look mistaken beside what all readings show are set aside and reported.
//! 2. [`library`]: the terms that may be added: forms of effects, and smooth functions of columns.
//! 3. The null model has gain and contracted length of each specimen, set length and zero of the force of each session, and a smooth misfit of the
//!    law. What is published of the law is one further reading of each coefficient but its scales b1 and c0.
//!    The search tests every term against the maximum over all of them in draws from it ([`pipeline_inference::search`]), beside the law and beside the
//!    law without its dependence on the resting length, whose place an effect may take ([`length_law`]).
//! 4. [`unseen`]: the same search without each specimen; [`tally`]: errors, predictive intervals, the budget of the expected error.
//! 5. [`form`]: whether one number is enough for the size of what was found; `in_time`: what of it stands where noise is correlated in time.
//! 6. [`limits`]: what could have been seen, and what is indistinguishable. [`answer`]: the [`pipeline_findings`], as values.
//! 7. [`mixed_law`]: what the model says of readings that are still to be made.
//!
//! `campaign` goes through these steps with what is left when the mistakes are gone (`aside`): the problem that suits the readings (`suited`), its
//! search, and everything that is asked of the result (`asked`, `alternatives`; before that nothing is said, `unassessed`).
//!
//! The numbers that decide stand in [`pipeline_inference::decisions`], those that say what is plausible in [`settings`], each with its reason. No
//! rule names an effect.
//!
//! Deliberately absent: sentences, and knowledge of how a campaign was made. The stage sees rows.

mod alternatives;
pub mod answer;
mod aside;
mod asked;
pub mod base;
pub mod bent;
pub mod black_box;
mod campaign;
pub mod data;
pub mod form;
mod in_time;
pub mod labels;
pub mod length_law;
pub mod library;
pub mod limits;
pub mod mixed_law;
pub mod next;
pub mod problem;
pub mod recording;
pub mod settings;
pub mod slack;
pub mod smooth;
pub mod steps;
mod suited;
pub mod tally;
#[cfg(test)]
mod tests;
mod unassessed;
pub mod unseen;

pub use suited::{Declared, suited};

use aside::{is_part, judged, mistakes_among};
use base::Base;
use campaign::{Answer, Campaign};
use mixed_law::MixedLaw;
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_config::{DiagnoseOptions, FitOptions};
use pipeline_effects as effects;
use pipeline_effects::Conditions;
use pipeline_findings::{CampaignFindings, EffectFinding, Residuals, Verdict};
use pipeline_fit::{Group, equations, is_fitted, is_usable};
use pipeline_inference::decisions;
use pipeline_inference::search::Decision;
use recording::Law;
use slack::Shape;
use std::collections::BTreeSet;

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 2;

/// The answer for one campaign, and its residuals for the figures.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The answer.
    pub findings: CampaignFindings,
    /// One entry a reading.
    pub residuals: Residuals,
    /// The law as the mixed model has it; none of a campaign that is not assessed, or whose law is not the new one.
    pub mixed_law: Option<MixedLaw>,
}

/// Searches the rows of a group; none where the base model has no value for any of them.
pub fn diagnose(
    group: &Group,
    rows: &[Row],
    fit: &FitOptions,
    options: &DiagnoseOptions,
) -> Option<Diagnosis> {
    let searched = |r: &&Row| is_usable(r) && (is_fitted(r) || r.role == Some(Role::Holdout));
    let rows: Vec<&Row> = rows.iter().filter(searched).collect();
    let base = base_model(group, &rows, fit, options)?;
    let answered: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|r| base_answers(&base, r))
        .collect();
    if answered.is_empty() {
        return None;
    }
    let outside = rows.len() - answered.len();
    let judged = judged(&answered);
    let beside_law = mistakes_among(group, &Law::new(&base), &judged);
    let laws = base.with_and_without_length_law();
    let campaign = Campaign {
        group,
        base: &base,
        laws: laws.as_ref(),
        rows: &answered,
        outside,
        judged: &judged,
        beside_law: &beside_law,
        options,
    };
    // What all sessions share shows most in those that are measured where it is largest: if it explains what looks mistaken beside the law alone,
    // nothing is set aside.
    let (mut mistakes, mut again) = match campaign.assessed(&[], true) {
        Answer::Given(diagnosis) => return Some(*diagnosis),
        Answer::OtherMistakes(fewer) if is_part(&fewer, &beside_law) => (fewer, false),
        Answer::OtherMistakes(_) => (beside_law.clone(), true),
    };
    loop {
        match campaign.assessed(&mistakes, again) {
            Answer::Given(diagnosis) => return Some(*diagnosis),
            Answer::OtherMistakes(others) => (mistakes, again) = (others, false),
        }
    }
}

fn base_model(
    group: &Group,
    rows: &[&Row],
    fit: &FitOptions,
    options: &DiagnoseOptions,
) -> Option<Base> {
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let diameter_mm = group.diameter_mm;
    let refit = match options.base_model.as_str() {
        "new" => options.refit,
        "new_published" => false,
        id => return Base::published(id, options.refit),
    };
    let base = Base::new(diameter_mm, refit, lengths.len(), fit);
    if !refit || Shape::published(diameter_mm).is_some() {
        return Some(base);
    }
    Some(match equations::joint_estimates(diameter_mm, rows, fit) {
        Some(values) => base.starting_at(values),
        None => base,
    })
}

/// Whether the base model has a force for a row at all.
fn base_answers(base: &Base, row: &Row) -> bool {
    let mut at = Conditions::at(
        row.rest_length_m,
        row.contracted_length_m,
        row.length_m,
        row.pressure_kpa,
    );
    at.diameter_mm = row.diameter_mm;
    effects::force(base, &base.starts(), 1.0, &[], &at).is_finite()
}

/// How a search with these options decides.
pub fn decision(options: &DiagnoseOptions) -> Decision {
    Decision {
        level: decisions::COMES_IN,
        draws: options.draws,
        alike: decisions::ALIKE,
        most_terms: options.most_effects,
        thorough: true,
    }
}

/// Standard normal numbers by draw, for one question.
pub fn draws(
    question: &'static str,
    seed: u64,
) -> impl Fn(usize) -> Box<dyn FnMut() -> f64> + Sync {
    move |k| {
        let mut stream = Stream::new(seed, &[question, &k.to_string()]);
        Box::new(move || stream.normal())
    }
}

/// The verdict on what was found.
pub fn verdict(effects: &[EffectFinding], unexplained: bool) -> Verdict {
    if effects.iter().any(|e| !e.negligible) {
        Verdict::EffectFound
    } else if unexplained {
        Verdict::Unexplained
    } else {
        Verdict::None
    }
}

/// The error that a budget comes to; none without one.
pub fn expected(budget: &[pipeline_findings::BudgetEntry]) -> Option<f64> {
    let total: f64 = budget.iter().map(|b| b.variance).sum();
    (!budget.is_empty()).then(|| total.sqrt())
}
