//! Derivatives, fixed points of fits, and what is found, on simulated readings of three actuators.

use super::{TorqueProblem, component};
use crate::build::Build;
use crate::diagnose::data::{Data, Reading};
use crate::diagnose::fittings::LeastSquares;
use crate::diagnose::library::What;
use crate::diagnose::mistakes;
use crate::diagnose::operator::{At, Joint};
use crate::diagnose::terms::{SIZES, place};
use crate::diagnose::{library, recording};
use crate::point::ByHand;
use pipeline_base::random::Stream;
use pipeline_config::FitOptions;
use pipeline_diagnose::base::Base;
use pipeline_diagnose::slack::Side;
use pipeline_findings::ErrorKind;
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
        level: decisions::COMES_IN,
        draws: 199,
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
        point.terms.push((t, vec![size; term.values(&data)]));
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

/// What one test shows of itself with a mistake in it, and the mistake that is taken back.
fn taken_back(mistake: impl Fn(&mut Reading)) -> Option<mistakes::Taken> {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let mut own = readings(&builds, &law, &none, &with(&[]));
    own.retain(|r| r.test == 3);
    own.iter_mut().for_each(mistake);
    mistakes::explanation(&own, &with(&[]), 0.2)
}

#[test]
fn units_and_lengths_of_a_test_are_taken_back() {
    let factor = |quantity, value: f64, taken: Option<mistakes::Taken>| {
        let taken = taken.unwrap();
        assert_eq!((taken.kind, taken.quantity), (ErrorKind::Unit, quantity));
        assert!((taken.value / value - 1.0).abs() < 1e-3, "{taken:?}");
    };
    factor(
        "pressure",
        6.895,
        taken_back(|r| r.at.pressure_kpa /= 6.895),
    );
    factor(
        "pressure",
        100.0,
        taken_back(|r| r.at.pressure_kpa /= 100.0),
    );
    factor("torque", 1.356, taken_back(|r| r.torque_nm /= 1.356));
    factor("torque", 1e-3, taken_back(|r| r.torque_nm *= 1e3));
    // 20 mm more of a tendon, and a resting length noted 20 mm too long.
    let mounted = taken_back(|r| {
        let mut shown = with(&[]);
        shown[place::LENGTH] = 20.0;
        r.torque_nm += r.joint.seen(&r.at, &shown).unwrap().torque
            - r.joint.seen(&r.at, &with(&[])).unwrap().torque;
    });
    let mounted = mounted.unwrap();
    assert_eq!(mounted.quantity, "mounting_length");
    assert!((mounted.value - 20.0).abs() < 4.0, "{mounted:?}");
    let mut long = builds()[1].clone();
    long.setup.rest_length_m += 0.02;
    let law = law();
    let noted = Joint::new(&long, &law);
    let resting = {
        let (builds, none) = (builds(), BTreeMap::new());
        let mut own = readings(&builds, &law, &none, &with(&[]));
        own.retain(|r| r.test == 3);
        own.iter_mut().for_each(|r| r.joint = noted);
        mistakes::explanation(&own, &with(&[]), 0.2).unwrap()
    };
    assert_eq!(resting.quantity, "rest_length");
    assert!((resting.value + 20.0).abs() < 3.0, "{resting:?}");
    // Noise of ten times what is usual is none of them.
    let mut sign = 1.0;
    let (builds, none) = (self::builds(), BTreeMap::new());
    let mut noisy = readings(&builds, &law, &none, &with(&[]));
    noisy.retain(|r| r.test == 3);
    for r in &mut noisy {
        r.torque_nm += 2.0 * sign;
        sign = -sign;
    }
    assert_eq!(mistakes::explanation(&noisy, &with(&[]), 0.2), None);
}

#[test]
fn a_fitting_that_nothing_shows_has_no_standard_error() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    // One or both tests of an actuator with the sign of the other muscle: the length ends at its bound, or where nothing pulls.
    for flipped in [vec![0], vec![0, 1]] {
        let mut all = readings(&builds, &law, &none, &with(&[]));
        all.retain(|r| r.test < 2);
        for r in all.iter_mut().filter(|r| flipped.contains(&r.test)) {
            r.torque_nm *= -2.0;
        }
        let data = data(all).as_published();
        let offset = library::terms(&data)
            .into_iter()
            .find(|t| t.form().is_some_and(|f| f.first == place::LENGTH));
        let library: [What; 1] = [offset.unwrap()];
        let problem = TorqueProblem::least_squares(&data, &library);
        let length = LeastSquares::new(&Setting::new(&problem)).unwrap();
        let error = length.standard_error_m;
        assert!(error.is_nan(), "{flipped:?}: {error}, {}", length.fitting_m);
    }
}

/// The first reading of a test has friction in a sense that nobody knows: it must not be called a dependence on the order.
#[test]
fn friction_before_the_first_reading_is_neither_order_nor_noise() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let friction = with(&[(place::FRICTION, 0.8)]);
    let mut all = readings(&builds, &law, &none, &with(&[]));
    for own in all.chunk_by_mut(|a, b| a.test == b.test) {
        let count = own.len();
        for (k, r) in own.iter_mut().enumerate() {
            let sense = if 2 * k < count { 1.0 } else { -1.0 };
            r.at.sense = sense;
            let (with, without) = (
                r.joint.seen(&r.at, &friction),
                r.joint.seen(&r.at, &with(&[])),
            );
            r.torque_nm += with.unwrap().torque - without.unwrap().torque;
            if k == 0 {
                r.at.sense = 0.0;
            }
        }
    }
    let data = data(all);
    let library = library::terms(&data);
    let problem = TorqueProblem::new(&data, &library).with_reference();
    let found = found(&problem);
    let ids: Vec<&str> = found
        .accepted
        .iter()
        .map(|a| library[a.term].name(&data))
        .collect();
    assert_eq!(ids, ["joint_friction"]);
    let size = found.model.point.terms[0].1[0];
    assert!((size - 0.8).abs() < 0.1, "{size}");
}

/// Forces of a law whose coefficients are some percent from those of the published one are no effect of the joint.
#[test]
fn a_law_that_is_off_is_no_effect() {
    let (builds, law, none) = (builds(), law(), BTreeMap::new());
    let mut other = self::law();
    for (name, factor) in [("c0", 1.04), ("c1", 1.06), ("c2", 1.06)] {
        let coefficient = other.coefficients.iter_mut().find(|c| c.name == name);
        coefficient.unwrap().start *= factor;
    }
    let mut all = readings(&builds, &other, &none, &with(&[]));
    for r in &mut all {
        r.joint = Joint::new(&builds[r.actuator], &law);
    }
    let data = data(all);
    let library = library::terms(&data);
    let problem = TorqueProblem::new(&data, &library).with_reference();
    assert_eq!(found(&problem).accepted, []);
}
