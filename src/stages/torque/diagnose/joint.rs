//! One joint: the readings that are searched, the search without what is set aside, and everything that is asked of its result.

use super::answer::Work;
use super::data::Data;
use super::group::Group;
use super::problem::{MOST_TERMS, TorqueProblem, class};
use super::terms::SIZES;
use super::unassessed::unassessed;
use super::unseen::{self, HeldOut};
use super::{JointDiagnosis, library, limits, measurers, recording};
use pipeline_base::random::Stream;
use pipeline_config::DiagnoseOptions;
use pipeline_diagnose::answer::rms;
use pipeline_diagnose::{expected, verdict};
use pipeline_findings::{CampaignFindings, Errors, NotAssessed, RecordingError, Residuals};
use pipeline_inference::decisions;
use pipeline_inference::fit::Setting;
use pipeline_inference::problem::Problem;
use pipeline_inference::profile::Profiles;
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Decision, Found, Search};

/// A search and its result.
pub(super) struct Searched<'s> {
    pub(super) setting: Setting<'s>,
    pub(super) found: Found,
}

fn decision(options: &DiagnoseOptions) -> Decision {
    Decision {
        most_terms: options.most_effects.min(MOST_TERMS),
        ..pipeline_diagnose::decision(options)
    }
}

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
    let null = setting.fit_afresh(&problem.start());
    let search = Search {
        setting: &setting,
        decision,
        tried: None,
    };
    let found = search.run_exchanging(null, normal, None);
    Searched { setting, found }
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

pub(super) fn one(
    campaign: &str,
    simulated: bool,
    group: &Group,
    options: &DiagnoseOptions,
) -> JointDiagnosis {
    let Chosen {
        mut data,
        mut mistakes,
        enough,
    } = Chosen::of(group);
    let not_assessed = |reason, mistakes, data: &Data| JointDiagnosis {
        findings: CampaignFindings {
            not_assessed: Some(reason),
            recording_errors: mistakes,
            ..unassessed(campaign, simulated, group, data, options.draws)
        },
        residuals: Residuals::default(),
        tests: group.tests(&[0.0; SIZES], &[], None),
        by_hand: Vec::new(),
        curves: group.curves(&[0.0; SIZES], &[]),
    };
    if !enough {
        return not_assessed(NotAssessed::TooFewReadings, mistakes, &data);
    }
    let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
        let mut stream = Stream::new(options.seed, &["torque draw", &k.to_string()]);
        Box::new(move || stream.normal())
    };
    let mut aside = 0;
    loop {
        let library = library::terms(&data);
        let problem = TorqueProblem::new(&data, &library).with_reference();
        let searched = searched(&problem, group, decision(options), &normal);
        if !searched.found.null.log_likelihood.is_finite() {
            return not_assessed(NotAssessed::NoConvergence, mistakes, &data);
        }
        let model = &searched.found.model;
        let odd = (aside < decisions::MOST_MISTAKEN_TESTS)
            .then(|| recording::furthest_off(&searched.setting, &problem, model));
        let Some((test, error)) = odd.flatten() else {
            let mut findings = unassessed(campaign, simulated, group, &data, options.draws);
            findings.recording_errors = mistakes;
            return answered(group, &problem, &searched, options, &normal, findings);
        };
        recording::without_what_it_explains(&mut mistakes, &error);
        mistakes.push(error);
        data = data.without(test);
        aside += 1;
    }
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
    let Searched { setting, found } = searched;
    let held = unseen::held_out(
        setting,
        problem,
        &group.held,
        found,
        decision(options),
        normal,
    );
    let work = Work {
        problem,
        setting,
        found,
        held: &held,
        smallest_nm: options.smallest_effect_nm,
        profiles: Profiles::new(setting, &found.model, normal),
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
    findings.noise = Some(variances.noise[class::TORQUE]);
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
