//! What a model says of actuators that took no part: folds, errors, predictive intervals, and the budget; all of torques alone, in N.m.
//!
//! One actuator at a time, the whole search without it. With one actuator nothing is held out: another test of the same actuator would share
//! its strength, and says nothing of an actuator that nobody has seen.

use super::problem::{TorqueProblem, component};
use super::terms::SIZES;
use crate::findings::{BudgetEntry, Errors, HeldOutBy, UnitErrors};
use crate::inference::fit::{Fitted, Setting};
use crate::inference::heldout::Unseen;
use crate::inference::problem::{Point, Problem};
use crate::inference::screen::Normal;
use crate::inference::search::{Decision, Found, Search};
use crate::numerics::distributions::normal_cdf;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The source of the budget that a better length gauge lowers.
pub const MOUNTING: &str = "mounting";
/// How many readings of each test are given, where a few are.
const GIVEN: [usize; 4] = [1, 2, 3, 5];
/// Two-sided 50 and 95% points of the normal distribution.
const QUANTILES: (f64, f64) = (0.674_489_750_196_082, 1.959_963_984_540_054);
/// Bins of the probability integral transform.
const BINS: usize = 10;

/// What was found without some nodes.
pub struct Fold {
    /// Names and nodes.
    pub nodes: Vec<(String, usize)>,
    /// Sizes of the effects that were found without them.
    pub sizes: [f64; SIZES],
}

/// Errors on readings that took no part.
#[derive(Default)]
struct Tally {
    squares: f64,
    calibrated: f64,
    count: usize,
    largest: f64,
    log_density: f64,
    after: BTreeMap<usize, (f64, usize)>,
    expected: f64,
    inside: (usize, usize),
    bins: [usize; BINS],
    sources: Vec<f64>,
}

/// Everything that is known of unseen actuators.
pub struct HeldOut {
    /// What was held out.
    pub by: HeldOutBy,
    /// Errors without and with effects, training errors not filled in.
    pub before: Errors,
    /// See `before`.
    pub after: Errors,
    /// One entry a unit.
    pub units: Vec<UnitErrors>,
    /// Sources of the expected squared error.
    pub budget: Vec<BudgetEntry>,
    /// Shares inside the 50 and 95% intervals; none where nothing was held out.
    pub inside: Option<(f64, f64)>,
    /// Histogram of the probability integral transform, as shares.
    pub pit: Vec<f64>,
    /// What each fold found.
    pub folds: Vec<Fold>,
}

struct Answer {
    fold: Fold,
    /// Unit, errors without and with effects.
    units: Vec<(String, Tally, Tally)>,
    terms: Vec<usize>,
}

/// The held-out errors, the whole search inside each fold.
pub fn held_out(
    setting: &Setting,
    problem: &TorqueProblem,
    found: &Found,
    decision: Decision,
    normal: &Normal,
) -> HeldOut {
    let (folds, by) = folds(setting, problem);
    let answer =
        |nodes: &Vec<(String, usize)>| answer(setting, problem, found, decision, normal, nodes);
    let answers: Vec<Answer> = folds.par_iter().map(answer).collect();
    let mut sums = (Tally::default(), Tally::default());
    let (mut units, mut folds) = (Vec::new(), Vec::new());
    for a in answers {
        for (unit, before, after) in a.units {
            let mut names: Vec<String> = Vec::new();
            for name in a
                .terms
                .iter()
                .map(|t| problem.library[*t].name(problem.data))
            {
                if !names.iter().any(|n| n == name) {
                    names.push(name.to_owned());
                }
            }
            units.push(UnitErrors {
                unit,
                readings: after.count,
                realised_over_expected: Some(after.squares / after.expected.max(f64::MIN_POSITIVE)),
                inside_95: Some(after.inside.1 as f64 / after.count.max(1) as f64),
                found: names,
                before: before.errors(),
                after: after.errors(),
            });
            sums.0.add(&before);
            sums.1.add(&after);
        }
        folds.push(a.fold);
    }
    let after = &sums.1;
    let share = |n: usize| n as f64 / after.count.max(1) as f64;
    let any = after.count > 0;
    HeldOut {
        by,
        before: sums.0.errors(),
        after: after.errors(),
        units,
        budget: after.budget(),
        inside: any.then(|| (share(after.inside.0), share(after.inside.1))),
        pit: after
            .bins
            .iter()
            .filter(|_| any)
            .map(|b| share(*b))
            .collect(),
        folds,
    }
}

/// Tests that their owner held out, or else each actuator in turn; names and nodes.
fn folds(setting: &Setting, problem: &TorqueProblem) -> (Vec<Vec<(String, usize)>>, HeldOutBy) {
    let named = |names: &[&str], nodes: &[Option<usize>]| -> Vec<(String, usize)> {
        let all = names.iter().zip(nodes);
        all.filter_map(|(name, node)| Some(((*name).to_owned(), (*node)?)))
            .collect()
    };
    let mut kept_out = named(&problem.data.tests, &problem.tests);
    kept_out.retain(|(_, node)| !setting.active[*node]);
    if !kept_out.is_empty() {
        return (vec![kept_out], HeldOutBy::Holdout);
    }
    let actuators = named(&problem.data.actuators, &problem.actuators);
    if actuators.len() < 2 {
        return (Vec::new(), HeldOutBy::None);
    }
    (
        actuators.into_iter().map(|a| vec![a]).collect(),
        HeldOutBy::Actuator,
    )
}

fn answer(
    setting: &Setting,
    problem: &TorqueProblem,
    found: &Found,
    decision: Decision,
    normal: &Normal,
    nodes: &[(String, usize)],
) -> Answer {
    let rest = nodes
        .iter()
        .fold(setting.clone(), |s, (_, node)| s.without(*node));
    let null = rest.fit_afresh(&problem.start());
    let search = Search {
        setting: &rest,
        decision,
        tried: None,
    };
    let inner = search.run_exchanging(null, normal, Some(&found.draws));
    let models = [&inner.null, &inner.model].map(|m| Unseen::new(&rest, m));
    let units = nodes.iter().map(|(unit, node)| {
        let [before, after] = [&models[0], &models[1]].map(|m| tally(m, *node, problem));
        (unit.clone(), before, after)
    });
    Answer {
        units: units.collect(),
        terms: inner.accepted.iter().map(|a| a.term).collect(),
        fold: Fold {
            nodes: nodes.to_vec(),
            sizes: problem.sizes(&inner.model.point),
        },
    }
}

/// Where a fit without some groups starts: their random effects are 0.
pub fn cleared(model: &Fitted, setting: &Setting) -> Point {
    let tree = setting.problem.tree();
    let mut point = model.point.clone();
    for node in (0..tree.len()).filter(|n| !setting.active[*n]) {
        let first = tree.first_column(node);
        point.random[first..first + tree.width(node)].fill(0.0);
    }
    point
}

fn tally(model: &Unseen, node: usize, problem: &TorqueProblem) -> Tally {
    let predicted = model.predict_where(node, |i| problem.is_torque(i));
    let mut tally = Tally {
        count: predicted.errors.len(),
        log_density: predicted.log_density,
        sources: predicted.sources.clone(),
        ..Tally::default()
    };
    for (e, sd) in predicted.errors.iter().zip(&predicted.sd) {
        tally.squares += e * e;
        tally.expected += sd * sd;
        tally.largest = tally.largest.max(e.abs());
        tally.inside.0 += usize::from(e.abs() <= QUANTILES.0 * sd);
        tally.inside.1 += usize::from(e.abs() <= QUANTILES.1 * sd);
        let bin = (normal_cdf(e / sd) * BINS as f64) as usize;
        tally.bins[bin.min(BINS - 1)] += 1;
    }
    for s in &mut tally.sources {
        *s *= tally.count as f64;
    }
    let squares = |errors: Vec<(usize, f64)>, known: &[usize]| -> (f64, usize) {
        let scored = errors
            .iter()
            .filter(|(i, _)| problem.is_torque(*i) && !known.contains(i));
        scored.fold((0.0, 0), |(sum, n), (_, e)| (sum + e * e, n + 1))
    };
    tally.calibrated = squares(model.errors_calibrated(node), &[]).0;
    for k in GIVEN {
        let known = first_readings(&predicted.places, problem, k);
        tally
            .after
            .insert(k, squares(model.errors_after(node, &known), &known));
    }
    tally
}

/// The first torques of each test in the order in which they were read.
fn first_readings(places: &[usize], problem: &TorqueProblem, count: usize) -> Vec<usize> {
    let mut given: BTreeMap<usize, usize> = BTreeMap::new();
    let is_given = |i: &&usize| {
        let n = given.entry(problem.node()[**i]).or_default();
        *n += 1;
        *n <= count
    };
    places.iter().filter(is_given).copied().collect()
}

impl Tally {
    fn add(&mut self, other: &Tally) {
        self.squares += other.squares;
        self.calibrated += other.calibrated;
        self.count += other.count;
        self.largest = self.largest.max(other.largest);
        self.log_density += other.log_density;
        self.expected += other.expected;
        self.inside.0 += other.inside.0;
        self.inside.1 += other.inside.1;
        for (a, b) in self.bins.iter_mut().zip(other.bins) {
            *a += b;
        }
        self.sources
            .resize(other.sources.len().max(self.sources.len()), 0.0);
        for (a, b) in self.sources.iter_mut().zip(&other.sources) {
            *a += b;
        }
        for (k, (squares, n)) in &other.after {
            let sum = self.after.entry(*k).or_default();
            sum.0 += squares;
            sum.1 += n;
        }
    }

    fn errors(&self) -> Errors {
        let n = self.count as f64;
        let any = self.count > 0;
        let mean = |sum: f64| any.then(|| (sum / n).sqrt());
        let after = self.after.iter().filter(|(_, (_, n))| *n > 0);
        Errors {
            rmse_train: 0.0,
            rmse_heldout: mean(self.squares),
            max_abs_error_heldout: any.then_some(self.largest),
            rmse_heldout_calibrated: mean(self.calibrated),
            rmse_heldout_after: after
                .map(|(k, (squares, n))| (k.to_string(), (squares / *n as f64).sqrt()))
                .collect(),
            log_density_heldout: any.then(|| self.log_density / n),
        }
    }

    /// The expected squared error by source, largest first.
    fn budget(&self) -> Vec<BudgetEntry> {
        if self.count == 0 {
            return Vec::new();
        }
        let last = self.sources.len() - 1;
        let name = |k: usize| match k {
            component::GAIN => "actuator_gain",
            component::MOUNTING => MOUNTING,
            component::ZERO => "torque_zero",
            component::TEST_MISFIT => "test_misfit",
            k if k == last => "noise",
            _ => "estimation",
        };
        let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
        for (k, variance) in self.sources.iter().enumerate() {
            *sums.entry(name(k)).or_default() += variance / self.count as f64;
        }
        let mut budget: Vec<BudgetEntry> = sums
            .into_iter()
            .map(|(source, variance)| BudgetEntry {
                source: source.to_owned(),
                variance,
                rmse: variance.sqrt(),
                unit: "N.m".to_owned(),
            })
            .collect();
        budget.sort_by(|a, b| b.variance.total_cmp(&a.variance));
        budget
    }
}
