//! Diagnose: what does the residual of the base model depend on, which effect explains it, and what is the error with it?
//!
//! Nobody tells this stage what is in the data. For each campaign and diameter:
//!
//! 1. [`data`]: the readings with everything that is known of each ([`labels`] are words); [`base`]: the model to which effects are added.
//!    [`suspects`]: mistakes of recording, before anything is searched.
//! 2. [`questions`]: is there anything at all? The residual against every column, by permutation; and whether set points differ by more than
//!    repeats of one do.
//! 3. [`candidates`], [`linear`], [`search`]: which additions explain it. Strengths of the specimens are in every model ([`model`]).
//! 4. [`judge`]: which of them may be believed.
//! 5. [`folds`]: the held-out error, the whole search inside each fold; [`black_box`]: what is left to explain. `belief`: what the folds do not find
//!    again, and what zero logs contradict, is not believed.
//! 6. [`answer`]: intervals, classes, detection limits, the next measurement: the [`findings`].
//!
//! Three answers are right answers: an effect, none, or a dependence on a column that has no name in the library.
//!
//! Deliberately absent: knowledge of how a campaign was made. The stage sees rows, and the simulator shares no equation with it.

pub mod answer;
pub mod base;
mod belief;
pub mod between;
pub mod black_box;
pub mod candidates;
pub mod data;
pub mod findings;
pub mod folds;
pub mod held_out;
pub mod judge;
pub mod labels;
pub mod library;
pub mod limits;
pub mod linear;
pub mod model;
pub mod noise;
pub mod problem;
pub mod recording;
pub mod settings;
pub mod questions;
pub mod search;
pub mod suspects;
pub mod term;
#[cfg(test)]
mod tests;
pub mod uncertainty;
pub(crate) mod words;

use crate::base::row::Row;
use crate::base::session::Role;
use crate::config::{DiagnoseOptions, FitOptions};
use crate::effects::{self, Conditions};
use crate::models::{ForceModel, new};
use crate::numerics::statistics::mean;
use crate::stages::fit::{Group, is_fitted, is_usable};
use base::Base;
use data::Data;
use findings::{CampaignFindings, Errors, Question, Rejected, Residuals, Suspect};
use folds::{Fold, Tally};
use held_out::{HeldOut, held_out};
use judge::Judgement;
use model::{Fitted, Model};
use search::{Search, State};
use std::collections::BTreeSet;
use term::Term;

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// The answer for one campaign, and its residuals for the figures.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The answer.
    pub findings: CampaignFindings,
    /// One entry a reading.
    pub residuals: Residuals,
}

/// Fewest readings that are searched.
const FEWEST_READINGS: usize = 20;
/// What a zero log shows if the first is so, and does not if the second is.
const ZERO_OR_THRESHOLD: [&str; 2] = ["pressure_zero_offset", "bladder_threshold"];
/// Largest corrected p of a question at which the search goes on.
const WORTH_ASKING: f64 = 0.05;

/// Everything between the data and the answer.
pub(crate) struct Work<'a> {
    group: &'a Group,
    options: &'a DiagnoseOptions,
    base: &'a Base,
    /// All readings, held-out ones included.
    all: &'a Data,
    /// The readings that are searched.
    train: &'a Data,
    candidates: &'a [Term],
    folds: &'a [Fold],
    held_out_by: &'static str,
    questions: Vec<Question>,
    /// Whether a question gave reason to search.
    searched: bool,
    null: State,
    best: State,
    judgements: Vec<Judgement>,
    rejected: Vec<Rejected>,
    held: HeldOut,
    passed_over: usize,
    suspects: Vec<Suspect>,
}

/// Searches the rows of a group; none where they are too few.
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
    let passed_over = rows.len() - answered.len();
    let (suspects, answered) = without_mistakes(&base, group, answered, fit, options);
    let all = Data::new(&answered).with_placebo(options.seed);
    let kept_out: Vec<bool> = answered
        .iter()
        .map(|r| r.role == Some(Role::Holdout))
        .collect();
    let (folds, held_out_by) = folds::folds(&all, &kept_out);
    let train: Vec<usize> = (0..all.len()).filter(|i| !kept_out[*i]).collect();
    if train.len() < FEWEST_READINGS {
        return None;
    }
    let train = all.select(&train);
    let candidates = candidates::candidates(&train);
    let thin = train.thinned(options.most_readings);
    let search = Search::new(
        &base,
        &thin,
        &candidates,
        options.most_effects,
        judge::SIGNIFICANT.0,
    );
    let null = search.state(Vec::new(), None);
    let mut questions = ask(&search, &null, options);
    questions.extend(noise::between_set_points(&thin, &null.fitted.residuals));
    // What acts alike on all readings of a specimen is no question of a column: the strengths answer.
    let by_strengths = between::asked_for(&search, &null.fitted);
    let something = questions.iter().any(|q| q.p_adjusted < WORTH_ASKING)
        || by_strengths.is_some_and(|(_, p)| p < judge::SIGNIFICANT.0);
    let (best, judgements, rejected) = if something {
        belief::by_zero_logs(&search, belief::believed(&search, options.seed))
    } else {
        (null.clone(), Vec::new(), Vec::new())
    };
    let held_by = |search: bool| held_out(&base, &all, &candidates, &folds, search, options);
    let mut found = belief::Found {
        held: held_by(something && !best.chosen.is_empty()),
        best,
        judgements,
        rejected,
    };
    if found.was_not_found_again(&search) {
        found.drop_effects(&search);
        found.held = held_by(false);
    }
    let belief::Found {
        held,
        best,
        judgements,
        rejected,
    } = found;
    let work = Work {
        group,
        options,
        base: &base,
        all: &all,
        train: &train,
        candidates: &candidates,
        folds: &folds,
        held_out_by,
        questions,
        searched: something,
        null,
        best,
        judgements,
        rejected,
        held,
        passed_over,
        suspects,
    };
    let mut diagnosis = answer::answer(&work);
    diagnosis.findings.notes.extend(all.notes.iter().cloned());
    Some(diagnosis)
}

/// What is far off, and the rows without the sessions that are set aside for it.
fn without_mistakes<'a>(
    base: &Base,
    group: &Group,
    rows: Vec<&'a Row>,
    fit: &FitOptions,
    options: &DiagnoseOptions,
) -> (Vec<Suspect>, Vec<&'a Row>) {
    let searched: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|r| r.role != Some(Role::Holdout))
        .collect();
    if searched.len() < FEWEST_READINGS {
        return (Vec::new(), rows);
    }
    let data = Data::new(&searched).thinned(options.most_readings);
    let known = new::NewPublished.coefficients(group.diameter_mm).len() > 1;
    let published = known.then(|| Base::new(group.diameter_mm, false, 2, fit));
    let suspects = suspects::suspects(base, &data, published.as_ref());
    let aside: BTreeSet<&str> = suspects
        .iter()
        .filter(|s| s.set_aside)
        .filter_map(|s| s.what.strip_prefix("session "))
        .collect();
    let rows = rows
        .into_iter()
        .filter(|r| !aside.contains(r.session.as_str()))
        .collect();
    (suspects, rows)
}

fn base_model(
    group: &Group,
    rows: &[&Row],
    fit: &FitOptions,
    options: &DiagnoseOptions,
) -> Option<Base> {
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    match options.base_model.as_str() {
        "new" => Some(Base::new(
            group.diameter_mm,
            options.refit,
            lengths.len(),
            fit,
        )),
        "new_published" => Some(Base::new(group.diameter_mm, false, lengths.len(), fit)),
        id => Base::published(id, options.refit),
    }
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

fn ask(search: &Search, null: &State, options: &DiagnoseOptions) -> Vec<Question> {
    let predicted = search.model(&[]).predict(&null.fitted, true);
    let columns = questions::columns(search.data, &predicted);
    questions::ask(
        search.data,
        &null.fitted.residuals,
        &columns,
        options.permutations,
        options.seed,
    )
}

/// The errors of a tally beside the training error.
fn errors(train: f64, held: Tally) -> Errors {
    Errors {
        rmse_train: train,
        rmse_heldout: held.rmse(),
        max_abs_error_heldout: held.largest,
        rmse_heldout_own_strength: held.rmse_own_strength(),
    }
}

/// Root mean square of the training residuals, strengths not used, N.
fn train_error(model: &Model, fitted: &Fitted) -> f64 {
    let predicted = model.predict(fitted, false);
    let squares: Vec<f64> = model
        .data
        .force
        .iter()
        .zip(&predicted)
        .map(|(y, f)| (y - f) * (y - f))
        .collect();
    mean(&squares).sqrt()
}
