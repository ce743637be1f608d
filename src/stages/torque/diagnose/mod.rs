//! The loop on torque: what a rigid leg lacks, as the second problem of the one engine ([`pipeline_inference`]); that of force is the first
//! ([`pipeline_diagnose`]).
//!
//! One joint at a time: the sessions of one diameter whose actuators run along one route over one knee, because route, fittings and brackets are theirs.
//! The law of force is the published one and is not refitted: a knee has too few pressures and lengths to determine it.
//!
//! | file | idea |
//! |---|---|
//! | [`terms`] | the effects, with unit, bounds and source |
//! | [`operator`] | torque, length and arm with effects, force in balance at every angle, with derivatives |
//! | [`data`] | the readings of a joint, with everything that is known of each |
//! | [`library`] | the terms that may be added: forms of effects, and smooth functions of columns |
//! | [`problem`] | the joint as the engine sees it: groups, nuisance components, readings of torque, length and arm |
//! | [`settings`] | what is plausible of a joint |
//! | [`recording`] | mistakes of recording: torques of the other sign, tests that the others make too improbable |
//! | [`unseen`] | the same search without each actuator; errors, predictive intervals, the budget of the expected error |
//! | [`limits`] | what could have been seen, and what is indistinguishable |
//! | [`fittings`] | the length of the end fittings, plain least squares as in the paper: a query of the engine |
//! | [`answer`] | the [`pipeline_findings`], as values |
//! | [`tests`] | errors of every test: rigid, fitted, held out, and with sizes from the largest configuration alone |
//! | [`measurers`] | beside what was reached by hand |
//! | [`curves`] | torque over the angle before and after, for figures |
//!
//! With one actuator or two, effects have estimates like any other; what is said of unseen actuators needs two.

pub mod answer;
pub mod curves;
pub mod data;
pub mod fittings;
pub mod library;
pub mod limits;
pub mod measurers;
pub mod operator;
pub mod problem;
pub mod recording;
pub mod settings;
pub mod terms;
pub mod tests;
pub mod unseen;

use crate::Configuration;
use crate::build::Build;
use answer::Work;
use curves::BeforeAfter;
use data::{Data, Reading, senses};
use measurers::ByHand;
use operator::{At, Joint};
use pipeline_base::random::Stream;
use pipeline_base::session::Role;
use pipeline_config::{DiagnoseOptions, FitOptions};
use pipeline_diagnose::answer::rms;
use pipeline_diagnose::base::Base;
use pipeline_diagnose::slack::Side;
use pipeline_diagnose::{expected, verdict};
use pipeline_findings::{
    CampaignFindings, Design, Errors, HeldOutBy, NotAssessed, RecordingError, Residuals, Verdict,
};
use pipeline_inference::decisions;
use pipeline_inference::fit::Setting;
use pipeline_inference::problem::Problem;
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Decision, Found, Search};
use pipeline_mechanics::models::published;
use problem::{MOST_TERMS, TorqueProblem};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use terms::SIZES;
use tests::{Predictors, TestErrors};
use unseen::HeldOut;

/// What was found of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointDiagnosis {
    /// The findings.
    pub findings: CampaignFindings,
    /// One entry a torque of the search.
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

/// The findings of every joint of a campaign.
pub fn diagnose(
    campaign: &str,
    simulated: bool,
    found: &[(Build, Configuration)],
    options: &DiagnoseOptions,
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
    let laws: Vec<Option<Base>> = joints.iter().map(|j| law(j[0].1.diameter_mm)).collect();
    let groups = joints.into_iter().zip(&laws);
    let groups: Vec<Group> = groups
        .filter_map(|(j, law)| Some(Group::new(j, law.as_ref()?)))
        .collect();
    groups
        .par_iter()
        .map(|group| one(campaign, simulated, group, options))
        .collect()
}

/// The law of force of a diameter: that of the force paper, or where it has none that of the knee paper.
fn law(diameter_mm: u32) -> Option<Base> {
    let known = |id: &str| {
        let all = published();
        let law = all.iter().find(|m| m.id() == id);
        law.is_some_and(|m| m.diameters().contains(&diameter_mm))
    };
    if known("new_published") {
        return Some(Base::new(diameter_mm, false, 1, &FitOptions::default()));
    }
    known("knee_paper")
        .then(|| Base::published("knee_paper", false))
        .flatten()
}

/// A search and what was set aside for it.
struct Searched<'s> {
    setting: Setting<'s>,
    found: Found,
    aside: Vec<(usize, RecordingError)>,
}

fn decision(options: &DiagnoseOptions) -> Decision {
    Decision {
        level: decisions::LEVEL,
        draws: options.draws,
        alike: decisions::ALIKE,
        most_terms: options.most_effects.min(MOST_TERMS),
        thorough: true,
    }
}

/// The search, again without each test that what was found makes too improbable.
fn searched<'s>(
    problem: &'s TorqueProblem<'s>,
    group: &Group,
    decision: Decision,
    normal: &Normal,
) -> Searched<'s> {
    let mut setting = Setting::new(problem);
    for (test, node) in problem.tests.iter().enumerate() {
        if let (Some(node), true) = (node, group.held[test]) {
            setting.active[*node] = false;
        }
    }
    let mut aside: Vec<(usize, RecordingError)> = Vec::new();
    loop {
        let null = setting.fit_afresh(&problem.start());
        let search = Search {
            setting: &setting,
            decision,
            tried: None,
        };
        let found = search.run_exchanging(null, normal, None);
        let outlier = recording::furthest_off(&setting, problem, &found.model);
        match outlier {
            Some((test, error)) if aside.len() < decisions::MOST_MISTAKEN_TESTS => {
                if let Some(node) = problem.tests[test] {
                    setting.active[node] = false;
                }
                aside.push((test, error));
            }
            _ => {
                return Searched {
                    setting,
                    found,
                    aside,
                };
            }
        }
    }
}

/// The readings of a joint that are searched, the mistakes that were seen without a search, and whether they are enough.
struct Chosen<'a> {
    data: Data<'a>,
    mistakes: Vec<RecordingError>,
    enough: bool,
}

impl<'a> Chosen<'a> {
    fn of(group: &Group<'a>) -> Self {
        let whole = group.data(&|t| group.fitted[t] || group.held[t]);
        let mut mistakes = recording::wrong_signs(&whole);
        let wrong = |t: usize| mistakes.iter().any(|s| s.group == group.sessions[t]);
        let right = group.data(&|t| (group.fitted[t] || group.held[t]) && !wrong(t));
        let enough = |data: &Data| {
            let fitted = data.readings.iter().filter(|r| group.fitted[r.test]);
            fitted.count() >= decisions::FEWEST_READINGS_OF_KNOWN_LAW
        };
        // Where hardly a test has the sign of the route, the route is in doubt and not the tests.
        let set_aside = !mistakes.is_empty() && enough(&right);
        let mut data = if set_aside { right } else { whole };
        for m in &mut mistakes {
            m.set_aside = set_aside;
        }
        mistakes.extend(recording::without_odd_hands(&mut data));
        Self {
            enough: enough(&data),
            data,
            mistakes,
        }
    }
}

fn one(
    campaign: &str,
    simulated: bool,
    group: &Group,
    options: &DiagnoseOptions,
) -> JointDiagnosis {
    let Chosen {
        data,
        mut mistakes,
        enough,
    } = Chosen::of(group);
    let mut findings = unassessed(campaign, simulated, group, &data);
    let not_assessed = |reason, mistakes, findings| JointDiagnosis {
        findings: CampaignFindings {
            not_assessed: Some(reason),
            recording_errors: mistakes,
            ..findings
        },
        residuals: Residuals::default(),
        tests: group.tests(&[0.0; SIZES], &[], None),
        by_hand: Vec::new(),
        curves: group.curves(&[0.0; SIZES], &[]),
    };
    if !enough {
        return not_assessed(NotAssessed::TooFewReadings, mistakes, findings);
    }
    let library = library::terms(&data);
    let problem = TorqueProblem::new(&data, &library).with_reference();
    let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
        let mut stream = Stream::new(options.seed, &["torque draw", &k.to_string()]);
        Box::new(move || stream.normal())
    };
    let searched = searched(&problem, group, decision(options), &normal);
    mistakes.extend(searched.aside.iter().map(|(_, error)| error.clone()));
    if !searched.found.null.log_likelihood.is_finite() {
        return not_assessed(NotAssessed::NoConvergence, mistakes, findings);
    }
    findings.recording_errors = mistakes;
    answered(group, &problem, &searched, options, &normal, findings)
}

/// Everything that is asked of the result of a search.
fn answered(
    group: &Group,
    problem: &TorqueProblem,
    searched: &Searched,
    options: &DiagnoseOptions,
    normal: &Normal,
    mut findings: CampaignFindings,
) -> JointDiagnosis {
    let Searched { setting, found, .. } = searched;
    let held = unseen::held_out(setting, problem, found, decision(options), normal);
    let work = Work {
        problem,
        setting,
        found,
        held: &held,
        smallest_nm: options.smallest_effect_nm,
        normal,
    };
    let residuals = work.residuals();
    let variances = found.model.restricted(setting);
    let limits = limits::limits(setting, problem, &found.model, found.critical);
    findings.effects = work.effects();
    findings.unexplained = work.unexplained();
    findings.verdict = verdict(&findings.effects, !findings.unexplained.is_empty());
    findings.scatter = work.scatter(&variances);
    findings.misfit = Some(work.misfit(&variances));
    findings.before = Errors {
        rmse_train: Some(rms(&residuals.before)),
        ..held.before.clone()
    };
    findings.after = Errors {
        rmse_train: Some(rms(&residuals.after)),
        ..held.after.clone()
    };
    findings.next_measurement = work.next(&variances);
    findings.noise = Some(variances.noise[problem::class::TORQUE]);
    findings.tested = work.tested();
    findings.detection_limits = limits.smallest;
    findings.not_measurable = limits.not_measurable;
    findings.aliases = limits.aliases;
    let sizes = problem.sizes(&found.model.point);
    let without = group.found_without(&held);
    let largest = group.largest().map(|own| {
        let sizes = group.fitted_to(searched, problem, &own);
        (own, sizes)
    });
    put_held_out(&mut findings, held);
    let tests = group.tests(&sizes, &without, largest.as_ref());
    JointDiagnosis {
        residuals,
        by_hand: if findings.simulated {
            Vec::new()
        } else {
            measurers::beside(group, &tests)
        },
        findings,
        tests,
        curves: group.curves(&sizes, &without),
    }
}

/// What is known of unseen actuators, beside the errors.
fn put_held_out(findings: &mut CampaignFindings, held: HeldOut) {
    findings.design.held_out_by = held.by;
    findings.expected_rmse_heldout = expected(&held.budget);
    findings.inside_50 = held.inside.map(|i| i.0);
    findings.inside_95 = held.inside.map(|i| i.1);
    findings.pit = held.pit;
    findings.by_unit = held.units;
    findings.budget = held.budget;
}

/// The findings of a joint of which nothing is said yet.
fn unassessed(campaign: &str, simulated: bool, group: &Group, data: &Data) -> CampaignFindings {
    let configuration = &group.members[0].1;
    let count = |of: &dyn Fn(&Reading) -> bool| data.readings.iter().filter(|r| of(r)).count();
    let distinct = |of: fn(&Reading) -> usize| -> usize {
        let fitted = data.readings.iter().filter(|r| group.fitted[r.test]);
        fitted.map(of).collect::<BTreeSet<usize>>().len()
    };
    let outside = group.unanswered.iter().zip(&group.fitted);
    CampaignFindings {
        campaign: campaign.to_owned(),
        part: Some(configuration.joint()),
        diameter_mm: configuration.diameter_mm,
        simulated,
        kind: "knee-torque".to_owned(),
        base_model: group.law.id.clone(),
        base_refitted: false,
        unit: "N.m".to_owned(),
        design: Design {
            readings: count(&|r| group.fitted[r.test]),
            readings_outside_domain: outside.filter(|(_, fitted)| **fitted).map(|(n, _)| n).sum(),
            sessions: distinct(|r| r.test),
            specimens: distinct(|r| r.actuator),
            readings_held_out: count(&|r| group.held[r.test]),
            held_out_by: HeldOutBy::None,
            doubtful_only: group.doubtful,
        },
        verdict: Verdict::NotAssessed,
        not_assessed: None,
        effects: Vec::new(),
        scatter: Vec::new(),
        misfit: None,
        unexplained: Vec::new(),
        recording_errors: Vec::new(),
        before: Errors::default(),
        after: Errors::default(),
        by_unit: Vec::new(),
        budget: Vec::new(),
        expected_rmse_heldout: None,
        inside_50: None,
        inside_95: None,
        pit: Vec::new(),
        noise: None,
        black_box_rmse_heldout: None,
        tested: Vec::new(),
        detection_limits: Vec::new(),
        not_measurable: Vec::new(),
        aliases: Vec::new(),
        next_measurement: Vec::new(),
        coefficients: Vec::new(),
        alternatives: Vec::new(),
    }
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
    fn fitted_to(
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
    fn found_without(&self, held: &HeldOut) -> Vec<Option<[f64; SIZES]>> {
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

    fn tests(
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
            Some(tests::errors(
                (session, specimen),
                &own,
                (self.fitted[test], in_largest),
                &with,
            ))
        };
        self.sessions.iter().enumerate().filter_map(one).collect()
    }

    fn curves(&self, sizes: &[f64; SIZES], without: &[Option<[f64; SIZES]>]) -> Vec<BeforeAfter> {
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
