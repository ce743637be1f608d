//! Everything of one joint, ready to be searched: its tests with their readings, which of them are fitted or held out.

use super::by_test::{self, Predictors, TestErrors};
use super::curves::{self, BeforeAfter};
use super::data::{Data, Reading, senses};
use super::joint::Searched;
use super::operator::{At, Joint};
use super::problem::TorqueProblem;
use super::terms::SIZES;
use super::unseen::HeldOut;
use crate::Configuration;
use crate::build::Build;
use pipeline_base::session::Role;
use pipeline_diagnose::base::Base;
use pipeline_diagnose::slack::Side;
use pipeline_findings::HeldOutBy;

/// Everything of one joint, ready to be searched.
pub struct Group<'a> {
    /// Configurations with their builds.
    pub members: Vec<&'a (Build, Configuration)>,
    /// The law of force.
    pub law: &'a Base,
    /// Every answered reading of every test, excluded ones too, in the order of the tests.
    pub all: Vec<Reading<'a>>,
    /// Session of each test number.
    pub sessions: Vec<&'a str>,
    /// Whether each test is fitted.
    pub fitted: Vec<bool>,
    /// Whether each test is held out by its owner, of all that is chosen and fitted.
    pub held: Vec<bool>,
    /// Whether each test is in doubt.
    doubted: Vec<bool>,
    /// Readings of each test for which the rigid leg has no torque.
    pub unanswered: Vec<usize>,
    /// Whether there are none but doubtful tests, which are then searched by themselves.
    pub doubtful: bool,
    /// Actuators by number.
    pub actuators: Vec<&'a str>,
}

impl<'a> Group<'a> {
    /// The tests of some configurations of one joint.
    pub fn new(members: Vec<&'a (Build, Configuration)>, law: &'a Base) -> Self {
        let mut group = Self {
            members,
            law,
            all: Vec::new(),
            sessions: Vec::new(),
            fitted: Vec::new(),
            held: Vec::new(),
            doubted: Vec::new(),
            unanswered: Vec::new(),
            doubtful: false,
            actuators: Vec::new(),
        };
        for (build, configuration) in group.members.clone() {
            group.add(build, configuration);
        }
        group.fall_back_to_doubtful();
        group
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
            let mut unanswered = 0;
            for (order, (p, sense)) in test.points.iter().zip(senses(&test.points)).enumerate() {
                let reading = Reading {
                    joint,
                    at: At {
                        angle_rad: p.angle_rad,
                        pressure_kpa: p.pressure_kpa,
                        sense,
                    },
                    side: Side::Pulls,
                    torque_nm: p.torque_nm,
                    by_hand: p.by_hand,
                    actuator,
                    test: number,
                    order: order as f64 / (test.points.len().max(2) - 1) as f64,
                    source: (&p.log, p.row),
                    extras: &p.extras,
                };
                if !p.pressure_kpa.is_finite() {
                    continue;
                }
                let answered = p.torque_nm.is_finite() && reading.shown(&[0.0; SIZES]).is_some();
                if p.expected.is_some() && answered {
                    self.all.push(reading);
                } else {
                    unanswered += 1;
                }
            }
            self.unanswered.push(unanswered);
            self.sessions.push(&test.session);
            self.fitted.push(test.is_fitted());
            self.held
                .push(!test.is_left_out() && test.role == Some(Role::Holdout));
            self.doubted
                .push(test.doubtful.is_some() && test.excluded.is_none());
        }
    }

    /// A joint of which nothing but doubtful tests exist is searched on these, and its findings say so.
    fn fall_back_to_doubtful(&mut self) {
        self.doubtful = !self.fitted.contains(&true) && self.doubted.contains(&true);
        if self.doubtful {
            self.fitted.clone_from(&self.doubted);
        }
    }

    /// The readings of some tests, by their numbers.
    pub fn data(&self, takes: &dyn Fn(usize) -> bool) -> Data<'a> {
        let own = self.all.iter().filter(|r| takes(r.test)).copied();
        Data::new(own.collect(), self.sessions.clone(), self.actuators.clone())
    }

    /// The tests of the configuration with most fitted readings, where there are others.
    pub fn largest(&self) -> Option<Vec<usize>> {
        let by_readings = self.members.iter().map(|m| &m.1).enumerate();
        let (_, largest) = by_readings
            .max_by_key(|(k, c)| (c.fitted_points(), std::cmp::Reverse(*k)))
            .filter(|_| self.actuators.len() > 1)?;
        let of = |session: &&str| largest.tests.iter().any(|t| t.session == **session);
        let tests = self.sessions.iter().enumerate().filter(|(_, s)| of(s));
        Some(tests.map(|(k, _)| k).filter(|k| self.fitted[*k]).collect())
    }

    /// Sizes of the effects that were found, fitted to some tests alone.
    pub(super) fn fitted_to(
        &self,
        searched: &Searched,
        problem: &TorqueProblem,
        tests: &[usize],
    ) -> [f64; SIZES] {
        let mut setting = searched.setting.clone();
        for (test, node) in problem.tests.iter().enumerate() {
            if let (Some(node), false) = (node, tests.contains(&test)) {
                setting.active[*node] = false;
            }
        }
        let model = &searched.found.model;
        let fitted = setting.fit(
            &model.cleared(&setting),
            std::slice::from_ref(&model.variances),
        );
        problem.sizes(&fitted.point)
    }

    /// For each test the sizes that were found without it.
    pub(super) fn found_without(&self, held: &HeldOut) -> Vec<Option<[f64; SIZES]>> {
        let of = |test: usize| {
            let own = self.all.iter().find(|r| r.test == test)?;
            let name = match held.by {
                HeldOutBy::Actuator if self.fitted[test] => self.actuators[own.actuator],
                HeldOutBy::Holdout => self.sessions[test],
                _ => return None,
            };
            let fold = held
                .folds
                .iter()
                .find(|f| f.nodes.iter().any(|(n, _)| n == name))?;
            Some(fold.sizes)
        };
        (0..self.sessions.len()).map(of).collect()
    }

    /// Readings of one test.
    fn of_test(&self, test: usize) -> Vec<Reading<'a>> {
        self.all
            .iter()
            .filter(|r| r.test == test)
            .copied()
            .collect()
    }

    pub(super) fn tests(
        &self,
        sizes: &[f64; SIZES],
        without: &[Option<[f64; SIZES]>],
        largest: Option<&(Vec<usize>, [f64; SIZES])>,
    ) -> Vec<TestErrors> {
        let one = |(test, session): (usize, &&str)| {
            let own = self.of_test(test);
            let specimen = self.actuators[own.first()?.actuator];
            let with = Predictors {
                all: sizes,
                held_out: without.get(test).and_then(Option::as_ref),
                largest: largest.map(|(_, sizes)| sizes),
            };
            let in_largest = largest.is_some_and(|(tests, _)| tests.contains(&test));
            Some(by_test::errors(
                (session, specimen),
                &own,
                (self.fitted[test], in_largest),
                &with,
            ))
        };
        self.sessions.iter().enumerate().filter_map(one).collect()
    }

    pub(super) fn curves(
        &self,
        sizes: &[f64; SIZES],
        without: &[Option<[f64; SIZES]>],
    ) -> Vec<BeforeAfter> {
        let one = |(build, configuration): &&(Build, Configuration)| {
            let joint = Joint::new(build, self.law);
            let tests = &configuration.tests;
            let is_own = |t: usize| tests.iter().any(|own| own.session == self.sessions[t]);
            let own: Vec<Reading> = self
                .all
                .iter()
                .filter(|r| is_own(r.test))
                .copied()
                .collect();
            let without = own.iter().find_map(|r| without.get(r.test)?.as_ref());
            curves::of_configuration(&joint, (build, configuration), &own, sizes, without)
        };
        self.members.iter().flat_map(one).collect()
    }
}
