//! What a model says of specimens that took no part: folds, errors in their three forms, predictive intervals, and the budget.

use super::black_box::{self, Features};
use super::length_law::{Outcome, of_active};
use super::problem::{ForceProblem, component};
use super::tally::{Scored, Tally};
use pipeline_findings::{BudgetEntry, Errors, HeldOutBy, UnitErrors};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::{Point, Problem};
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Decision, Found, Search};
use rayon::prelude::*;

/// The source of the budget that a better length gauge lowers.
pub const SET_LENGTH: &str = "set_length";
/// The source of the budget that is what contracted lengths scatter by beside their rounding.
pub const CONTRACTED_LENGTH: &str = "contracted_length";
/// The source of the budget that is the rounding of both free lengths of the specimens.
pub const SPECIMEN_LENGTHS: &str = "specimen_lengths";
/// Most folds: with more specimens, groups of them are held out together.
const MOST_FOLDS: usize = 8;

/// Nodes that are held out together.
struct Fold {
    nodes: Vec<(String, usize)>,
}

/// Everything that is known of unseen specimens.
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
    /// Names of what the search without each fold found.
    pub searches: Vec<Vec<String>>,
    /// Root mean square error of a smooth black box, N; none where nothing was held out.
    pub black_box_rmse: Option<f64>,
}

/// The held-out errors, the whole search inside each fold. `setting` marks the nodes that were searched.
pub fn held_out(
    outcome: &Outcome,
    setting: &Setting,
    decision: Decision,
    normal: &Normal,
    named: impl Fn(usize) -> String + Sync,
) -> HeldOut {
    let problem = &outcome.problem;
    let (folds, by) = folds(setting, problem);
    // Where a search starts from what all readings gave, candidates from nothing are not needed.
    let decision = Decision {
        thorough: false,
        ..decision
    };
    let answers: Vec<FoldAnswer> = folds
        .par_iter()
        .map(|fold| answer(outcome, setting, decision, normal, fold))
        .collect();
    let mut sums = (Tally::default(), Tally::default());
    let mut units = Vec::new();
    let mut searches = Vec::new();
    let mut of_black_box = [0.0; black_box::NOISE.len()];
    for a in answers {
        let squares = of_black_box.iter_mut().zip(&a.black_box);
        squares.for_each(|(sum, s)| *sum += s);
        let found: Vec<String> = a.terms.iter().map(|t| named(*t)).collect();
        for (unit, before, after) in a.units {
            units.push(UnitErrors {
                unit,
                readings: after.count,
                realised_over_expected: Some(after.squares / after.expected.max(f64::MIN_POSITIVE)),
                inside_95: Some(after.inside.1 as f64 / after.count.max(1) as f64),
                found: found.clone(),
                before: before.errors(),
                after: after.errors(),
            });
            sums.0.add(&before);
            sums.1.add(&after);
        }
        searches.push(found);
    }
    let after = &sums.1;
    let black_box_rmse = least_error(of_black_box, after.count);
    HeldOut {
        by,
        black_box_rmse,
        before: sums.0.errors(),
        after: after.errors(),
        units,
        budget: after.budget("N", source),
        inside: after.shares_inside(),
        pit: after.pit(),
        left: [&sums.0, after].map(|t| t.left_of(problem.data.len())),
        searches,
    }
}

struct FoldAnswer {
    /// Unit, errors without and with effects.
    units: Vec<(String, Tally, Tally)>,
    terms: Vec<usize>,
    black_box: Vec<f64>,
}

/// Sessions that their owner held out, or else each specimen in turn.
fn folds(setting: &Setting, problem: &ForceProblem) -> (Vec<Fold>, HeldOutBy) {
    let kept_out: Vec<(String, usize)> = problem
        .sessions
        .iter()
        .zip(&problem.data.sessions)
        .filter(|(n, _)| !setting.active[**n])
        .map(|(n, id)| (id.clone(), *n))
        .collect();
    if !kept_out.is_empty() {
        return (vec![Fold { nodes: kept_out }], HeldOutBy::Holdout);
    }
    let specimens: Vec<(String, usize)> = problem
        .data
        .specimens
        .iter()
        .cloned()
        .zip(problem.specimens.iter().copied())
        .collect();
    if specimens.len() < 2 {
        return (Vec::new(), HeldOutBy::None);
    }
    if specimens.len() <= MOST_FOLDS {
        let one = |s: (String, usize)| Fold { nodes: vec![s] };
        return (
            specimens.into_iter().map(one).collect(),
            HeldOutBy::Specimen,
        );
    }
    let mut folds: Vec<Fold> = (0..MOST_FOLDS)
        .map(|_| Fold { nodes: Vec::new() })
        .collect();
    for (k, s) in specimens.into_iter().enumerate() {
        folds[k % MOST_FOLDS].nodes.push(s);
    }
    (folds, HeldOutBy::SpecimenGroups)
}

/// A search without a fold.
struct WithoutFold<'a> {
    setting: Setting<'a>,
    problem: &'a ForceProblem<'a>,
    found: Found,
}

impl<'a> WithoutFold<'a> {
    /// From what all readings gave.
    fn new(
        (setting, problem): (Setting<'a>, &'a ForceProblem<'a>),
        found: &Found,
        decision: Decision,
        normal: &Normal,
        fold: &Fold,
    ) -> Self {
        let (rest, from) = without(&setting, &found.null, fold);
        // From the fit to all readings and from nothing: without one of a handful of specimens another optimum may be the best.
        let near = rest.fit(&from, std::slice::from_ref(&found.null.variances));
        let afresh = rest.fit_afresh(&problem.start());
        let null = if afresh.log_likelihood > near.log_likelihood {
            afresh
        } else {
            near
        };
        let search = Search {
            setting: &rest,
            decision,
            tried: Some(&found.model),
        };
        let found = search.run(null, normal, Some(&found.draws));
        Self {
            setting: rest,
            problem,
            found,
        }
    }

    fn unseen<'s>(&'s self, model: &'s Fitted) -> Unseen<'s> {
        Unseen::new(&self.setting, model)
    }
}

fn answer(
    outcome: &Outcome,
    setting: &Setting,
    decision: Decision,
    normal: &Normal,
    fold: &Fold,
) -> FoldAnswer {
    let problem = &outcome.problem;
    let of = |model, found| WithoutFold::new(model, found, decision, normal, fold);
    let mut chosen = of((setting.clone(), problem), &outcome.found);
    // Whether what was found takes the place of the law's dependence on the resting length is asked in the fold as well.
    let with = outcome.replaced.as_ref().map(|r| {
        let with = of((of_active(&r.problem, setting), &r.problem), &r.found);
        let gives_way = r.gives_way(&with.found, &chosen.found, &chosen.setting, decision);
        (with, gives_way)
    });
    let known = match with {
        Some((with, true)) => Some(with),
        Some((with, false)) => {
            chosen = with;
            None
        }
        None => None,
    };
    let known = known.as_ref().unwrap_or(&chosen);
    let models = [
        (known.problem, known.unseen(&known.found.null)),
        (chosen.problem, chosen.unseen(&chosen.found.model)),
    ];
    let units = fold.nodes.iter().map(|(unit, node)| {
        let [before, after] = [0, 1].map(|k| tally(&models[k].1, *node, models[k].0, false));
        (unit.clone(), before, after)
    });
    let accepted: Vec<usize> = chosen.found.accepted.iter().map(|a| a.term).collect();
    FoldAnswer {
        black_box: black_box(&known.setting, &known.found.null, known.problem, fold),
        units: units.collect(),
        terms: accepted
            .iter()
            .copied()
            .filter(|t| !problem.is_origin(*t, &accepted))
            .collect(),
    }
}

/// Root mean square error and mean log density of held-out readings of a fitted model, fitted again without each fold; none where nothing is
/// held out.
pub fn of_model(setting: &Setting, problem: &ForceProblem, fit: &Fitted) -> Option<(f64, f64)> {
    let (folds, _) = folds(setting, problem);
    let tallies: Vec<Tally> = folds
        .par_iter()
        .map(|fold| {
            let (rest, from) = without(setting, fit, fold);
            let again = rest.fit(&from, std::slice::from_ref(&fit.variances));
            let model = Unseen::new(&rest, &again);
            let mut sum = Tally::default();
            for (_, node) in &fold.nodes {
                sum.add(&tally(&model, *node, problem, true));
            }
            sum
        })
        .collect();
    let mut sum = Tally::default();
    tallies.iter().for_each(|t| sum.add(t));
    let errors = sum.errors();
    Some((errors.rmse_heldout?, errors.log_density_heldout?))
}

/// The setting without a fold, and the point where fits of a model start there.
fn without<'a>(setting: &Setting<'a>, fit: &Fitted, fold: &Fold) -> (Setting<'a>, Point) {
    let rest = fold
        .nodes
        .iter()
        .fold(setting.clone(), |s, (_, node)| s.without(*node));
    let from = fit.cleared(&rest);
    (rest, from)
}

/// Sums over the readings of a unit; without the errors after a few readings if only those `unseen` are asked for.
fn tally(model: &Unseen, node: usize, problem: &ForceProblem, unseen: bool) -> Tally {
    let scored = Scored {
        takes: &|_| true,
        setup: &|i| problem.data.session[i],
        alone: None,
    };
    let of = if unseen { Tally::unseen } else { Tally::new };
    of(model, node, &scored)
}

/// The source of a component, as the budget names it.
fn source(component: usize) -> Option<&'static str> {
    match component {
        component::GAIN => Some("specimen_gain"),
        component::SET_LENGTH | component::DECLARED_LENGTH => Some(SET_LENGTH),
        component::ZERO => Some("force_zero"),
        component::REST_LENGTH | component::CONTRACTED_LENGTH => Some(SPECIMEN_LENGTHS),
        component::CONTRACTION => Some(CONTRACTED_LENGTH),
        component::SESSION_MISFIT => Some("session_misfit"),
        component::STROKE_MISFIT => Some("stroke_misfit"),
        _ => None,
    }
}

/// Squared errors of a smooth black box at the readings of a fold, summed, for each noise that it may have. It sees what the law of
/// the null model leaves, its common misfit included, fitted without the fold as every other model that the fold judges.
fn black_box(setting: &Setting, null: &Fitted, problem: &ForceProblem, fold: &Fold) -> Vec<f64> {
    let tree = problem.tree();
    let is_held = |i: &usize| {
        let path = tree.path(problem.node()[*i]);
        fold.nodes.iter().any(|(_, n)| path.contains(n))
    };
    // Without what specimens and sessions have of their own.
    let mut predicted = problem.predict(&problem.bare(&null.point));
    predicted.truncate(problem.data.len());
    let forces = problem.data.force.iter().zip(&predicted);
    let residual: Vec<f64> = forces.map(|(y, p)| y - p).collect();
    let all = 0..residual.len();
    let (held, others): (Vec<usize>, Vec<usize>) = all.partition(is_held);
    let mut train = others;
    train.retain(|i| setting.active[problem.node()[*i]]);
    let features = Features::new(problem.data, &predicted);
    let square = |answer: &Vec<f64>| -> f64 {
        let left = held.iter().zip(answer).map(|(i, p)| residual[*i] - p);
        left.map(|e| e * e).sum()
    };
    let answers = black_box::predict(&features, &residual, &train, &held);
    answers.iter().map(square).collect()
}

/// The least of the root mean squares over the noises of the black box.
fn least_error(sums: [f64; black_box::NOISE.len()], readings: usize) -> Option<f64> {
    let mean = sums.map(|s| s / readings.max(1) as f64);
    let least = mean.into_iter().min_by(f64::total_cmp);
    least
        .filter(|m| readings > 0 && m.is_finite())
        .map(f64::sqrt)
}
