//! What is worth measuring next: quantities known better, more specimens, more set points, and set points that tell alternatives apart.

use super::answer::{relative_contraction, rms};
use super::data::Data;
use super::problem::{ForceProblem, component};
use super::{settings, unseen};
use pipeline_findings::{BudgetEntry, NextKind, NextMeasurement};
use pipeline_inference::fit::Setting;
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::{Point, Problem};
use pipeline_inference::search::Found;
use pipeline_inference::system::Variances;
use std::collections::{BTreeMap, BTreeSet};

/// Set points that are proposed together.
const SET_POINTS: usize = 5;
/// Steps of the grid of set points: relative contraction, pressure in kPa.
const GRID: (f64, f64) = (0.1, 100.0);

/// Everything that is worth measuring, best first; what separates alternatives, which is worth no newtons, stands before the rest.
pub fn next(
    setting: &Setting,
    problem: &ForceProblem,
    found: &Found,
    budget: &[BudgetEntry],
) -> Vec<NextMeasurement> {
    if budget.is_empty() {
        return Vec::new();
    }
    let model = Unseen::new(setting, &found.model);
    let mut list = by_budget(problem, model.variances(), budget);
    list.extend(set_points(setting, problem, &model, budget));
    list.retain(|n| n.worth.is_some_and(|w| w > 0.0));
    let worth = |n: &NextMeasurement| n.worth.unwrap_or(0.0);
    list.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    let mut all = separating(setting, problem, found, &model);
    all.extend(list);
    all
}

/// By how much the expected error falls if a source of its budget falls.
fn fall(budget: &[BudgetEntry], less: f64) -> f64 {
    let total: f64 = budget.iter().map(|b| b.variance).sum();
    total.sqrt() - (total - less).max(0.0).sqrt()
}

/// Set lengths known better, or both free lengths of the specimens, and as many specimens again.
fn by_budget(
    problem: &ForceProblem,
    variances: &Variances,
    budget: &[BudgetEntry],
) -> Vec<NextMeasurement> {
    let of = |name: &str| {
        let found = budget.iter().find(|b| b.source == name);
        found.map_or(0.0, |b| b.variance)
    };
    let specimens = problem.data.specimens.len() as f64;
    // The variance of estimates falls with the number of specimens; with as many again, to half.
    let more = 0.5 * of("estimation");
    let entry = |kind, separates: Vec<String>, (key, value): (&str, f64), less| NextMeasurement {
        kind,
        separates,
        at: BTreeMap::from([(key.to_owned(), value)]),
        worth: Some(fall(budget, less)),
        unit: "N".to_owned(),
    };
    let known_better = |sources: &[(&str, f64)]| {
        let less_of = |(source, sd): &(&str, f64)| {
            let known = settings::CALIPER_MM / sd.max(settings::CALIPER_MM);
            of(source) * (1.0 - known * known)
        };
        let less = sources.iter().map(less_of).sum();
        let names = sources.iter().map(|(source, _)| (*source).to_owned());
        let at = ("sd_mm", settings::CALIPER_MM);
        entry(NextKind::Precision, names.collect(), at, less)
    };
    vec![
        known_better(&[(unseen::SET_LENGTH, set_length_sd_mm(problem, variances))]),
        known_better(&[
            (unseen::SPECIMEN_LENGTHS, free_lengths_sd_mm(problem)),
            (
                unseen::CONTRACTED_LENGTH,
                contracted_length_sd_mm(problem, variances),
            ),
        ]),
        entry(
            NextKind::Specimens,
            Vec::new(),
            ("specimens", specimens),
            more,
        ),
    ]
}

/// Root mean square of the standard deviations of the set lengths, declared or estimated, mm.
fn set_length_sd_mm(problem: &ForceProblem, variances: &Variances) -> f64 {
    let estimated = variances.components[component::SET_LENGTH];
    // 1 unless the readings contradict what was declared.
    let of_declared = variances.components[component::DECLARED_LENGTH];
    let all = problem.data.set_length_sd_mm.iter().map(|declared| {
        if declared.is_finite() {
            of_declared * declared
        } else {
            estimated
        }
    });
    rms(&all.collect::<Vec<f64>>())
}

/// Root mean square of the standard deviations of the contracted lengths that nobody declares, mm.
fn contracted_length_sd_mm(problem: &ForceProblem, variances: &Variances) -> f64 {
    let data = problem.data;
    let all = data.rest_lengths_mm().into_iter().enumerate();
    let noted = all.filter(|(k, _)| !data.contracted_is_declared(*k));
    let lengths_mm: Vec<f64> = noted.map(|(_, mm)| mm).collect();
    variances.components[component::CONTRACTION] * rms(&lengths_mm)
}

/// Root mean square of the standard deviations with which resting and contracted lengths were noted, mm.
fn free_lengths_sd_mm(problem: &ForceProblem) -> f64 {
    let specimens = 0..problem.data.specimens.len();
    let all: Vec<f64> = specimens
        .flat_map(|k| problem.specimen_lengths_sd_mm(k))
        .collect();
    rms(&all)
}

/// One reading for each set point of each specimen that was searched and pulls.
fn candidates(setting: &Setting, problem: &ForceProblem) -> Vec<usize> {
    let mut known = BTreeSet::new();
    (0..problem.data.len())
        .filter(|&i| setting.active[problem.node()[i]] && problem.pulls(i))
        .filter(|&i| {
            let at = &problem.data.conditions[i];
            let on_grid = [relative_contraction(at) / GRID.0, at.pressure_kpa / GRID.1];
            known.insert((problem.data.specimen[i], on_grid.map(|x| x.round() as i64)))
        })
        .collect()
}

/// The conditions of a reading, as findings name them.
fn conditions(data: &Data, i: usize) -> BTreeMap<String, f64> {
    let at = &data.conditions[i];
    BTreeMap::from([
        ("rest_length_mm".to_owned(), 1e3 * at.rest_length_m),
        ("contraction_rel".to_owned(), relative_contraction(at)),
        ("pressure_kpa".to_owned(), at.pressure_kpa),
    ])
}

/// The same with the sense of the motion and the time in the log, where these are known: alternatives may differ in nothing else.
fn with_history(mut at: BTreeMap<String, f64>, data: &Data, i: usize) -> BTreeMap<String, f64> {
    let here = &data.conditions[i];
    // Both are 0 where they were not noted.
    let history = [("direction", here.direction), ("time_s", here.log_time_s)];
    let noted = history.into_iter().filter(|(_, x)| *x != 0.0);
    at.extend(noted.map(|(key, x)| (key.to_owned(), x)));
    at
}

/// The set points of which one reading more, each in a session of its own, lowers the error of estimation most: together, and each with those of
/// them that repeat it.
fn set_points(
    setting: &Setting,
    problem: &ForceProblem,
    model: &Unseen,
    budget: &[BudgetEntry],
) -> Vec<NextMeasurement> {
    let active = (0..problem.data.len()).filter(|i| setting.active[problem.node()[*i]]);
    let targets: Vec<usize> = active.collect();
    let best = model.best_additions(&candidates(setting, problem), &targets, SET_POINTS);
    let all: f64 = best.iter().map(|(_, less)| less).sum();
    let entry = |at, less| NextMeasurement {
        kind: NextKind::SetPoints,
        separates: Vec::new(),
        at,
        worth: Some(fall(budget, less)),
        unit: "N".to_owned(),
    };
    let together = BTreeMap::from([("set_points".to_owned(), best.len() as f64)]);
    let mut points: BTreeMap<usize, f64> = BTreeMap::new();
    for (i, less) in best {
        *points.entry(i).or_default() += less;
    }
    let each = points.into_iter();
    let each = each.map(|(i, less)| entry(conditions(problem.data, i), less));
    let mut list: Vec<NextMeasurement> = each.collect();
    list.push(entry(together, all));
    list
}

/// For every alternative that does as well as an effect: the set point at which one reading in a session of its own tells them apart best, and
/// the gain in log-likelihood that is expected of it.
fn separating(
    setting: &Setting,
    problem: &ForceProblem,
    found: &Found,
    model: &Unseen,
) -> Vec<NextMeasurement> {
    let candidates = candidates(setting, problem);
    let bare = |point: &Point| problem.predict(&problem.bare(point));
    let chosen = bare(&found.model.point);
    let mut list = Vec::new();
    for accepted in &found.accepted {
        for other in &accepted.in_its_place {
            let ids = [accepted.term, other.term].map(|t| problem.library[t].id());
            let [Some(one), Some(two)] = ids else {
                continue;
            };
            let instead = bare(&other.point);
            let gain = |i: usize| {
                let d = chosen[i] - instead[i];
                0.5 * d * d / model.variance_in_new_groups(i)
            };
            let best = candidates.iter().map(|&i| (i, gain(i)));
            if let Some((i, worth)) = best.max_by(|a, b| a.1.total_cmp(&b.1)) {
                list.push(NextMeasurement {
                    kind: NextKind::Separate,
                    separates: vec![one.to_owned(), two.to_owned()],
                    at: with_history(conditions(problem.data, i), problem.data, i),
                    worth: Some(worth),
                    unit: "1".to_owned(),
                });
            }
        }
    }
    list
}
