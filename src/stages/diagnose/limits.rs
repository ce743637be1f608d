//! What this campaign could have shown: the smallest detectable amplitude of every effect, effects that it cannot show, and pairs with nearly
//! one sensitivity.

use super::data::Data;
use super::library::{Scope, Term, What};
use super::problem::ForceProblem;
use crate::effects::{self, Need};
use crate::findings::{Alias, DetectionLimit, NotMeasurable, WhyNot};
use crate::inference::fit::{Fitted, Setting};
use crate::inference::problem::{Direction, Problem};
use crate::inference::screen::{IDENTIFIABLE, Screen};
use crate::inference::statistic::likelihood_ratio;
use crate::inference::system::{Factor, Panel};

/// Normal deviate of a power of 80%.
const POWER: f64 = 0.841_621_233_572_914;
/// Cosine from which two sensitivities are reported as nearly one.
const NEARLY_ONE: f64 = 0.9;

/// The answers.
pub struct Limits {
    /// One entry an effect's form, the smallest.
    pub smallest: Vec<DetectionLimit>,
    /// What cannot be shown.
    pub not_measurable: Vec<NotMeasurable>,
    /// Pairs.
    pub aliases: Vec<Alias>,
}

/// The limits beside a model, for a critical value of the family-wise test.
pub fn limits(setting: &Setting, problem: &ForceProblem, model: &Fitted, critical: f64) -> Limits {
    let wanted = likelihood_ratio(critical, 1).sqrt() + POWER;
    let all: Vec<Direction> = problem
        .directions(&model.point)
        .into_iter()
        .filter(|d| problem.library[d.term].scope == Scope::All)
        .collect();
    let screen = Screen::of(setting, model, all);
    let shown = screen.shown(0);
    let mut smallest: Vec<DetectionLimit> = Vec::new();
    let mut not_measurable = missing(problem.data);
    for (effect, e) in effects::all().iter().enumerate() {
        let of = |term: &Term| matches!(term.what, What::Effect { effect: k, .. } if k == effect);
        let in_model = model
            .point
            .terms
            .iter()
            .any(|(t, _)| of(&problem.library[*t]));
        let mine: Vec<_> = shown
            .iter()
            .filter(|s| of(&problem.library[screen.directions[s.direction].term]))
            .collect();
        if mine.is_empty() {
            let asked = problem.library.iter().any(of);
            if asked && !in_model {
                not_measurable.push(NotMeasurable {
                    id: e.id().to_owned(),
                    reason: WhyNot::Absorbed,
                    by: None,
                    form: None,
                });
            }
            continue;
        }
        let before = smallest.len();
        for s in mine {
            let term = &problem.library[screen.directions[s.direction].term];
            let Some(form) = term.form() else { continue };
            let size = wanted / s.length;
            let (low, high) = form.amplitude.bounds;
            if size > high.abs().max(low.abs()) {
                continue;
            }
            let limit = DetectionLimit {
                id: e.id().to_owned(),
                form: form.name.to_owned(),
                smallest: size,
                unit: form.amplitude.unit.to_owned(),
                identifiable_share: s.share,
            };
            match smallest[before..].iter_mut().find(|l| l.form == form.name) {
                Some(known) if known.smallest > size => *known = limit,
                Some(_) => {}
                None => smallest.push(limit),
            }
        }
        if smallest.len() == before {
            not_measurable.push(NotMeasurable {
                id: e.id().to_owned(),
                reason: WhyNot::Bound,
                by: None,
                form: None,
            });
        }
    }
    let aliases = aliases(setting, problem, model, &screen);
    Limits {
        smallest,
        not_measurable,
        aliases,
    }
}

/// Effects that lack a quantity.
fn missing(data: &Data) -> Vec<NotMeasurable> {
    let lacks = |e: &&dyn effects::Effect| {
        let needs = e.forms().iter().map(|f| f.needs);
        let mut lacking = needs.map(|n| n.iter().find(|n| data.missing.contains_key(n)));
        lacking
            .clone()
            .all(|n| n.is_some())
            .then(|| lacking.find_map(|n| n.copied()))
    };
    effects::all()
        .iter()
        .filter_map(|e| Some((e.id(), lacks(e)??)))
        .map(|(id, need)| {
            let is_of_base = need == Need::LengthLaw;
            NotMeasurable {
                id: id.to_owned(),
                reason: if is_of_base {
                    WhyNot::Absorbed
                } else {
                    WhyNot::NoColumn
                },
                by: (!is_of_base).then(|| need.words().to_owned()),
                form: None,
            }
        })
        .collect()
}

/// Pairs of effects, each by its most visible form, whose whitened sensitivities are nearly parallel.
fn aliases(
    setting: &Setting,
    problem: &ForceProblem,
    model: &Fitted,
    screen: &Screen,
) -> Vec<Alias> {
    let mut best: Vec<(&'static str, Vec<f64>, f64)> = Vec::new();
    for s in screen.shown(0) {
        let direction = &screen.directions[s.direction];
        let Some(id) = problem.library[direction.term].id() else {
            continue;
        };
        if s.share > IDENTIFIABLE && best.iter().all(|(known, ..)| *known != id) {
            best.push((id, direction.columns[0].clone(), s.length));
        }
    }
    let mut columns: Vec<Vec<f64>> = best.iter().map(|(_, c, l)| scaled(c, 1.0 / l)).collect();
    let pairs: Vec<(usize, usize)> = (0..best.len())
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .collect();
    for &(i, j) in &pairs {
        let sum = columns[i].iter().zip(&columns[j]).map(|(a, b)| a + b);
        let sum = sum.collect();
        columns.push(sum);
    }
    let panel = Panel::of_active(&model.design, &columns, |n| setting.active[n]);
    let projected = Factor::new(&model.design.tree, &model.gram, &model.variances).project(&panel);
    let mut aliases: Vec<Alias> = pairs
        .iter()
        .enumerate()
        .map(|(k, &(i, j))| {
            let product = 0.5
                * (projected.squares[best.len() + k] - projected.squares[i] - projected.squares[j]);
            let norm = (projected.squares[i] * projected.squares[j]).sqrt();
            Alias {
                ids: [best[j].0.to_owned(), best[i].0.to_owned()],
                cosine: product / norm,
            }
        })
        .filter(|a| a.cosine.abs() >= NEARLY_ONE)
        .collect();
    aliases.sort_by(|a, b| b.cosine.abs().total_cmp(&a.cosine.abs()));
    aliases
}

fn scaled(column: &[f64], factor: f64) -> Vec<f64> {
    column.iter().map(|x| x * factor).collect()
}
