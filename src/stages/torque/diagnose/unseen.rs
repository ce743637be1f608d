//! What a model says of actuators that took no part: folds, errors, predictive intervals, and the budget; all of torques alone, in N.m.
//!
//! What is called the error is that of law and effects alone, as somebody meets it who takes these into a design: neither random effects nor the misfit
//! of the law, whose share of the expected error is an entry of the budget. Densities and intervals are those of the whole model.
//!
//! One actuator at a time, the whole search without it. With one actuator nothing is held out: another test of the same actuator would share
//! its gain, and says nothing of an actuator that nobody has seen.

use super::problem::{TorqueProblem, component};
use super::terms::SIZES;
use pipeline_diagnose::tally::{Scored, Tally};
use pipeline_findings::{BudgetEntry, Errors, HeldOutBy, UnitErrors};
use pipeline_inference::fit::Setting;
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::{Point, Problem};
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Decision, Found, Search};
use rayon::prelude::*;

/// The source of the budget that a better length gauge lowers.
pub const MOUNTING: &str = "mounting";
/// What was found without some nodes.
pub struct Fold {
    /// Names and nodes.
    pub nodes: Vec<(String, usize)>,
    /// Sizes of the effects that were found without them.
    pub sizes: [f64; SIZES],
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
    /// Measured less predicted without and with effects, one value a reading; NaN of those that were not held out.
    pub left: [Vec<f64>; 2],
    /// What each fold found.
    pub folds: Vec<Fold>,
}

struct Answer {
    fold: Fold,
    /// Unit, errors without and with effects.
    units: Vec<(String, Tally, Tally)>,
    terms: Vec<usize>,
}

/// The held-out errors, the whole search inside each fold; `held` are the tests that their owner held out.
pub fn held_out(
    setting: &Setting,
    problem: &TorqueProblem,
    held: &[bool],
    found: &Found,
    decision: Decision,
    normal: &Normal,
) -> HeldOut {
    let (folds, by) = folds(problem, held);
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
    HeldOut {
        by,
        before: sums.0.errors(),
        after: after.errors(),
        units,
        budget: after.budget("N.m", source),
        inside: after.shares_inside(),
        pit: after.pit(),
        left: [&sums.0, after].map(|t| t.left_of(problem.observed().len())),
        folds,
    }
}

/// Tests that their owner held out, or else each actuator in turn; names and nodes.
fn folds(problem: &TorqueProblem, held: &[bool]) -> (Vec<Vec<(String, usize)>>, HeldOutBy) {
    let named = |names: &[&str], nodes: &[Option<usize>]| -> Vec<(String, usize)> {
        let all = names.iter().zip(nodes);
        all.filter_map(|(name, node)| Some(((*name).to_owned(), (*node)?)))
            .collect()
    };
    let of_owner = problem.tests.iter().zip(held);
    let of_owner: Vec<Option<usize>> = of_owner.map(|(n, held)| n.filter(|_| *held)).collect();
    let kept_out = named(&problem.data.tests, &of_owner);
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
        let [before, after] = [(&models[0], &inner.null), (&models[1], &inner.model)]
            .map(|(unseen, fitted)| tally(unseen, &fitted.point, *node, problem));
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

fn tally(model: &Unseen, point: &Point, node: usize, problem: &TorqueProblem) -> Tally {
    let alone = |i: usize| problem.observed()[i] - problem.without_scatter(point, i);
    let scored = Scored {
        takes: &|i| problem.is_torque(i),
        setup: &|i| problem.node()[i],
        alone: Some(&alone),
    };
    Tally::new(model, node, &scored)
}

/// The source of a component, as the budget names it.
fn source(component: usize) -> Option<&'static str> {
    match component {
        component::GAIN => Some("actuator_gain"),
        component::MOUNTING => Some(MOUNTING),
        component::ZERO => Some("torque_zero"),
        component::TEST_MISFIT => Some("test_misfit"),
        _ => None,
    }
}
