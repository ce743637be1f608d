//! Derivatives, fixed points of fits, and what is found, on simulated readings of three actuators.

use super::{TorqueProblem, component};
use crate::build::Build;
use crate::diagnose::data::{Data, Reading};
use crate::diagnose::operator::{At, Joint};
use crate::diagnose::terms::{SIZES, place};
use crate::diagnose::{library, recording};
use crate::point::ByHand;
use pipeline_base::random::Stream;
use pipeline_config::FitOptions;
use pipeline_diagnose::base::Base;
use pipeline_diagnose::slack::Side;
use pipeline_inference::decisions;
use pipeline_inference::fit::{Free, Setting};
use pipeline_inference::problem::Problem;
use pipeline_inference::search::{Decision, Found, Search};
use pipeline_mechanics::knee::{Setup, choice::named};
use std::collections::BTreeMap;

const TESTS: [&str; 6] = ["a1", "a2", "b1", "b2", "c1", "c2"];

fn builds() -> Vec<Build> {
    let build = |(rest, contracted): (f64, f64)| Build {
        knee: named("pinned").unwrap(),
        route: "flexor".to_owned(),
        setup: Setup {
            diameter_mm: 10.0,
            rest_length_m: rest,
            contracted_length_m: contracted,
            fitting_m: 0.0352,
            tendon_m: 0.485 - rest,
        },
        remarks: Vec::new(),
    };
    [(0.485, 0.398), (0.457, 0.375), (0.43, 0.353)]
        .map(build)
        .to_vec()
}

/// Six tests of three actuators with these sizes; every test is mounted differently, and lengths and arms are taken by hand.
fn readings<'a>(
    builds: &'a [Build],
    law: &'a Base,
    none: &'a BTreeMap<String, f64>,
    sizes: &[f64; SIZES],
) -> Vec<Reading<'a>> {
    let mut stream = Stream::new(3, &["unit", "torque"]);
    let mut all = Vec::new();
    for test in 0..TESTS.len() {
        let joint = Joint::new(&builds[test / 2], law);
        let mut own = *sizes;
        own[place::LENGTH] += 1.5 * stream.normal();
        for k in 0..14 {
            let degrees = -100.0 + 6.5 * f64::from(k) + 2.0 * stream.uniform();
            let at = At::still(degrees.to_radians(), 600.0 + 5.0 * stream.normal());
            let shown = joint.seen(&at, &own).unwrap();
            let mut off = |sd: f64| sd * stream.normal();
            all.push(Reading {
                joint,
                at,
                side: Side::Pulls,
                torque_nm: shown.torque + off(0.2),
                by_hand: ByHand {
                    length_m: Some(shown.length + off(0.004)),
                    contraction_rel: None,
                    arm_m: Some(shown.arm + off(0.005)),
                    length_sd_m: None,
                    arm_sd_m: None,
                },
                actuator: test / 2,
                test,
                order: f64::from(k) / 13.0,
                source: ("log.csv", i64::from(k) + 2),
                extras: none,
            });
        }
    }
    all
}

fn data(readings: Vec<Reading>) -> Data {
    Data::new(readings, TESTS.to_vec(), vec!["a", "b", "c"])
}

fn law() -> Base {
    Base::new(10, false, 1, &FitOptions::default())
}

fn with(list: &[(usize, f64)]) -> [f64; SIZES] {
    let mut sizes = [0.0; SIZES];
    for (place, value) in list {
        sizes[*place] = *value;
    }
    sizes
}

fn found(problem: &TorqueProblem) -> Found {
    let setting = Setting::new(problem);
    let decision = Decision {
        level: decisions::LEVEL,
        draws: 59,
        alike: decisions::ALIKE,
        most_terms: 3,
        thorough: true,
    };
    let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
        let mut stream = Stream::new(1, &["unit draw", &k.to_string()]);
        Box::new(move || stream.normal())
    };
    let search = Search {
        setting: &setting,
        decision,
        tried: None,
    };
    search.run_exchanging(setting.fit_afresh(&problem.start()), &normal, None)
}

#[test]
fn derivatives_are_those_of_differences() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let data = data(readings(
        &builds,
        &law,
        &none,
        &with(&[(place::AXIAL, 60.0)]),
    ));
    let library = library::terms(&data);
    let problem = TorqueProblem::new(&data, &library).with_reference();
    for (t, term) in library.iter().enumerate() {
        let mut point = problem.start();
        // Somewhere off the origin, inside the bounds.
        let size = 0.05 * problem.terms()[t].bounds[0].1;
        point.terms.push((t, vec![size; term.values()]));
        for (k, b) in point.random.iter_mut().enumerate() {
            *b = 0.01 * (k % 7) as f64;
        }
        let linear = problem.linearise(&point);
        for (k, column) in linear.by_terms.iter().enumerate() {
            let step = 1e-4 * problem.terms()[t].bounds[k].1;
            let at = |sign: f64| {
                let mut moved = point.clone();
                moved.terms[0].1[k] += sign * step;
                problem.predict(&moved)
            };
            let (up, down) = (at(1.0), at(-1.0));
            let largest = column.iter().fold(1e-6, |m: f64, x| m.max(x.abs()));
            for (i, slope) in column.iter().enumerate() {
                let expected = (up[i] - down[i]) / (2.0 * step);
                assert!(
                    (slope - expected).abs() < 2e-3 * largest,
                    "{:?} {i}: {slope} {expected}",
                    library[t]
                );
            }
        }
    }
}

#[test]
fn fits_from_several_starts_agree() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let data = data(readings(&builds, &law, &none, &with(&[])));
    let library = library::terms(&data);
    let problem = TorqueProblem::new(&data, &library).with_reference();
    let setting = Setting::new(&problem);
    let best = setting.fit_afresh(&problem.start());
    for factor in [0.3, 3.0] {
        let other = Setting {
            start_factor: factor,
            ..setting.clone()
        };
        let fit = other.fit(&problem.start(), &other.fresh()[..1]);
        assert!(
            fit.log_likelihood < best.log_likelihood + 0.1,
            "{factor}: {} {}",
            fit.log_likelihood,
            best.log_likelihood
        );
        assert!(
            fit.log_likelihood > best.log_likelihood - 1.5,
            "{factor}: {} {}",
            fit.log_likelihood,
            best.log_likelihood
        );
    }
    let mounting = best.variances.components[component::MOUNTING];
    assert!((0.5..3.0).contains(&mounting), "{mounting}");
}

/// What a fit says of its likelihood is what a fit finds that starts there with the value held: a step that was refused is no convergence.
#[test]
fn a_fit_is_a_fixed_point() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let yields = with(&[(place::AXIAL, 60.0)]);
    let data = data(readings(&builds, &law, &none, &yields));
    let library = library::terms(&data);
    let problem = TorqueProblem::new(&data, &library).with_reference();
    let setting = Setting::new(&problem);
    let axial = library
        .iter()
        .position(|t| t.form().is_some_and(|f| f.first == place::AXIAL));
    for from in [1.0, 20.0, 60.0, 150.0] {
        let mut point = problem.start();
        point.terms.push((axial.unwrap(), vec![from]));
        let fit = setting.fit(&point, &setting.fresh());
        let mut held = setting.clone();
        held.pinned.push(Free::Value(0, 0));
        let again = held.fit(&fit.point, std::slice::from_ref(&fit.variances));
        let off = fit.log_likelihood - again.log_likelihood;
        assert!(off.abs() < 0.2, "from {from}: {off}");
        let found = fit.values(axial.unwrap()).unwrap()[0];
        assert!((found - 60.0).abs() < 10.0, "from {from}: {found}");
    }
}

#[test]
fn nothing_is_found_in_nothing_and_what_yields_where_it_does() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let nothing = data(readings(&builds, &law, &none, &with(&[])));
    let library = library::terms(&nothing);
    let problem = TorqueProblem::new(&nothing, &library).with_reference();
    assert_eq!(found(&problem).accepted, []);
    let yields = data(readings(
        &builds,
        &law,
        &none,
        &with(&[(place::AXIAL, 90.0)]),
    ));
    let problem = TorqueProblem::new(&yields, &library).with_reference();
    let found = found(&problem);
    let ids: Vec<&str> = found
        .accepted
        .iter()
        .map(|a| library[a.term].name(&yields))
        .collect();
    assert_eq!(ids, ["series_compliance"]);
}

#[test]
fn an_arm_that_is_measured_elsewhere_in_one_test_is_set_aside() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let mut all = readings(&builds, &law, &none, &with(&[]));
    for r in all.iter_mut().filter(|r| r.test == 4) {
        r.by_hand.arm_m = r.by_hand.arm_m.map(|a| a - 0.04);
    }
    let mut data = data(all);
    let errors = recording::without_odd_hands(&mut data);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(
        (errors[0].group.as_str(), errors[0].quantity.as_deref()),
        ("c1", Some("moment_arm"))
    );
    assert!(
        data.readings
            .iter()
            .all(|r| (r.test == 4) == r.by_hand.arm_m.is_none())
    );
}

#[test]
fn torques_of_the_other_sign_are_pointed_at() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let mut all = readings(&builds, &law, &none, &with(&[]));
    for r in all.iter_mut().filter(|r| r.test == 2) {
        r.torque_nm = -r.torque_nm;
    }
    let errors = recording::wrong_signs(&data(all));
    assert_eq!(
        errors.iter().map(|e| e.group.as_str()).collect::<Vec<_>>(),
        ["b1"]
    );
}
