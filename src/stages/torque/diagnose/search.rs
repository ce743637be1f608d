//! Which set of terms a part of the readings asks for: every set of one or two. No set of three did better on actuators that were held out.
//!
//! Sets are ranked by BIC with the effective number of readings: those of one unit share how the actuator was mounted, which leaves about
//! n / (1 + (m - 1) rho) independent ones, with m readings a unit and rho the share of the variance between units in what the best set leaves.

use super::refit::{Reading, Sizes};
use crate::numerics::statistics::{mean, sum_of_squares};
use std::collections::BTreeMap;

/// A set of terms with its criterion, smaller is better.
#[derive(Clone, Debug)]
pub struct Ranked {
    /// The fit.
    pub sizes: Sizes,
    /// BIC.
    pub criterion: f64,
}

/// Fits of sets of terms to all readings, from which those to parts of them start.
pub type Known = BTreeMap<Vec<usize>, Sizes>;

/// Every set of up to `most` terms (1 or 2), best first; the rigid leg is among them.
pub fn ranked(
    readings: &[Reading],
    candidates: &[usize],
    most: usize,
    known: &Known,
) -> Vec<Ranked> {
    let fit = |terms: Vec<usize>| Sizes::of(&terms, readings, known.get(&terms));
    let mut all = vec![fit(Vec::new())];
    all.extend(candidates.iter().map(|t| fit(vec![*t])));
    let pairs = candidates.iter().enumerate().flat_map(|(k, a)| {
        let others = candidates[k + 1..].iter();
        others.map(move |b| vec![*a, *b])
    });
    if most > 1 {
        all.extend(pairs.map(fit));
    }
    all.retain(|s| s.inside && s.sse.is_finite());
    let best = all.iter().min_by(|a, b| a.sse.total_cmp(&b.sse));
    let left = best.map_or(Vec::new(), |s| s.residuals(readings));
    let effective = effective(readings, &left);
    let n = readings.len() as f64;
    let criterion =
        |s: &Sizes| effective * libm::log(s.sse / n) + s.terms.len() as f64 * libm::log(effective);
    let mut ranked: Vec<Ranked> = all
        .into_iter()
        .map(|sizes| Ranked {
            criterion: criterion(&sizes),
            sizes,
        })
        .collect();
    ranked.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    ranked
}

/// Effective number of readings, given what a fit leaves of them.
pub fn effective(readings: &[Reading], residuals: &[f64]) -> f64 {
    let mut of_unit: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (r, residual) in readings.iter().zip(residuals) {
        of_unit.entry(r.unit).or_default().push(*residual);
    }
    let (n, units) = (readings.len() as f64, of_unit.len() as f64);
    if units < 2.0 || n <= units {
        return n;
    }
    let per_unit = n / units;
    let total = sum_of_squares(residuals);
    let means = of_unit.values().map(|r| r.len() as f64 * mean(r) * mean(r));
    let between: f64 = means.sum();
    // Analysis of variance about zero: what a fit leaves has no mean worth the name.
    let within = (total - between) / (n - units);
    let excess = ((between / units - within) / per_unit).max(0.0);
    let share = if total > 0.0 {
        excess / (excess + within)
    } else {
        0.0
    };
    (n / (1.0 + (per_unit - 1.0) * share)).max(units)
}
