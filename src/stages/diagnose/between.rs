//! What acts alike on all readings of a specimen: found in the strengths of the specimens, one number each.
//!
//! A dependence of the force on the resting length that the base model lacks is taken up by the strengths, so no sum over readings shows
//! it; and counting readings would be wrong, because there are as many facts as specimens. The strengths are regressed on the
//! trace of each such effect, and Student's t has K - 2 degrees of freedom. A gain of all readings is a mean of the strengths that is not that
//! of the base model: nothing but the strengths shows it where no coefficient of the base is fitted, and t has K - 1 degrees.

use super::base::Base;
use super::data::{Data, PLACEBO};
use super::model::Fitted;
use super::search::Search;
use super::term::{Scope, Term, What};
use crate::base::columns::TEMPERATURE;
use crate::effects::{self, Applied, Need};
use crate::numerics::distributions::student_t_two_sided;

/// The effect that is a gain of all readings.
const COMMON_GAIN: &str = "force_gain";
/// Fewest specimens of such a regression.
const FEWEST: usize = 4;

/// Whether an effect acts alike on all readings of a specimen.
pub fn is_between(base: &Base, term: &Term) -> bool {
    is_common_gain(base, term)
        || term
            .form()
            .is_some_and(|f| f.needs.contains(&Need::RestLengths))
}

/// Whether a term is one gain of all readings, beside a base of which nothing is fitted.
pub fn is_common_gain(base: &Base, term: &Term) -> bool {
    let fitted = base.coefficients.iter().any(|c| c.free);
    !fitted && term.scope == Scope::Whole && term.id() == Some(COMMON_GAIN)
}

/// The strengths on a trace: slope, its p, and the share of the strengths' variance that it explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regression {
    /// Amplitude.
    pub slope: f64,
    /// Probability by chance.
    pub p: f64,
    /// Share of the variance.
    pub share: f64,
}

/// The regression of the specimens' strengths on the trace of a candidate, each specimen with a weight.
pub fn regression(
    search: &Search,
    fitted: &Fitted,
    candidate: usize,
    weights: &[f64],
) -> Option<Regression> {
    let points = points(search, fitted, candidate, weights);
    if is_common_gain(search.base, &search.candidates[candidate]) {
        through_the_origin(&points)
    } else {
        straight_line(&points)
    }
}

/// Trace, strength and weight of each specimen that has a weight.
fn points(
    search: &Search,
    fitted: &Fitted,
    candidate: usize,
    weights: &[f64],
) -> Vec<(f64, f64, f64)> {
    let term = &search.candidates[candidate];
    let What::Effect {
        effect,
        form,
        shape,
    } = term.what
    else {
        return Vec::new();
    };
    let data = search.data;
    let mut at = vec![None; data.specimens.len()];
    for i in 0..data.len() {
        at[data.specimen[i]] = Some(data.conditions[i]);
    }
    at.iter()
        .enumerate()
        .filter_map(|(k, c)| Some((k, (*c)?)))
        .filter(|(k, _)| weights[*k] > 0.0)
        .map(|(k, c)| {
            let applied = Applied {
                effect,
                form,
                parameters: [1.0, shape],
            };
            let lever = if is_common_gain(search.base, term) {
                1.0
            } else {
                effects::scale(&applied, &c) - 1.0
            };
            (lever, fitted.strengths[k], weights[k])
        })
        .collect()
}

fn straight_line(points: &[(f64, f64, f64)]) -> Option<Regression> {
    let n = points.len() as f64;
    if points.len() < FEWEST - 1 {
        return None;
    }
    let total: f64 = points.iter().map(|p| p.2).sum();
    let mean = |f: &dyn Fn(&(f64, f64, f64)) -> f64| {
        points.iter().map(|p| p.2 * f(p)).sum::<f64>() / total
    };
    let (x0, y0) = (mean(&|p| p.0), mean(&|p| p.1));
    let xx = mean(&|p| (p.0 - x0) * (p.0 - x0));
    let xy = mean(&|p| (p.0 - x0) * (p.1 - y0));
    let yy = mean(&|p| (p.1 - y0) * (p.1 - y0));
    if xx <= 0.0 || yy <= 0.0 {
        return None;
    }
    let share = xy * xy / (xx * yy);
    let t = (share * (n - 2.0) / (1.0 - share).max(1e-12)).sqrt();
    Some(Regression {
        slope: xy / xx,
        p: student_t_two_sided(t, n - 2.0),
        share,
    })
}

/// The strengths as a multiple of the trace: what a gain of all readings does.
fn through_the_origin(points: &[(f64, f64, f64)]) -> Option<Regression> {
    let n = points.len() as f64;
    if points.len() < FEWEST - 1 {
        return None;
    }
    let sum = |f: &dyn Fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| p.2 * f(p)).sum::<f64>();
    let (xx, xy) = (sum(&|p| p.0 * p.0), sum(&|p| p.0 * p.1));
    let yy = sum(&|p| p.1 * p.1);
    if xx <= 0.0 || yy <= 0.0 {
        return None;
    }
    let share = xy * xy / (xx * yy);
    let t = (share * (n - 1.0) / (1.0 - share).max(1e-12)).sqrt();
    Some(Regression {
        slope: xy / xx,
        p: student_t_two_sided(t, n - 1.0),
        share,
    })
}

/// In which part of the specimens the strength is nearer to what the others' regression says of it than to the others' mean.
pub fn helps(search: &Search, fitted: &Fitted, candidate: usize) -> f64 {
    let points = points(
        search,
        fitted,
        candidate,
        &vec![1.0; search.data.specimens.len()],
    );
    let nearer = (0..points.len()).filter(|k| {
        let others: Vec<(f64, f64, f64)> = points
            .iter()
            .enumerate()
            .filter(|(j, _)| j != k)
            .map(|(_, p)| *p)
            .collect();
        let (x, y, _) = points[*k];
        if is_common_gain(search.base, &search.candidates[candidate]) {
            return through_the_origin(&others).is_some_and(|r| (y - r.slope * x).abs() < y.abs());
        }
        let mean = |f: fn(&(f64, f64, f64)) -> f64| {
            others.iter().map(f).sum::<f64>() / others.len().max(1) as f64
        };
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        straight_line(&others).is_some_and(|r| (y - y0 - r.slope * (x - x0)).abs() < (y - y0).abs())
    });
    nearer.count() as f64 / points.len().max(1) as f64
}

/// The candidates of this kind, and how many ids they have.
fn candidates(search: &Search) -> (Vec<usize>, f64) {
    let list: Vec<usize> = (0..search.candidates.len())
        .filter(|c| {
            search.candidates[*c].scope == Scope::Whole
                && is_between(search.base, &search.candidates[*c])
        })
        .collect();
    (list.clone(), list.len() as f64)
}

/// The candidate that the strengths ask for, with its p after correction; none where the base has a law of length of its own that is
/// fitted.
pub fn asked_for(search: &Search, fitted: &Fitted) -> Option<(usize, f64)> {
    if search.base.without_length_law().is_some() {
        return None;
    }
    let (list, many) = candidates(search);
    let seen: std::collections::BTreeSet<usize> = search.data.specimen.iter().copied().collect();
    if seen.len() < FEWEST {
        return None;
    }
    let weights = vec![1.0; search.data.specimens.len()];
    list.into_iter()
        .filter_map(|c| Some((c, regression(search, fitted, c, &weights)?)))
        .min_by(|a, b| a.1.p.total_cmp(&b.1.p))
        .map(|(c, r)| (c, (r.p * many).min(1.0)))
}

/// A column that has one value for each specimen, and what the strengths say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// The strengths on it.
    pub regression: Regression,
    /// Its p, times the number of such columns.
    pub p_adjusted: f64,
    /// Sum of the squared strengths that the line through them leaves.
    pub left: f64,
    /// The line: value of the column, strength.
    pub line: [(f64, f64); 2],
}

/// The extra columns (and the temperature) that have one value for each specimen, by their p: what the strengths of the specimens
/// cannot be told from.
pub fn columns(data: &Data, strengths: &[f64]) -> Vec<Column> {
    let temperatures: Vec<f64> = data.conditions.iter().map(|c| c.temperature_c).collect();
    let extras = data.extras.iter().filter(|e| e.name != PLACEBO).map(|e| {
        let raw = e.values.iter().map(|x| e.scale.0 + e.scale.1 * x);
        (e.name.clone(), raw.collect())
    });
    let all = std::iter::once((TEMPERATURE.to_owned(), temperatures)).chain(extras);
    let mut list: Vec<Column> = all
        .filter_map(|(name, values)| column(data, strengths, name, &values))
        .collect();
    let many = list.len() as f64;
    for column in &mut list {
        column.p_adjusted = (column.regression.p * many).min(1.0);
    }
    list.sort_by(|a, b| {
        a.p_adjusted
            .total_cmp(&b.p_adjusted)
            .then(a.name.cmp(&b.name))
    });
    list
}

fn column(data: &Data, strengths: &[f64], name: String, values: &[f64]) -> Option<Column> {
    let mut of: Vec<Option<f64>> = vec![None; data.specimens.len()];
    for (x, k) in values.iter().zip(&data.specimen) {
        if *of[*k].get_or_insert(*x) != *x {
            return None;
        }
    }
    let points: Vec<(f64, f64, f64)> = of
        .iter()
        .zip(strengths)
        .filter_map(|(x, u)| Some(((*x)?, *u, 1.0)))
        .collect();
    let regression = straight_line(&points)?;
    let n = points.len() as f64;
    let (x0, y0) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let at = |x: f64| y0 + regression.slope * (x - x0);
    let ends = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
            (l.min(p.0), h.max(p.0))
        });
    Some(Column {
        name,
        regression,
        p_adjusted: 1.0,
        left: points
            .iter()
            .map(|p| (p.1 - at(p.0)) * (p.1 - at(p.0)))
            .sum(),
        line: [(ends.0, at(ends.0)), (ends.1, at(ends.1))],
    })
}

/// In which part of the resamples, each a weight a specimen, the slope has its sign and explains most of the variance.
pub fn chosen_again(
    search: &Search,
    fitted: &Fitted,
    candidate: usize,
    resamples: &[Vec<f64>],
) -> f64 {
    let whole = regression(
        search,
        fitted,
        candidate,
        &vec![1.0; search.data.specimens.len()],
    );
    let Some(whole) = whole else {
        return 0.0;
    };
    let usable: Vec<Regression> = resamples
        .iter()
        .filter_map(|w| regression(search, fitted, candidate, w))
        .collect();
    let again = usable
        .iter()
        .filter(|r| r.slope * whole.slope > 0.0 && r.share > 0.5)
        .count();
    if usable.is_empty() {
        0.0
    } else {
        again as f64 / usable.len() as f64
    }
}
