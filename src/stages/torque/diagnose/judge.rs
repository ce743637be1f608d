//! What is kept of the best set: every term has to be significant beyond the choice among candidates, to help on readings that took no part,
//! and to be chosen again without any one test.

use super::nuisance::Spreads;
use super::refit::{Reading, Sizes};
use super::search::{Known, Ranked, Sample};
use super::terms::{ALL, MOST, place};
use super::traces::Traces;
use crate::numerics::distributions::{student_t_quantile, student_t_two_sided};
use crate::numerics::jackknife::{FEWEST_GROUPS, standard_error};
use crate::numerics::statistics::sum_of_squares;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Largest corrected probability.
const SIGNIFICANT: f64 = 0.05;
/// Sets of each number of terms that are looked at, best first.
const LOOKED_AT: usize = 8;
/// An actuator that gives less than this part of a zero of the torque hardly pulls.
const HARDLY: f64 = 0.25;
/// Fewest readings of an actuator with hardly any pull that say something of the zero of the torque.
const FEWEST_SLACK: usize = 3;
/// Fewest tests that are left out one by one; with fewer, stretches of the angle are.
const FEWEST_TESTS: usize = 3;

/// Fewest tests whose jackknife says how unsure a size is; with fewer it says hardly anything, and the spread between tests has to do.
const FEWEST_TESTS_FOR_AN_ERROR: usize = 5;

/// The readings of a joint, and what may be chosen.
#[derive(Clone, Copy)]
pub struct Task<'r, 'a> {
    /// Readings.
    pub readings: &'r [Reading<'a>],
    /// By how much tests and actuators differ.
    pub spreads: &'r Spreads,
    /// Terms.
    pub candidates: &'r [usize],
    /// Most terms of a set that is found at once.
    pub most: usize,
    /// Confidence of intervals.
    pub confidence: f64,
}

/// A term that was judged.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Its place.
    pub term: usize,
    /// Half the width of its interval.
    pub half_width: f64,
    /// Probability, times the number of effects that were asked for.
    pub p_adjusted: f64,
}

/// What a term does on what took no part.
#[derive(Clone, Copy, Debug)]
struct Help {
    /// Part of the folds in which it helps.
    folds: f64,
    /// Held-out sums of squares without it and with it, (N.m)^2.
    held_out: (f64, f64),
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
    /// Its readings with their spreads.
    pub fn sample(&self) -> Sample<'r, 'a> {
        Sample {
            readings: self.readings,
            spreads: self.spreads,
        }
    }

    /// The best set of which every term stands, with a third where that stands as well; the rigid leg if there is none. `again` are the sets
    /// that were chosen without one unit each; an effect has to be in all of them but one, or nine in ten.
    pub fn accepted(&self, sets: &[Ranked], again: &[Vec<usize>], known: &Known) -> Accepted {
        let Some((sizes, judged)) = self.first_that_stands(sets, 0, again) else {
            return Accepted {
                sizes: Sizes::rigid(self.readings, self.spreads),
                judged: Vec::new(),
            };
        };
        let terms = sizes.terms.clone();
        let mut taken = (sizes, judged);
        if terms.len() == self.most && terms.len() < MOST {
            let extended = |sample: &Sample| sample.extended(&terms, self.candidates, known);
            let again = self.again(extended);
            let larger = extended(&self.sample());
            let found = self.first_that_stands(&larger, terms.len(), &again);
            taken = found.unwrap_or(taken);
        }
        Accepted {
            sizes: taken.0,
            judged: taken.1,
        }
    }

    /// The first set that stands, of those with more than `fewer` terms that come before the one with so many.
    fn first_that_stands(
        &self,
        sets: &[Ranked],
        fewer: usize,
        again: &[Vec<usize>],
    ) -> Option<(Sizes, Vec<Judged>)> {
        let best_alone = self.best_alone(sets);
        let mut looked_at = [0; MOST + 1];
        for set in sets {
            let terms = set.sizes.terms.len();
            if terms == fewer {
                break;
            }
            looked_at[terms] += 1;
            if looked_at[terms] > LOOKED_AT {
                continue;
            }
            if let Some(judged) = self.stands(&set.sizes, again, &best_alone) {
                return Some((set.sizes.clone(), judged));
            }
        }
        None
    }

    /// The term that by itself predicts best what took no part, and its held-out sum of squares, (N.m)^2.
    fn best_alone(&self, sets: &[Ranked]) -> Option<(usize, f64)> {
        let alone = sets.iter().filter(|s| s.sizes.terms.len() == 1);
        let held_out = |s: &Ranked| {
            let left: f64 = self.held_out(&s.sizes.terms, &s.sizes).iter().sum();
            (s.sizes.terms[0], left)
        };
        alone.map(held_out).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The judgement of a set, none where one of its terms does not stand; the guards that cost least come first.
    fn stands(
        &self,
        sizes: &Sizes,
        again: &[Vec<usize>],
        best_alone: &Option<(usize, f64)>,
    ) -> Option<Vec<Judged>> {
        let traces = Traces::new(&self.sample(), sizes);
        let beyond_chance = |t: &usize| {
            let p = self.p_adjusted(sizes.values[*t], traces.error(*t), &traces, *t);
            *t != place::PLACEBO && p < SIGNIFICANT
        };
        if !sizes.terms.iter().all(beyond_chance) || self.is_contradicted_at_slack(sizes) {
            return None;
        }
        let allowed = (0.1 * again.len() as f64).max(1.0) + 1e-9;
        let chosen = |t: &usize| again.len() as f64 - chosen_again(*t, &traces, again) <= allowed;
        if !sizes.terms.iter().all(chosen) {
            return None;
        }
        let helps = self.helps(sizes);
        if let Some((single, held_out)) = best_alone {
            let own = helps.first().map_or(f64::NAN, |h| h.held_out.1);
            let has_others = sizes.terms.iter().any(|t| t != single);
            if has_others && sizes.terms.len() > 1 && own >= *held_out {
                return None;
            }
        }
        let useless = |h: &Help| h.held_out.1 >= h.held_out.0 || h.folds < 0.5;
        if helps.iter().any(useless) {
            return None;
        }
        let judged = self.judged(sizes);
        let all_beyond_chance = judged.iter().all(|j| j.p_adjusted < SIGNIFICANT);
        all_beyond_chance.then_some(judged)
    }

    /// Whether a zero of the torque makes the readings of any actuator worse at which it hardly pulls, and which show it most plainly: the zero
    /// is the load cell's, and the same for all.
    fn is_contradicted_at_slack(&self, sizes: &Sizes) -> bool {
        let zero = sizes.values[place::ZERO];
        let left = sizes.residuals(self.readings);
        let mut slack: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for (r, left) in self.readings.iter().zip(left) {
            let pull = sizes.predict(r).0 - zero;
            if pull.abs() < HARDLY * zero.abs() {
                slack.entry(r.actuator).or_default().push(left);
            }
        }
        let worse = |with: &Vec<f64>| {
            let without: Vec<f64> = with.iter().map(|r| r + zero).collect();
            with.len() >= FEWEST_SLACK && sum_of_squares(&without) < sum_of_squares(with)
        };
        slack.values().any(worse)
    }

    /// Probability of a size by chance, times the number of questions.
    fn p_adjusted(&self, value: f64, error: f64, traces: &Traces, term: usize) -> f64 {
        let p = student_t_two_sided(value / error, traces.freedom(term, error));
        if p.is_nan() {
            1.0
        } else {
            (p * self.questions()).min(1.0)
        }
    }

    /// What every term of a set does on what took no part.
    fn helps(&self, sizes: &Sizes) -> Vec<Help> {
        let with = self.held_out(&sizes.terms, sizes);
        let one = |t: &usize| {
            let others: Vec<usize> = sizes.terms.iter().filter(|o| *o != t).copied().collect();
            let without = self.held_out(&others, sizes);
            let better = with.iter().zip(&without).filter(|(w, o)| w < o).count();
            Help {
                folds: better as f64 / with.len() as f64,
                held_out: (without.iter().sum(), with.iter().sum()),
            }
        };
        sizes.terms.iter().map(one).collect()
    }

    /// Effects that are asked for; forms of one effect are one question.
    fn questions(&self) -> f64 {
        let ids: BTreeSet<&str> = self.candidates.iter().map(|t| ALL[*t].id).collect();
        ids.len() as f64
    }

    /// The sets that a search chooses without one test each, or one stretch where there are few tests.
    pub fn again(&self, search: impl Fn(&Sample) -> Vec<Ranked> + Sync) -> Vec<Vec<usize>> {
        let by = left_out_by(self.readings);
        let units: BTreeSet<usize> = self.readings.iter().map(by).collect();
        let units: Vec<usize> = units.into_iter().collect();
        let without = |unit: &usize| {
            let rest = self.keeping(|r| by(r) != *unit);
            let sets = search(&Sample {
                readings: &rest,
                spreads: self.spreads,
            });
            sets.first().map_or(Vec::new(), |s| s.sizes.terms.clone())
        };
        units.par_iter().map(without).collect()
    }

    fn keeping(&self, keep: impl Fn(&Reading) -> bool) -> Vec<Reading<'a>> {
        self.readings.iter().filter(|r| keep(r)).copied().collect()
    }

    /// The fits without one unit each.
    fn refits(&self, sizes: &Sizes, unit: fn(&Reading) -> usize) -> Vec<Sizes> {
        let units: BTreeSet<usize> = self.readings.iter().map(unit).collect();
        let units: Vec<usize> = units.into_iter().collect();
        let without = |out: &usize| {
            let rest = self.keeping(|r| unit(r) != *out);
            Sizes::of(&sizes.terms, &rest, self.spreads, Some(sizes))
        };
        units.par_iter().map(without).collect()
    }

    /// Held-out sum of squares of a set by fold.
    pub fn held_out(&self, terms: &[usize], from: &Sizes) -> Vec<f64> {
        let fold = fold_of(self.readings);
        let folds: BTreeSet<usize> = self.readings.iter().map(fold).collect();
        let left = |one: usize| {
            let rest = self.keeping(|r| fold(r) != one);
            let own = self.keeping(|r| fold(r) == one);
            let sizes = Sizes::of(terms, &rest, self.spreads, Some(from));
            sum_of_squares(&sizes.residuals(&own))
        };
        folds.into_iter().map(left).collect()
    }

    /// The judgement of every term of a set.
    fn judged(&self, sizes: &Sizes) -> Vec<Judged> {
        let traces = Traces::new(&self.sample(), sizes);
        let errors = self.errors(sizes, &traces);
        let one = |(t, error): (&usize, f64)| {
            let freedom = traces.freedom(*t, error);
            Judged {
                term: *t,
                half_width: student_t_quantile(0.5 + 0.5 * self.confidence, freedom) * error,
                p_adjusted: self.p_adjusted(sizes.values[*t], error, &traces, *t),
            }
        };
        sizes.terms.iter().zip(errors).map(one).collect()
    }

    /// The standard error of every size of a set: whichever way of resampling, or none, says that least is known.
    fn errors(&self, sizes: &Sizes, traces: &Traces) -> Vec<f64> {
        let by_stretch = self.refits(sizes, |r| r.unit);
        let by_test = self.refits(sizes, |r| r.test);
        let jackknife = |refits: &[Sizes], t: usize, fewest: usize| {
            let values: Vec<f64> = refits.iter().map(|s| s.values[t]).collect();
            match values.len() < fewest {
                true => 0.0,
                false => standard_error(sizes.values[t], &values),
            }
        };
        let one = |t: &usize| {
            let by_stretch = jackknife(&by_stretch, *t, FEWEST_GROUPS);
            let by_test = jackknife(&by_test, *t, FEWEST_TESTS_FOR_AN_ERROR);
            by_stretch.max(by_test).max(traces.error(*t))
        };
        sizes.terms.iter().map(one).collect()
    }
}

/// In how many searches a term's effect was chosen, or one that leaves its trace.
fn chosen_again(term: usize, traces: &Traces, again: &[Vec<usize>]) -> f64 {
    let leaves_its_trace = traces.alike(term);
    let alike = |o: &usize| ALL[*o].id == ALL[term].id || leaves_its_trace[*o];
    again.iter().filter(|set| set.iter().any(alike)).count() as f64
}

/// What is left out of the readings when they are searched again: a test, or a stretch of its angles where there are few tests.
pub fn left_out_by(readings: &[Reading]) -> fn(&Reading) -> usize {
    let tests: BTreeSet<usize> = readings.iter().map(|r| r.test).collect();
    if tests.len() >= FEWEST_TESTS {
        |r| r.test
    } else {
        |r| r.unit
    }
}

/// To which fold a reading belongs: its actuator, or where all are of one actuator its test, or stretch where there are few tests.
pub fn fold_of(readings: &[Reading]) -> fn(&Reading) -> usize {
    let first = readings.first().map(|r| r.actuator);
    if readings.iter().all(|r| Some(r.actuator) == first) {
        left_out_by(readings)
    } else {
        |r| r.actuator
    }
}
