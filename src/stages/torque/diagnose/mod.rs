//! The loop on torque: what a rigid leg lacks, found from the torques, with the guards of the isometric search.
//!
//! One joint at a time: the sessions of one diameter whose actuators run along one route over one knee, because route, fittings and brackets are theirs.
//! The law of force is the published one and is not refitted: a knee has too few pressures and lengths to determine it.
//!
//! | file | idea |
//! |---|---|
//! | [`terms`] | the effects, with unit, bounds and source |
//! | [`operator`] | the torque with effects, force in balance at every angle, with derivatives |
//! | [`nuisance`] | what is a test's or an actuator's own and no effect: how it was mounted, how strong it is |
//! | [`refit`] | least squares of any set of effects on any part of the readings |
//! | [`search`] | every set of one or two, by BIC with the effective number of readings |
//! | [`judge`] | what of it stands: intervals, held-out actuators, chosen again without any one test |
//! | [`traces`] | which effects the design can tell apart, and the smallest sizes that it can show |
//! | [`questions`] | whether what is left depends on any column |
//! | [`black_box`] | what a smooth curve over a column would explain |
//! | [`tests`] | errors of every test: rigid, fitted, held out, and with sizes from the largest configuration alone |
//! | [`measurers`] | beside what was reached by hand |
//! | [`curves`] | torque over the angle before and after, for figures |
//! | `odd` | mistakes of recording: tests that are far off by themselves, torques of the other sign |
//! | [`answer`] | the findings: what this search computes of [`crate::findings`], and nothing else |

pub mod answer;
pub mod black_box;
pub mod curves;
pub mod judge;
pub mod measurers;
pub mod nuisance;
mod odd;
pub mod operator;
pub mod questions;
pub mod refit;
pub mod search;
pub mod terms;
pub mod tests;
pub mod traces;

use crate::base::random::Stream;
use crate::base::session::Role;
use crate::findings::{CampaignFindings, Residuals};
use crate::models::{ForceModel, published};
use crate::stages::torque::Configuration;
use crate::stages::torque::build::Build;
use crate::stages::torque::point::Point;
use curves::BeforeAfter;
use judge::{Accepted, Task};
use measurers::ByHand;
use nuisance::Spreads;
use operator::{At, Joint};
use rayon::prelude::*;
use refit::{Reading, Sizes, is_answered};
use search::{Known, Sample};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use terms::{MOST, TERMS, place};
use tests::TestErrors;

/// Fewest readings that are searched.
const FEWEST_READINGS: usize = 8;
/// Fewest readings for each term of the set that tells how much tests differ.
const READINGS_A_TERM: usize = 10;
/// Sets, best first, among which one is chosen again without a test: what is far behind with all tests is not first without one.
const SEARCHED_AGAIN: usize = 20;
/// Fewest readings after the joint turned either way, for friction to be asked for.
const FEWEST_EACH_WAY: usize = 3;
/// Stretches of the angle in a test, fewer where each would have less than two readings: units of resampling, because what a law of force lacks
/// at an angle is in all readings near to it.
const STRETCHES: usize = 5;

/// What was found of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointDiagnosis {
    /// The findings.
    pub findings: CampaignFindings,
    /// One entry a reading of the search; empty where a figure of it means nothing.
    #[serde(default)]
    pub residuals: Residuals,
    /// Errors by test.
    pub tests: Vec<TestErrors>,
    /// What the measurers reached by hand, where they had the actuator.
    pub by_hand: Vec<ByHand>,
    /// Torques over the angle, before and after.
    pub curves: Vec<BeforeAfter>,
}

/// Everything of one joint, ready to be searched.
pub(crate) struct Group<'a> {
    /// Configurations with their builds.
    pub members: Vec<&'a (Build, Configuration)>,
    /// The law of force.
    pub law: &'static dyn ForceModel,
    /// Every answered reading of every test, excluded ones too, in the order of the tests.
    pub all: Vec<Reading<'a>>,
    /// Session of each test number.
    pub sessions: Vec<&'a str>,
    /// Whether each test is fitted.
    pub fitted: Vec<bool>,
    /// Whether each test is held out by its owner, of all that is chosen and fitted.
    pub held: Vec<bool>,
    /// What is doubted of each test.
    pub doubts: Vec<Option<&'a str>>,
    /// Readings of each test for which the rigid leg has no torque.
    pub unanswered: Vec<usize>,
    /// Whether there are none but doubtful tests, which are then searched by themselves.
    pub doubtful: bool,
    /// Actuators by number.
    pub actuators: Vec<&'a str>,
    /// Measured arm of each reading in `all`, m.
    pub arms_by_hand: Vec<Option<f64>>,
    /// Other columns of each reading in `all`.
    pub extras: Vec<&'a BTreeMap<String, f64>>,
}

/// The findings of every joint of a campaign.
pub fn diagnose(
    campaign: &str,
    simulated: bool,
    found: &[(Build, Configuration)],
    confidence: f64,
) -> Vec<JointDiagnosis> {
    let mut joints: Vec<Vec<&(Build, Configuration)>> = Vec::new();
    for member in found {
        let same = |(b, c): &(Build, Configuration)| {
            b.knee == member.0.knee
                && b.route == member.0.route
                && c.diameter_mm == member.1.diameter_mm
        };
        match joints.iter_mut().find(|j| same(j[0])) {
            Some(joint) => joint.push(member),
            None => joints.push(vec![member]),
        }
    }
    let groups: Vec<Group> = joints.into_iter().filter_map(Group::new).collect();
    groups
        .par_iter()
        .filter_map(|group| one(campaign, simulated, group, confidence))
        .collect()
}

/// The search on some of the readings: the accepted set, and all that were looked at.
pub(crate) struct Searched<'a> {
    /// What stands.
    pub accepted: Accepted,
    /// Every set, best first.
    pub sets: Vec<search::Ranked>,
    /// Terms that were asked for.
    pub candidates: Vec<usize>,
    /// Most terms that were looked for at once.
    pub most: usize,
    /// The readings, with what is their tests' and actuators' own.
    pub readings: Vec<Reading<'a>>,
    /// By how much tests and actuators differ.
    pub spreads: Spreads,
}

/// The whole search on readings: the same on all of them and within every fold.
pub(crate) fn searched<'a>(
    readings: &[Reading<'a>],
    known: &Known,
    confidence: f64,
) -> Searched<'a> {
    let candidates = candidates(readings);
    let tests: BTreeSet<usize> = readings.iter().map(|r| r.test).collect();
    // Stretches of one test determine one number.
    let most = if tests.len() > 1 { 2 } else { 1 };
    let (readings, spreads) = with_spreads(readings, &candidates, known);
    let task = Task {
        readings: &readings,
        spreads: &spreads,
        candidates: &candidates,
        most,
        confidence,
    };
    let sets = task.sample().ranked(&candidates, most, known);
    let own = known_of(&sets);
    let near: Vec<Vec<usize>> = sets.iter().map(|s| s.sizes.terms.clone()).collect();
    let near = &near[..near.len().min(SEARCHED_AGAIN)];
    let again = task.again(|sample| sample.of(near, &own));
    let accepted = task.accepted(&sets, &again, &own);
    Searched {
        accepted,
        sets,
        candidates,
        most,
        readings,
        spreads,
    }
}

/// The terms that mean anything for some readings.
fn candidates(readings: &[Reading]) -> Vec<usize> {
    let turned = |sense: f64| readings.iter().filter(|r| r.at.sense == sense).count();
    let both_ways = turned(1.0).min(turned(-1.0)) >= FEWEST_EACH_WAY;
    let has = |t: &usize| match *t {
        place::FRICTION => both_ways,
        other => readings.iter().all(|r| r.joint.has(other)),
    };
    (0..TERMS).filter(has).collect()
}

/// The readings with what is their tests' and actuators' own, and how much these differ: as the effects that explain most, one after the
/// other, leave them. That search takes all of the rigid leg's residual for noise, so that nothing is put down to the tests before effects were tried.
fn with_spreads<'a>(
    readings: &[Reading<'a>],
    candidates: &[usize],
    known: &Known,
) -> (Vec<Reading<'a>>, Spreads) {
    let rigid = Sizes::rigid(readings, &Spreads::before(1.0));
    let first = rigid.with_own(readings);
    let spreads = Spreads::before((rigid.sse / readings.len() as f64).sqrt());
    let sample = Sample {
        readings: &first,
        spreads: &spreads,
    };
    let mut best = rigid;
    let most = (readings.len() / READINGS_A_TERM).clamp(1, MOST);
    for _ in 0..most {
        let larger = sample.extended(&best.terms, candidates, known);
        let least = larger
            .iter()
            .min_by(|a, b| a.sizes.left.total_cmp(&b.sizes.left));
        best = least.map_or(best, |s| s.sizes.clone());
    }
    let own = best.with_own(readings);
    let spreads = Spreads::of(&own, &best);
    (own, spreads)
}

fn known_of(sets: &[search::Ranked]) -> Known {
    let named = |s: &search::Ranked| (s.sizes.terms.clone(), s.sizes.clone());
    sets.iter().map(named).collect()
}

fn one(campaign: &str, simulated: bool, group: &Group, confidence: f64) -> Option<JointDiagnosis> {
    let readings = group.searched_readings();
    if readings.len() < FEWEST_READINGS {
        return None;
    }
    let whole = searched(&readings, &Known::new(), confidence);
    let known = known_of(&whole.sets);
    let fold = judge::fold_of(&readings);
    let folds: BTreeSet<usize> = readings.iter().map(fold).collect();
    let folds: Vec<usize> = folds.into_iter().collect();
    let without = |out: &usize| {
        let rest: Vec<Reading> = readings
            .iter()
            .filter(|r| fold(r) != *out)
            .copied()
            .collect();
        let found = searched(&rest, &known, confidence);
        (*out, found.accepted.sizes)
    };
    let held_out: Vec<(usize, Sizes)> = folds.par_iter().map(without).collect();
    let largest = group.largest().map(|own_tests| {
        let of = whole.readings.iter();
        let part: Vec<Reading> = of
            .filter(|r| own_tests.contains(&r.test))
            .copied()
            .collect();
        let chosen = &whole.accepted.sizes;
        let sizes = Sizes::of(&chosen.terms, &part, &whole.spreads, Some(chosen));
        (own_tests, sizes)
    });
    let tests = tests::errors(
        group,
        &whole.accepted.sizes,
        &held_out,
        fold,
        largest.as_ref(),
    );
    let answered = answer::Answered {
        campaign,
        simulated,
        group,
        whole: &whole,
        held_out: &held_out,
        tests: &tests,
        confidence,
    };
    let findings = answered.findings();
    let curves = curves::curves(group, &whole.accepted.sizes, &held_out, fold);
    Some(JointDiagnosis {
        findings,
        residuals: Residuals::default(),
        by_hand: match simulated {
            true => Vec::new(),
            false => measurers::beside(group, &tests),
        },
        tests,
        curves,
    })
}

impl<'a> Group<'a> {
    fn new(members: Vec<&'a (Build, Configuration)>) -> Option<Self> {
        let diameter = members.first()?.1.diameter_mm;
        let all = published();
        let law = ["new_published", "knee_paper"].iter().find_map(|id| {
            let law = all.iter().find(|m| m.id() == *id).copied()?;
            law.diameters().contains(&diameter).then_some(law)
        })?;
        let mut group = Self {
            members,
            law,
            all: Vec::new(),
            sessions: Vec::new(),
            fitted: Vec::new(),
            held: Vec::new(),
            doubts: Vec::new(),
            unanswered: Vec::new(),
            doubtful: false,
            actuators: Vec::new(),
            arms_by_hand: Vec::new(),
            extras: Vec::new(),
        };
        for (build, configuration) in group.members.clone() {
            group.add(build, configuration);
        }
        group.fall_back_to_doubtful();
        group.number_units();
        Some(group)
    }

    fn add(&mut self, build: &'a Build, configuration: &'a Configuration) {
        let joint = Joint::new(build, self.law);
        let specimen = configuration.specimen.as_str();
        let known = self.actuators.iter().position(|a| *a == specimen);
        let actuator = known.unwrap_or(self.actuators.len());
        if known.is_none() {
            self.actuators.push(specimen);
        }
        for test in &configuration.tests {
            let number = self.sessions.len();
            let senses = senses(&test.points);
            let mut readings = Vec::new();
            let mut unanswered = 0;
            for (order, (p, sense)) in test.points.iter().zip(senses).enumerate() {
                let reading = Reading {
                    joint,
                    at: At {
                        angle_rad: p.angle_rad,
                        pressure_kpa: p.pressure_kpa,
                        sense,
                        order: order as f64,
                        placebo: 0.0,
                    },
                    torque_nm: p.torque_nm,
                    actuator,
                    test: number,
                    unit: number,
                    own: [0.0; 2],
                };
                if !p.pressure_kpa.is_finite() {
                    continue;
                }
                if p.expected.is_some() && is_answered(&reading) {
                    readings.push(reading);
                    self.arms_by_hand.push(p.by_hand.arm_m);
                    self.extras.push(&p.extras);
                } else {
                    unanswered += 1;
                }
            }
            self.unanswered.push(unanswered);
            self.all.extend(shuffled(readings, &test.session));
            self.sessions.push(&test.session);
            self.fitted.push(test.is_fitted());
            let held = !test.is_left_out() && test.role == Some(Role::Holdout);
            self.held.push(held);
            let doubt = test.doubtful.as_deref();
            self.doubts.push(doubt.filter(|_| test.excluded.is_none()));
        }
    }

    /// A joint of which nothing but doubtful tests exist is searched on these, and its findings say so.
    fn fall_back_to_doubtful(&mut self) {
        self.doubtful = !self.fitted.contains(&true) && self.doubts.iter().any(Option::is_some);
        if self.doubtful {
            self.fitted = self.doubts.iter().map(Option::is_some).collect();
        }
    }

    /// A unit is a stretch of the angle of one test.
    fn number_units(&mut self) {
        for test in 0..self.sessions.len() {
            let mut places: Vec<usize> = (0..self.all.len())
                .filter(|k| self.all[*k].test == test)
                .collect();
            places.sort_by(|a, b| {
                let angle = |k: &usize| self.all[*k].at.angle_rad;
                angle(a).total_cmp(&angle(b)).then(a.cmp(b))
            });
            let n = places.len();
            let stretches = STRETCHES.min(n / 2).max(1);
            for (rank, place) in places.into_iter().enumerate() {
                self.all[place].unit = test * STRETCHES + rank * stretches / n;
            }
        }
    }

    /// The readings of the tests that are fitted.
    pub fn searched_readings(&self) -> Vec<Reading<'a>> {
        let fitted = self.all.iter().filter(|r| self.fitted[r.test]);
        fitted.copied().collect()
    }

    /// The readings of the tests that their owner holds out.
    pub fn held_readings(&self) -> Vec<Reading<'a>> {
        let held = self.all.iter().filter(|r| self.held[r.test]);
        held.copied().collect()
    }

    /// The other columns that all readings of the tests that are fitted have.
    fn searched_extras(&self) -> Vec<(String, Vec<f64>)> {
        let all = self.all.iter().zip(&self.extras);
        let searched = all.filter(|(r, _)| self.fitted[r.test]);
        let extras: Vec<&BTreeMap<String, f64>> = searched.map(|(_, extras)| *extras).collect();
        let names = extras.first().into_iter().flat_map(|first| first.keys());
        let column = |name: &String| {
            let values: Option<Vec<f64>> = extras.iter().map(|e| e.get(name).copied()).collect();
            Some((name.clone(), values?))
        };
        names.filter_map(column).collect()
    }

    /// The tests of the configuration with most fitted readings, where there are others.
    fn largest(&self) -> Option<Vec<usize>> {
        let by_readings = self.members.iter().map(|m| &m.1).enumerate();
        let (_, largest) = by_readings
            .max_by_key(|(k, c)| (c.fitted_points(), std::cmp::Reverse(*k)))
            .filter(|_| self.actuators.len() > 1)?;
        let of = |session: &&str| largest.tests.iter().any(|t| t.session == **session);
        let tests = self.sessions.iter().enumerate().filter(|(_, s)| of(s));
        Some(tests.map(|(k, _)| k).filter(|k| self.fitted[*k]).collect())
    }
}

/// In which sense the joint turned before each reading, from their order: 0 before the first move, and while it stands that of the last one.
fn senses(points: &[Point]) -> Vec<f64> {
    let mut senses = vec![0.0; points.len()];
    for k in 1..points.len() {
        let by = points[k].angle_rad - points[k - 1].angle_rad;
        senses[k] = match by.partial_cmp(&0.0) {
            Some(Ordering::Greater) => 1.0,
            Some(Ordering::Less) => -1.0,
            _ => senses[k - 1],
        };
    }
    senses
}

/// The readings of a test with a shuffled copy of their angles, from -1 to 1: a column that must never be chosen.
fn shuffled<'a>(mut readings: Vec<Reading<'a>>, session: &str) -> Vec<Reading<'a>> {
    let mut angles: Vec<f64> = readings.iter().map(|r| r.at.angle_rad).collect();
    let mut stream = Stream::new(1, &["torque placebo", session]);
    for k in (1..angles.len()).rev() {
        angles.swap(k, stream.below(k + 1));
    }
    let (low, high) = angles
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| {
            (l.min(*a), h.max(*a))
        });
    for (reading, angle) in readings.iter_mut().zip(angles) {
        let width = (high - low).max(f64::MIN_POSITIVE);
        reading.at.placebo = 2.0 * (angle - low) / width - 1.0;
    }
    readings
}
