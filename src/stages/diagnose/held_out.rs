//! The whole search inside each fold: errors of base, effects, empirical corrections and black box on readings that took no part.

use super::base::Base;
use super::belief::believed;
use super::data::Data;
use super::findings::FoldErrors;
use super::folds::{Fold, Tally};
use super::model::{Fitted, Model};
use super::search::Search;
use super::term::{Scope, Term, What};
use super::{black_box, judge};
use crate::config::DiagnoseOptions;
use rayon::prelude::*;

/// A held-out error that falls by less than this share does not fall.
pub(crate) const FALLS: f64 = 0.005;

/// The held-out errors of base, effects, empirical corrections and black box.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldOut {
    pub before: Tally,
    pub after: Tally,
    pub empirical: Option<Tally>,
    pub black_box: Option<f64>,
    pub black_box_after: Option<f64>,
    pub by_unit: Vec<FoldErrors>,
}

impl HeldOut {
    /// Part of the folds whose own search chose one of some effects.
    pub fn share_that_chose(&self, ids: &[String]) -> f64 {
        let is_one = |chosen: &String| {
            let id = chosen.split(' ').next().unwrap_or_default();
            ids.iter().any(|i| i == id)
        };
        let chose = self.by_unit.iter().filter(|u| u.chosen.iter().any(is_one));
        chose.count() as f64 / self.by_unit.len().max(1) as f64
    }

    /// Whether the error of what the folds chose is smaller than that of the base model: in total, or with each unit's own strength.
    pub fn falls(&self) -> bool {
        let falls = |a: f64, b: f64| b < (1.0 - FALLS) * a;
        falls(self.before.rmse(), self.after.rmse())
            || falls(
                self.before.rmse_own_strength(),
                self.after.rmse_own_strength(),
            )
    }
}

/// The whole search in every fold (`search`), or the base model alone.
pub(super) fn held_out(
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

/// Predictions of held-out readings: with mean strengths, and with each specimen's own.
#[derive(Clone)]
struct Predictions {
    mean: Vec<f64>,
    own: Vec<f64>,
}

impl Predictions {
    fn of(model: &Model, fitted: &Fitted) -> Self {
        Self {
            mean: model.predict(fitted, false),
            own: model.predict_with_own_strength(fitted),
        }
    }

    fn map(&self, pick: impl Fn(&Vec<f64>) -> Vec<f64>) -> Self {
        Self {
            mean: pick(&self.mean),
            own: pick(&self.own),
        }
    }

    fn tally(&self, measured: &[f64]) -> Tally {
        Tally::of(measured, &self.mean, &self.own)
    }
}

/// Predictions of one fold, one entry a held-out reading.
struct FoldResult {
    unit: String,
    measured: Vec<f64>,
    before: Predictions,
    after: Predictions,
    empirical: Option<Predictions>,
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
            before: self.before.map(pick),
            after: self.after.map(pick),
            empirical: self.empirical.as_ref().map(|p| p.map(pick)),
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
        Predictions::of(&Model { base, data, terms }, fitted)
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
        Scope::Whole => judge::name(t, &thin),
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
    let sum =
        |tallies: &mut dyn Iterator<Item = Tally>| tallies.fold(Tally::default(), Tally::plus);
    let tally = |of: &dyn Fn(&FoldResult) -> Predictions| {
        sum(&mut results.iter().map(|r| of(r).tally(&r.measured)))
    };
    // A black box knows no strengths.
    let boxed_error = |r: &FoldResult, f: &[f64]| Tally::of(&r.measured, f, f);
    let best_box = |of: &dyn Fn(&FoldResult) -> &Vec<Vec<f64>>| -> Option<(usize, f64)> {
        let error = |k: usize| sum(&mut results.iter().map(|r| boxed_error(r, &of(r)[k]))).rmse();
        (0..black_box::NOISE.len())
            .map(|k| (k, error(k)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let boxed = if results.is_empty() {
        None
    } else {
        best_box(&|r| &r.boxes)
    };
    let boxed_after = if results.is_empty() {
        None
    } else {
        best_box(&|r| &r.boxes_after)
    };
    let by_unit = results
        .iter()
        .map(|r| FoldErrors {
            unit: r.unit.clone(),
            readings: r.measured.len(),
            before: r.before.tally(&r.measured).rmse(),
            after: r.after.tally(&r.measured).rmse(),
            black_box: boxed.map(|(k, _)| boxed_error(r, &r.boxes[k]).rmse()),
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
