//! What is kept of the best set: every term has to be significant beyond the choice among candidates, to help on readings that took no part,
//! and to be chosen again without any one unit.

use super::refit::{Reading, Sizes};
use super::search::{Known, Ranked, ranked};
use super::terms::{ALL, place};
use super::traces::{ALIKE, Traces};
use crate::numerics::distributions::student_t_two_sided;
use crate::numerics::jackknife::{FEWEST_GROUPS, half_width, standard_error};
use crate::numerics::statistics::sum_of_squares;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Largest corrected probability.
const SIGNIFICANT: f64 = 0.05;
/// Sets of each number of terms that are looked at, best first.
const LOOKED_AT: usize = 8;

/// The readings of a joint, and what may be chosen.
#[derive(Clone, Copy)]
pub struct Task<'r, 'a> {
    /// Readings.
    pub readings: &'r [Reading<'a>],
    /// Terms.
    pub candidates: &'r [usize],
    /// Most terms of a set.
    pub most: usize,
    /// Confidence of intervals.
    pub confidence: f64,
}

/// A term that was judged.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Its place.
    pub term: usize,
    /// Half the width of its interval; none with too few units.
    pub half_width: Option<f64>,
    /// Probability, times the number of effects that were asked for.
    pub p_adjusted: f64,
    /// Part of the searches without one unit that choose its effect, or one that leaves its trace.
    pub chosen_again: f64,
    /// Part of the folds in which it helps.
    pub helps: f64,
    /// Held-out sums of squares without it and with it, (N.m)^2.
    pub held_out: (f64, f64),
}

impl Judged {
    fn passes(&self) -> bool {
        self.term != place::PLACEBO
            && self.p_adjusted < SIGNIFICANT
            && self.helps >= 0.5
            && self.held_out.1 < self.held_out.0
    }
}

/// An accepted set.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The fit.
    pub sizes: Sizes,
    /// Its terms.
    pub judged: Vec<Judged>,
}

impl<'r, 'a> Task<'r, 'a> {
    /// The best set of which every term stands; the rigid leg if there is none. `again` are the sets that were chosen without one unit
    /// each; an effect has to be in all of them but one, or nine in ten.
    pub fn accepted(&self, sets: &[Ranked], again: &[Vec<usize>]) -> Accepted {
        let rigid = Accepted {
            sizes: Sizes::rigid(self.readings),
            judged: Vec::new(),
        };
        let allowed = (0.1 * again.len() as f64).max(1.0);
        let mut looked_at = [0; 3];
        for set in sets {
            let terms = set.sizes.terms.len();
            if terms == 0 {
                break;
            }
            looked_at[terms] += 1;
            if looked_at[terms] > LOOKED_AT {
                continue;
            }
            let judged = self.judged(&set.sizes, again);
            let stable = |j: &Judged| (1.0 - j.chosen_again) * again.len() as f64 <= allowed + 1e-9;
            if judged.iter().all(|j| j.passes() && stable(j)) {
                let sizes = set.sizes.clone();
                return Accepted { sizes, judged };
            }
        }
        rigid
    }

    /// The sets that are chosen without one unit each.
    pub fn again(&self, known: &Known) -> Vec<Vec<usize>> {
        let units: BTreeSet<usize> = self.readings.iter().map(|r| r.unit).collect();
        let units: Vec<usize> = units.into_iter().collect();
        let without = |unit: &usize| {
            let rest = self.keeping(|r| r.unit != *unit);
            let sets = ranked(&rest, self.candidates, self.most, known);
            sets.first().map_or(Vec::new(), |s| s.sizes.terms.clone())
        };
        units.par_iter().map(without).collect()
    }

    fn keeping(&self, keep: impl Fn(&Reading) -> bool) -> Vec<Reading<'a>> {
        self.readings.iter().filter(|r| keep(r)).copied().collect()
    }

    /// The fits without one unit each.
    pub fn refits(&self, sizes: &Sizes) -> Vec<Sizes> {
        let units: BTreeSet<usize> = self.readings.iter().map(|r| r.unit).collect();
        let without = |unit: usize| {
            let rest = self.keeping(|r| r.unit != unit);
            Sizes::of(&sizes.terms, &rest, Some(sizes))
        };
        units.into_iter().map(without).collect()
    }

    /// Held-out sum of squares of a set by fold: the actuator, or the unit where there is one actuator.
    pub fn held_out(&self, terms: &[usize], from: &Sizes) -> Vec<f64> {
        let fold = fold_of(self.readings);
        let folds: BTreeSet<usize> = self.readings.iter().map(fold).collect();
        let left = |one: usize| {
            let rest = self.keeping(|r| fold(r) != one);
            let own = self.keeping(|r| fold(r) == one);
            let sizes = Sizes::of(terms, &rest, Some(from));
            sum_of_squares(&sizes.residuals(&own))
        };
        folds.into_iter().map(left).collect()
    }

    /// The judgement of every term of a set.
    pub fn judged(&self, sizes: &Sizes, again: &[Vec<usize>]) -> Vec<Judged> {
        let refits = self.refits(sizes);
        let with = self.held_out(&sizes.terms, sizes);
        let traces = Traces::new(self.readings, sizes);
        // Forms of one effect are one question.
        let ids: BTreeSet<&str> = self.candidates.iter().map(|t| ALL[*t].id).collect();
        let questions = ids.len() as f64;
        let one = |t: &usize| {
            let values: Vec<f64> = refits.iter().map(|s| s.values[*t]).collect();
            let value = sizes.values[*t];
            let enough = values.len() >= FEWEST_GROUPS;
            let p = if enough {
                let ratio = value / standard_error(value, &values);
                student_t_two_sided(ratio, values.len() as f64 - 1.0)
            } else {
                1.0
            };
            let others: Vec<usize> = sizes.terms.iter().filter(|o| *o != t).copied().collect();
            let without = self.held_out(&others, sizes);
            let better = with.iter().zip(&without).filter(|(w, o)| w < o).count();
            let alike = |o: &usize| ALL[*o].id == ALL[*t].id || traces.cosine(*t, *o).abs() > ALIKE;
            let same = |set: &&Vec<usize>| set.iter().any(alike);
            let times = again.iter().filter(same).count();
            Judged {
                term: *t,
                half_width: half_width(value, &values, self.confidence),
                p_adjusted: (p * questions).min(1.0),
                chosen_again: if again.is_empty() {
                    1.0
                } else {
                    times as f64 / again.len() as f64
                },
                helps: better as f64 / with.len() as f64,
                held_out: (without.iter().sum(), with.iter().sum()),
            }
        };
        sizes.terms.iter().map(one).collect()
    }
}

/// To which fold a reading belongs: its actuator, or its unit where all are of one actuator.
pub fn fold_of(readings: &[Reading]) -> fn(&Reading) -> usize {
    let first = readings.first().map(|r| r.actuator);
    if readings.iter().all(|r| Some(r.actuator) == first) {
        |r| r.unit
    } else {
        |r| r.actuator
    }
}
