//! The loop on torque: what a rigid leg lacks, found from the torques, with the guards of the isometric search.
//!
//! One joint at a time: the sessions of one diameter whose actuators run along one route over one knee, because route, fittings and brackets are theirs.
//! The law of force is the published one and is not refitted: a knee has too few pressures and lengths to determine it.
//!
//! | file | idea |
//! |---|---|
//! | [`terms`] | the effects, with unit, bounds and source |
//! | [`operator`] | the torque with effects, force in balance at every angle, with derivatives |
//! | [`refit`] | least squares of any set of effects on any part of the readings |
//! | [`search`] | every set of one or two, by BIC with the effective number of readings |
//! | [`judge`] | what of it stands: jackknife, held-out actuators, chosen again without any one test |
//! | [`traces`] | which effects the design can tell apart, and the smallest sizes that it can show |
//! | [`black_box`] | what a smooth curve over the angle would explain |
//! | [`tests`] | errors of every test: rigid, fitted, held out, and with sizes from the largest configuration alone |
//! | [`answer`], `words` | the findings |

pub mod answer;
pub mod black_box;
pub mod judge;
pub mod operator;
pub mod refit;
pub mod search;
pub mod terms;
pub mod tests;
pub mod traces;
mod words;

use crate::base::random::Stream;
use crate::models::{ForceModel, published};
use crate::stages::diagnose::findings::CampaignFindings;
use crate::stages::torque::Configuration;
use crate::stages::torque::build::Build;
use judge::{Accepted, Task};
use operator::{At, Joint};
use rayon::prelude::*;
use refit::{Reading, Sizes, is_answered};
use search::Known;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use terms::TERMS;
use tests::TestErrors;

/// Fewest readings that are searched.
const FEWEST_READINGS: usize = 8;
/// Fewest tests that are units of resampling; with fewer, stretches of the angle are.
const FEWEST_TESTS: usize = 4;
/// Stretches of the angle, where tests are too few.
const STRETCHES: usize = 5;

/// What was found of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointDiagnosis {
    /// The findings.
    pub findings: CampaignFindings,
    /// Errors by test.
    pub tests: Vec<TestErrors>,
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
    /// Actuators by number.
    pub actuators: Vec<&'a str>,
    /// Measured arm of each reading in `all`, m.
    pub arms_by_hand: Vec<Option<f64>>,
    /// Whether the units are tests.
    pub by_test: bool,
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
pub(crate) struct Searched {
    /// What stands.
    pub accepted: Accepted,
    /// Every set, best first.
    pub sets: Vec<search::Ranked>,
    /// Sets that were chosen without one unit each.
    pub again: Vec<Vec<usize>>,
}

/// The whole search on readings. Within folds (`outer` false) terms need not be chosen again: the folds are that question.
pub(crate) fn searched(
    readings: &[Reading],
    known: &Known,
    outer: bool,
    (candidates, most, confidence): (&[usize], usize, f64),
) -> Searched {
    let task = Task {
        readings,
        candidates,
        most,
        confidence,
    };
    let sets = search::ranked(readings, candidates, most, known);
    let own: Known = sets
        .iter()
        .map(|s| (s.sizes.terms.clone(), s.sizes.clone()))
        .collect();
    let again = if outer { task.again(&own) } else { Vec::new() };
    Searched {
        accepted: task.accepted(&sets, &again),
        sets,
        again,
    }
}

fn one(campaign: &str, simulated: bool, group: &Group, confidence: f64) -> Option<JointDiagnosis> {
    let readings = group.searched_readings();
    if readings.len() < FEWEST_READINGS {
        return None;
    }
    let joint = &readings[0].joint;
    let candidates: Vec<usize> = (0..TERMS).filter(|t| joint.has(*t)).collect();
    // Stretches of one test determine one number.
    let most = if group.by_test { 2 } else { 1 };
    let asked = (&candidates[..], most, confidence);
    let whole = searched(&readings, &Known::new(), true, asked);
    let known: Known = whole
        .sets
        .iter()
        .map(|s| (s.sizes.terms.clone(), s.sizes.clone()))
        .collect();
    let fold = judge::fold_of(&readings);
    let folds: BTreeSet<usize> = readings.iter().map(fold).collect();
    let folds: Vec<usize> = folds.into_iter().collect();
    let without = |out: &usize| {
        let rest: Vec<Reading> = readings
            .iter()
            .filter(|r| fold(r) != *out)
            .copied()
            .collect();
        let found = searched(&rest, &known, false, asked);
        (*out, found.accepted.sizes)
    };
    let held_out: Vec<(usize, Sizes)> = folds.par_iter().map(without).collect();
    let largest = group.largest().map(|own_tests| {
        let part: Vec<Reading> = readings
            .iter()
            .filter(|r| own_tests.contains(&r.test))
            .copied()
            .collect();
        let chosen = &whole.accepted.sizes;
        (own_tests, Sizes::of(&chosen.terms, &part, Some(chosen)))
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
        readings: &readings,
        candidates: &candidates,
        most,
        whole: &whole,
        held_out: &held_out,
        largest: largest.as_ref().map(|(_, sizes)| sizes),
        tests: &tests,
        confidence,
    };
    let findings = answered.findings();
    Some(JointDiagnosis { findings, tests })
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
            actuators: Vec::new(),
            arms_by_hand: Vec::new(),
            by_test: true,
        };
        for (build, configuration) in group.members.clone() {
            group.add(build, configuration);
        }
        group.by_test = group.fitted.iter().filter(|f| **f).count() >= FEWEST_TESTS;
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
            let points = test.points.iter().filter_map(|p| {
                let reading = Reading {
                    joint,
                    at: At {
                        angle_rad: p.angle_rad,
                        pressure_kpa: p.pressure_kpa,
                        placebo: 0.0,
                    },
                    torque_nm: p.torque_nm,
                    actuator,
                    test: number,
                    unit: number,
                };
                let usable = p.expected.is_some() && p.pressure_kpa.is_finite();
                (usable && is_answered(&reading)).then_some((reading, p.by_hand.arm_m))
            });
            let (readings, arms): (Vec<Reading>, Vec<Option<f64>>) = points.unzip();
            self.all.extend(shuffled(readings, &test.session));
            self.arms_by_hand.extend(arms);
            self.sessions.push(&test.session);
            self.fitted.push(test.is_fitted());
        }
    }

    /// Where tests are too few, a unit is a stretch of the angle of one test.
    fn number_units(&mut self) {
        if self.by_test {
            return;
        }
        for test in 0..self.sessions.len() {
            let mut places: Vec<usize> = (0..self.all.len())
                .filter(|k| self.all[*k].test == test)
                .collect();
            places.sort_by(|a, b| {
                let angle = |k: &usize| self.all[*k].at.angle_rad;
                angle(a).total_cmp(&angle(b)).then(a.cmp(b))
            });
            let n = places.len();
            for (rank, place) in places.into_iter().enumerate() {
                self.all[place].unit = test * STRETCHES + rank * STRETCHES / n;
            }
        }
    }

    /// The readings of the tests that are fitted.
    pub fn searched_readings(&self) -> Vec<Reading<'a>> {
        let fitted = self.all.iter().filter(|r| self.fitted[r.test]);
        fitted.copied().collect()
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
