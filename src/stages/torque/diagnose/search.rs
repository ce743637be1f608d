//! Which set of terms a part of the readings asks for: every set of one or two, and the best of them with a third.
//!
//! Sets are ranked by BIC with the effective number of readings: those of one stretch share what the law of force lacks there, which leaves about
//! n / (1 + (m - 1) rho) independent ones, with m readings a stretch and rho the share of the variance between stretches in what the best set
//! leaves after tests and actuators have been given what is their own ([`super::nuisance`]).

use super::nuisance::{FINEST_NM, Nuisance, Spreads};
use super::refit::{Reading, Sizes};
use crate::numerics::statistics::{mean, sum_of_squares};
use rayon::prelude::*;
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

/// Readings, and by how much tests and actuators differ: all that a fit needs.
#[derive(Clone, Copy)]
pub struct Sample<'r, 'a> {
    /// Readings, with what is their own.
    pub readings: &'r [Reading<'a>],
    /// Spreads.
    pub spreads: &'r Spreads,
}

impl Sample<'_, '_> {
    /// Every set of up to `most` terms (1 or 2), best first; the rigid leg is among them.
    pub fn ranked(&self, candidates: &[usize], most: usize, known: &Known) -> Vec<Ranked> {
        let mut sets = vec![Vec::new()];
        sets.extend(candidates.iter().map(|t| vec![*t]));
        let pairs = candidates.iter().enumerate().flat_map(|(k, a)| {
            let others = candidates[k + 1..].iter();
            others.map(move |b| vec![*a, *b])
        });
        if most > 1 {
            sets.extend(pairs);
        }
        self.of(&sets, known)
    }

    /// A set with each candidate that it does not have, best first.
    pub fn extended(&self, terms: &[usize], candidates: &[usize], known: &Known) -> Vec<Ranked> {
        let others = candidates.iter().filter(|t| !terms.contains(t));
        let mut sets: Vec<Vec<usize>> = others.map(|t| [terms, &[*t]].concat()).collect();
        sets.iter_mut().for_each(|s| s.sort_unstable());
        sets.push(terms.to_vec());
        self.of(&sets, known)
    }

    /// Some sets, best first.
    pub fn of(&self, sets: &[Vec<usize>], known: &Known) -> Vec<Ranked> {
        let fit =
            |terms: &Vec<usize>| Sizes::of(terms, self.readings, self.spreads, known.get(terms));
        let mut all: Vec<Sizes> = sets.par_iter().map(fit).collect();
        all.retain(|s| s.inside && s.left.is_finite());
        let best = all.iter().min_by(|a, b| a.left.total_cmp(&b.left));
        let effective = best.map_or(f64::NAN, |s| self.effective(s));
        let n = self.readings.len() as f64;
        let criterion = |s: &Sizes| {
            let left = (s.left / n).max(FINEST_NM * FINEST_NM);
            effective * libm::log(left) + s.terms.len() as f64 * libm::log(effective)
        };
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

    /// What a fit leaves of the readings after tests and actuators have been given what is their own, N.m.
    pub fn conditional(&self, sizes: &Sizes) -> Vec<f64> {
        let residuals = sizes.residuals(self.readings);
        let mut left = Nuisance::of(self.readings, self.spreads).left(&residuals);
        left.truncate(residuals.len());
        left
    }

    /// Effective number of readings, given a fit.
    pub fn effective(&self, sizes: &Sizes) -> f64 {
        let residuals = self.conditional(sizes);
        let mut of_unit: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for (r, residual) in self.readings.iter().zip(&residuals) {
            of_unit.entry(r.unit).or_default().push(*residual);
        }
        let (n, units) = (residuals.len() as f64, of_unit.len() as f64);
        if units < 2.0 || n <= units {
            return n;
        }
        let per_unit = n / units;
        let total = sum_of_squares(&residuals);
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
}
