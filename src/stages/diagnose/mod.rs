//! Diagnose: what does the residual of the base model depend on, which effect explains it, and what is the error with it?
//!
//! Nobody tells this stage what is in the data. For each campaign and diameter:
//!
//! 1. [`data`]: the readings with everything that is known of each; [`base`]: the model to which effects are added.
//!    [`suspects`]: mistakes of recording, before anything is searched.
//! 2. [`questions`]: is there anything at all? The residual against every column, by permutation.
//! 3. [`candidates`], [`linear`], [`search`]: which additions explain it. Strengths of the specimens are in every model ([`model`]).
//! 4. [`judge`]: which of them may be believed.
//! 5. [`folds`]: the held-out error, the whole search inside each fold; [`black_box`]: what is left to explain.
//! 6. [`answer`]: intervals, classes, detection limits, the next measurement: the [`findings`].
//!
//! Three answers are right answers: an effect, none, or a dependence on a column that has no name in the library.
//!
//! Deliberately absent: knowledge of how a campaign was made. The stage sees rows, and the simulator shares no equation with it.

pub mod answer;
pub mod base;
pub mod between;
pub mod black_box;
pub mod candidates;
pub mod data;
pub mod findings;
pub mod folds;
pub mod judge;
pub mod limits;
pub mod linear;
pub mod model;
pub mod questions;
pub mod search;
pub mod suspects;
pub mod term;
pub mod uncertainty;

use crate::base::row::Row;
use crate::base::session::Role;
use crate::config::{DiagnoseOptions, FitOptions};
use crate::effects::{self, Conditions};
use crate::models::{ForceModel, new};
use crate::numerics::statistics::mean;
use crate::stages::fit::{Group, is_fitted, is_usable};
use base::Base;
use data::Data;
use findings::{CampaignFindings, Errors, FoldErrors, Question, Rejected, Residuals, Suspect};
use folds::{Fold, Tally};
use judge::Judgement;
use model::{Fitted, Model};
use rayon::prelude::*;
use search::{Search, State};
use std::collections::BTreeSet;
use term::{Term, What};

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
    null: State,
    best: State,
    judgements: Vec<Judgement>,
    rejected: Vec<Rejected>,
    held: HeldOut,
    passed_over: usize,
    suspects: Vec<Suspect>,
}

/// The held-out errors of base, effects, empirical corrections and black box.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldOut {
    before: Tally,
    after: Tally,
    empirical: Option<Tally>,
    black_box: Option<f64>,
    black_box_after: Option<f64>,
    by_unit: Vec<FoldErrors>,
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
    let all = Data::new(&answered);
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
    let questions = ask(&search, &null, options);
    let something = questions.iter().any(|q| q.p_adjusted < WORTH_ASKING);
    let (best, judgements, rejected) = if something {
        believed(&search, options.seed)
    } else {
        (null.clone(), Vec::new(), Vec::new())
    };
    let held = held_out(
        &base,
        &all,
        &candidates,
        &folds,
        something && !best.chosen.is_empty(),
        options,
    );
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
        null,
        best,
        judgements,
        rejected,
        held,
        passed_over,
        suspects,
    };
    Some(answer::answer(&work))
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

/// The additions that pass every guard.
fn believed(search: &Search, seed: u64) -> (State, Vec<Judgement>, Vec<Rejected>) {
    let inner = inner_folds(search.data);
    let (state, judgements, mut rejected) = judge::judged(search, &search.run(), &inner, seed);
    let (state, judgements, each) =
        judge::with_each_session(search, state, judgements, &inner, seed);
    rejected.extend(each);
    (state, judgements, rejected)
}

/// Specimens left out one at a time (or sessions, logs): the folds in which a single addition is judged.
fn inner_folds(data: &Data) -> Vec<Fold> {
    folds::folds(data, &vec![false; data.len()]).0
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

/// The whole search in every fold (`search`), or the base model alone.
fn held_out(
    base: &Base,
    all: &Data,
    candidates: &[Term],
    folds: &[Fold],
    search: bool,
    options: &DiagnoseOptions,
) -> HeldOut {
    let one = |fold: &Fold| one_fold(base, all, candidates, fold, search, options);
    let holdout = folds.windows(2).all(|w| w[0].train == w[1].train);
    let results: Vec<FoldResult> = if holdout && folds.len() > 1 {
        // One search serves all: they leave out the same readings.
        let joined = Fold {
            unit: String::new(),
            train: folds[0].train.clone(),
            held_out: folds.iter().flat_map(|f| f.held_out.clone()).collect(),
        };
        let result = one(&joined);
        folds.iter().map(|f| result.part(&joined, f, all)).collect()
    } else {
        folds.par_iter().map(one).collect()
    };
    gather(&results)
}

/// Predictions of one fold, one entry a held-out reading.
struct FoldResult {
    unit: String,
    measured: Vec<f64>,
    before: Vec<f64>,
    after: Vec<f64>,
    empirical: Option<Vec<f64>>,
    boxes: Vec<Vec<f64>>,
    boxes_after: Vec<Vec<f64>>,
    chosen: Vec<String>,
}

impl FoldResult {
    /// The part of it that belongs to one unit.
    fn part(&self, joined: &Fold, fold: &Fold, all: &Data) -> FoldResult {
        let places: Vec<usize> = fold
            .held_out
            .iter()
            .filter_map(|i| joined.held_out.iter().position(|j| j == i))
            .collect();
        let pick = |v: &Vec<f64>| places.iter().map(|k| v[*k]).collect::<Vec<f64>>();
        debug_assert!(all.len() >= places.len());
        FoldResult {
            unit: fold.unit.clone(),
            measured: pick(&self.measured),
            before: pick(&self.before),
            after: pick(&self.after),
            empirical: self.empirical.as_ref().map(pick),
            boxes: self.boxes.iter().map(pick).collect(),
            boxes_after: self.boxes_after.iter().map(pick).collect(),
            chosen: self.chosen.clone(),
        }
    }
}

fn one_fold(
    base: &Base,
    all: &Data,
    candidates: &[Term],
    fold: &Fold,
    search: bool,
    options: &DiagnoseOptions,
) -> FoldResult {
    let train = all.select(&fold.train);
    let thin = train.thinned(options.most_readings);
    let held = all.select(&fold.held_out);
    let here = Search::new(
        base,
        &thin,
        candidates,
        options.most_effects,
        judge::SIGNIFICANT.1,
    );
    let null = here.state(Vec::new(), None);
    let best = if search {
        believed(&here, options.seed).0
    } else {
        null.clone()
    };
    let terms = |physical_only: bool| -> Vec<Term> {
        let kept = |t: &Term| !physical_only || matches!(t.what, What::Effect { .. });
        best.chosen
            .iter()
            .map(|c| candidates[*c].clone())
            .filter(kept)
            .collect()
    };
    let predict = |terms: Vec<Term>, data: &Data, fitted: &Fitted| {
        Model { base, data, terms }.predict(fitted, false)
    };
    let fit = |terms: Vec<Term>| {
        let model = Model {
            base,
            data: &thin,
            terms,
        };
        model.fit(None, 1)
    };
    let before = predict(Vec::new(), &held, &null.fitted);
    let physical = terms(true);
    let fitted = if physical.len() == best.chosen.len() {
        best.fitted.clone()
    } else {
        fit(physical.clone())
    };
    let after = predict(physical.clone(), &held, &fitted);
    let empirical =
        (physical.len() < best.chosen.len()).then(|| predict(terms(false), &held, &best.fitted));
    let boxes = black_boxes(base, all, fold, &[], &null.fitted, options);
    let boxes_after = if physical.is_empty() {
        boxes.clone()
    } else {
        black_boxes(base, all, fold, &physical, &fitted, options)
    };
    let names = |t: &Term| match t.scope {
        term::Scope::Whole => judge::name(t, &thin),
        _ => format!("{} ({})", judge::name(t, &thin), judge::acts_on(t, &thin)),
    };
    FoldResult {
        unit: fold.unit.clone(),
        measured: held.force.clone(),
        before,
        after,
        empirical,
        boxes,
        boxes_after,
        chosen: terms(false).iter().map(names).collect(),
    }
}

/// A model's prediction of the held-out readings with a black box on its residual, one for each of its noises.
fn black_boxes(
    base: &Base,
    all: &Data,
    fold: &Fold,
    terms: &[Term],
    fitted: &Fitted,
    options: &DiagnoseOptions,
) -> Vec<Vec<f64>> {
    let model = Model {
        base,
        data: all,
        terms: terms.to_vec(),
    };
    let plain = model.predict(fitted, false);
    let residual: Vec<f64> = all.force.iter().zip(&plain).map(|(y, f)| y - f).collect();
    let features = black_box::Features::new(all, &plain);
    let step = (fold.train.len() / options.most_readings.max(1)).max(1);
    let train: Vec<usize> = fold.train.iter().copied().step_by(step).collect();
    black_box::predict(&features, &residual, &train, &fold.held_out)
        .into_iter()
        .map(|extra| {
            fold.held_out
                .iter()
                .zip(extra)
                .map(|(i, e)| plain[*i] + e)
                .collect()
        })
        .collect()
}

fn gather(results: &[FoldResult]) -> HeldOut {
    let tally = |of: &dyn Fn(&FoldResult) -> Vec<f64>| {
        let parts = results.iter().map(|r| Tally::of(&r.measured, &of(r)));
        parts.fold(Tally::default(), Tally::plus)
    };
    let best_box = |of: &dyn Fn(&FoldResult) -> Vec<Vec<f64>>| -> Option<(usize, f64)> {
        let choices = black_box::NOISE.len();
        let error = |k: usize| tally(&|r| of(r)[k].clone()).rmse();
        (0..choices)
            .map(|k| (k, error(k)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let boxed = if results.is_empty() {
        None
    } else {
        best_box(&|r| r.boxes.clone())
    };
    let boxed_after = if results.is_empty() {
        None
    } else {
        best_box(&|r| r.boxes_after.clone())
    };
    let by_unit = results
        .iter()
        .map(|r| FoldErrors {
            unit: r.unit.clone(),
            readings: r.measured.len(),
            before: Tally::of(&r.measured, &r.before).rmse(),
            after: Tally::of(&r.measured, &r.after).rmse(),
            black_box: boxed.map(|(k, _)| Tally::of(&r.measured, &r.boxes[k]).rmse()),
            chosen: r.chosen.clone(),
        })
        .collect();
    let any_empirical = results.iter().any(|r| r.empirical.is_some());
    HeldOut {
        before: tally(&|r| r.before.clone()),
        after: tally(&|r| r.after.clone()),
        empirical: any_empirical
            .then(|| tally(&|r| r.empirical.clone().unwrap_or_else(|| r.after.clone()))),
        black_box: boxed.map(|(_, e)| e),
        black_box_after: boxed_after.map(|(_, e)| e),
        by_unit,
    }
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
