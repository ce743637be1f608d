//! What this campaign could have shown: the smallest detectable amplitude of every effect and dependence on every column, effects that it cannot
//! show, and pairs with nearly one sensitivity.

use super::base::LENGTH_LAW;
use super::data::Data;
use super::library::{Scope, Term, What};
use super::problem::ForceProblem;
use pipeline_effects as effects;
use pipeline_effects::Need;
use pipeline_findings::{Alias, ColumnLimit, DetectionLimit, NotMeasurable, WhyNot};
use pipeline_inference::decisions::{IDENTIFIABLE, PARALLEL};
use pipeline_inference::fit::{Fitted, Free, Setting};
use pipeline_inference::power::{Power, strength, wanted};
use pipeline_inference::problem::{Direction, Problem};
use pipeline_inference::screen::Screen;
use pipeline_inference::statistic::likelihood_ratio;
use pipeline_inference::system::{Factor, Panel};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// How often a size is sought again with the column that an effect has at the size before. Halfway between the two, for what shows as the square
/// of its size would alternate.
const SETTLING: usize = 6;
/// How often a size is sought again by fits, halfway as well: some effects hardly show below a size, and soon above it.
const REFITS: usize = 5;
/// A size that changes by less than this share is found.
const REFOUND: f64 = 0.02;
/// Share of a sensitivity below which it is: what other coefficients take up depends on the size.
const TAKEN_UP: f64 = 0.7;
/// Share of its largest size at which a dependence on a column is looked at first.
const SMALL: f64 = 1e-3;

/// The answers.
pub struct Limits {
    /// One entry an effect's form, the smallest.
    pub smallest: Vec<DetectionLimit>,
    /// One entry a column and shape.
    pub columns: Vec<ColumnLimit>,
    /// What cannot be shown.
    pub not_measurable: Vec<NotMeasurable>,
    /// Pairs.
    pub aliases: Vec<Alias>,
}

/// The limits beside a model, for a critical value of the family-wise test.
pub fn limits(setting: &Setting, problem: &ForceProblem, model: &Fitted, critical: f64) -> Limits {
    let mut all: Vec<Direction> = problem
        .directions(&model.point)
        .into_iter()
        .filter(|d| {
            let term = &problem.library[d.term];
            term.scope == Scope::All && term.form().is_some()
        })
        .collect();
    let lines = columns_beside(problem, model);
    all.extend(lines.map(|t| problem.direction_at(&model.point, t, SMALL * largest(problem, t))));
    let screen = Screen::of(setting, model, all);
    let sizes = settled(setting, problem, model, critical, &screen);
    let mut smallest: Vec<DetectionLimit> = Vec::new();
    let mut not_measurable = missing(problem);
    for effect in 0..effects::all().len() {
        match of_effect(effect, problem, model, &sizes) {
            Shown::From(limits) => smallest.extend(limits),
            Shown::Not(reason) => not_measurable.push(NotMeasurable {
                id: effects::all()[effect].id().to_owned(),
                reason,
                by: (reason == WhyNot::Absorbed)
                    .then(|| absorbing(problem, model, &screen, effect))
                    .flatten(),
                form: None,
            }),
            Shown::NotAsked => {}
        }
    }
    let aliases = aliases(problem, model, &screen);
    Limits {
        smallest,
        columns: of_columns(problem, model, &sizes),
        not_measurable,
        aliases,
    }
}

/// The smallest size of a term that is found, and the share that the fixed effects leave of it, by term.
type Sizes = BTreeMap<usize, (f64, f64)>;

/// The sizes with the columns that the effects have at these very sizes.
fn settled(
    setting: &Setting,
    problem: &ForceProblem,
    model: &Fitted,
    critical: f64,
    screen: &Screen,
) -> Sizes {
    let power = Power::new(setting, model);
    let mut sizes = sizes(screen, &power, problem, critical);
    for _ in 0..SETTLING {
        let at = |(t, (size, _)): (&usize, &(f64, f64))| {
            let within = size.min(largest(problem, *t));
            problem.direction_at(&model.point, *t, within)
        };
        let there = Screen::of(setting, model, sizes.iter().map(at).collect());
        let mut next = self::sizes(&there, &power, problem, critical);
        for (t, (size, _)) in &mut next {
            *size = sizes
                .get(t)
                .map_or(*size, |(before, _)| (before * *size).sqrt());
        }
        sizes = next;
    }
    refit(setting, problem, model, critical, &mut sizes);
    sizes
}

/// From which sizes on the forms of an effect show.
enum Shown {
    /// From these on; at least one.
    From(Vec<DetectionLimit>),
    /// Not at any possible size.
    Not(WhyNot),
    /// It is in the model, or its columns are missing.
    NotAsked,
}

/// The smallest size of each form of an effect that is found, at the shape at which it shows most.
fn of_effect(effect: usize, problem: &ForceProblem, model: &Fitted, sizes: &Sizes) -> Shown {
    let of = |term: &Term| matches!(term.what, What::Effect { effect: k, .. } if k == effect);
    let mine = sizes.iter().filter(|(t, _)| of(&problem.library[**t]));
    let mine: Vec<_> = mine.collect();
    if mine.is_empty() {
        let asked = problem.library.iter().any(of);
        let mut in_model = model.point.terms.iter().map(|(t, _)| *t);
        return if asked && !in_model.any(|t| of(&problem.library[t])) {
            Shown::Not(WhyNot::Absorbed)
        } else {
            Shown::NotAsked
        };
    }
    let mut smallest: Vec<DetectionLimit> = Vec::new();
    for (t, (size, share)) in mine {
        let term = &problem.library[*t];
        let Some(form) = term.form() else { continue };
        if *size > largest(problem, *t) {
            continue;
        }
        let limit = DetectionLimit {
            id: effects::all()[effect].id().to_owned(),
            form: form.name.to_owned(),
            smallest: *size,
            unit: form.amplitude.unit.to_owned(),
            identifiable_share: *share,
        };
        match smallest.iter_mut().find(|l| l.form == form.name) {
            Some(known) if known.smallest > *size => *known = limit,
            Some(_) => {}
            None => smallest.push(limit),
        }
    }
    if smallest.is_empty() {
        Shown::Not(WhyNot::Bound)
    } else {
        Shown::From(smallest)
    }
}

/// The smallest size of every term that is found, by that of its directions in which it shows most, and the share that the fixed effects leave of
/// it.
fn sizes(screen: &Screen, power: &Power, problem: &ForceProblem, critical: f64) -> Sizes {
    let mut sizes = Sizes::new();
    for s in screen.shown(0) {
        let direction = &screen.directions[s.direction];
        let ratio = ratio_of(problem, direction.term, critical);
        let size = power.smallest(&direction.columns[0], s.length, ratio);
        let known = sizes
            .entry(direction.term)
            .or_insert((f64::INFINITY, s.share));
        if size < known.0 {
            *known = (size, s.share);
        }
    }
    sizes
}

/// The sizes anew, by fits of the model without the term to readings that hold it: of those that the other coefficients take up in part.
fn refit(
    setting: &Setting,
    problem: &ForceProblem,
    model: &Fitted,
    critical: f64,
    sizes: &mut Sizes,
) {
    let again = |t: usize, first: f64| {
        let wanted = wanted(ratio_of(problem, t, critical));
        let mut size = first;
        for _ in 0..REFITS {
            let within = size.min(largest(problem, t));
            let signs = [within, -within]
                .into_iter()
                .filter(|s| is_possible(problem, t, *s));
            let values: Vec<Vec<f64>> = signs.map(|s| problem.library[t].of_size(s)).collect();
            let shown = strength(setting, model, t, &values);
            let factor = (wanted / shown).clamp(0.25, 4.0).sqrt();
            size = within * factor;
            if (factor - 1.0).abs() < REFOUND {
                break;
            }
        }
        size
    };
    let taken_up: Vec<usize> = sizes
        .iter()
        .filter(|(_, (size, share))| *share < TAKEN_UP && size.is_finite())
        .map(|(t, _)| *t)
        .collect();
    let anew: Vec<(usize, f64)> = taken_up
        .into_par_iter()
        .map(|t| (t, again(t, sizes[&t].0)))
        .collect();
    for (t, size) in anew {
        if let Some(known) = sizes.get_mut(&t) {
            known.0 = size;
        }
    }
}

/// Whether a term can have a size of this sign.
fn is_possible(problem: &ForceProblem, t: usize, size: f64) -> bool {
    let bounds = problem.terms()[t].bounds[0];
    size > bounds.0 || size > 0.0
}

/// The largest size that a term can have.
fn largest(problem: &ForceProblem, t: usize) -> f64 {
    let bounds = problem.terms()[t].bounds[0];
    bounds.0.abs().max(bounds.1.abs())
}

/// The likelihood ratio from which a term is accepted.
fn ratio_of(problem: &ForceProblem, t: usize, critical: f64) -> f64 {
    likelihood_ratio(critical, problem.terms()[t].amplitudes)
}

/// The terms without a name of which the model has none of the same column.
fn columns_beside(problem: &ForceProblem, model: &Fitted) -> impl Iterator<Item = usize> {
    let terms = problem.terms();
    let in_model = |kind: usize| {
        model
            .point
            .terms
            .iter()
            .any(|(u, _)| terms[*u].kind == kind)
    };
    let is_beside = move |t: &usize| match problem.library[*t].what {
        What::Column(_) => !terms[*t].decoy && !in_model(terms[*t].kind),
        What::Effect { .. } => false,
    };
    (0..terms.len()).filter(is_beside)
}

/// From which change over its range on a straight dependence on a column shows.
fn of_columns(problem: &ForceProblem, model: &Fitted, sizes: &Sizes) -> Vec<ColumnLimit> {
    let limit = |t: usize| {
        let What::Column(column) = problem.library[t].what else {
            return None;
        };
        let unit_slope = column.curve(problem.data, [1.0, 0.0]);
        let range = unit_slope.last()?.1 - unit_slope.first()?.1;
        let shown = sizes.get(&t);
        let shown = shown.filter(|(size, _)| *size <= largest(problem, t));
        let (shape, unit) = if column.is_gain() {
            ("gain", "1")
        } else {
            ("offset", "N")
        };
        Some(ColumnLimit {
            column: column.name(problem.data),
            shape: shape.to_owned(),
            smallest: shown.map(|(size, _)| size * range),
            unit: unit.to_owned(),
        })
    };
    columns_beside(problem, model).filter_map(limit).collect()
}

/// What absorbs an effect: the coefficient or effect whose whitened sensitivity is nearly its own; none where it takes several of them.
fn absorbing(
    problem: &ForceProblem,
    model: &Fitted,
    screen: &Screen,
    effect: usize,
) -> Option<String> {
    let is_its =
        |t: usize| matches!(problem.library[t].what, What::Effect { effect: k, .. } if k == effect);
    let mut directions = screen.directions.iter();
    let direction = directions.find(|d| is_its(d.term))?;
    let own = &direction.columns[0];
    let fixed = &model.design.x;
    let with_own = |x: &Vec<f64>| x.iter().zip(own).map(|(x, d)| x + d).collect();
    let mut columns = vec![own.clone()];
    columns.extend(fixed.iter().cloned());
    columns.extend(fixed.iter().map(with_own));
    let panel = Panel::new(&model.design, &model.gram, &columns);
    let factor = Factor::new(&model.design.tree, &model.gram, &model.variances);
    let squares = factor.project(&panel).unprojected;
    let cosine = |k: usize| {
        let product = 0.5 * (squares[1 + fixed.len() + k] - squares[0] - squares[1 + k]);
        (product / (squares[0] * squares[1 + k]).sqrt()).abs()
    };
    let places = (0..fixed.len()).map(|k| (k, cosine(k)));
    let (k, _) = places
        .filter(|(_, cosine)| *cosine >= PARALLEL)
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    match model.free[k] {
        Free::Coefficient(c) => Some(problem.base.coefficients[c].name.clone()),
        Free::Value(t, _) => problem.library[model.point.terms[t].0]
            .id()
            .map(str::to_owned),
    }
}

/// Effects that lack a quantity, and the one that a fitted law has itself.
fn missing(problem: &ForceProblem) -> Vec<NotMeasurable> {
    let data: &Data = problem.data;
    let of_law = || Some(problem.base.coefficients[LENGTH_LAW].name.clone());
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
        // A dependence that was left out is in no model.
        .filter(|(_, need)| *need != Need::LengthLaw || problem.base.fits_length_law())
        .map(|(id, need)| {
            let is_of_base = need == Need::LengthLaw;
            NotMeasurable {
                id: id.to_owned(),
                reason: if is_of_base {
                    WhyNot::Absorbed
                } else {
                    WhyNot::NoColumn
                },
                by: if is_of_base {
                    of_law()
                } else {
                    Some(need.id().to_owned())
                },
                form: None,
            }
        })
        .collect()
}

/// Pairs of effects, each by its most identifiable form, whose whitened sensitivities are nearly parallel.
fn aliases(problem: &ForceProblem, model: &Fitted, screen: &Screen) -> Vec<Alias> {
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
    let panel = Panel::new(&model.design, &model.gram, &columns);
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
        .filter(|a| a.cosine.abs() >= PARALLEL)
        .collect();
    aliases.sort_by(|a, b| b.cosine.abs().total_cmp(&a.cosine.abs()));
    aliases
}

fn scaled(column: &[f64], factor: f64) -> Vec<f64> {
    column.iter().map(|x| x * factor).collect()
}
