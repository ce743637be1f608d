//! Mistakes of recording: torques of the sign that the route does not give, and single tests that the model fitted without them makes too
//! improbable.
//!
//! How far off a test is, is one number: the root mean square of its errors in units of their standard deviations, by the model without it. A
//! test that is merely mounted 1 mm off where others scatter by 1 mm is about 1 off. How much tests scatter is known from the other tests alone, so that
//! Student's t with their number judges it.

use super::by_test;
use super::data::{Data, Reading};
use super::mistakes;
use super::problem::TorqueProblem;
use super::settings;
use super::terms::SIZES;
use pipeline_findings::{ErrorKind, Level, RecordingError};
use pipeline_inference::decisions::{EXPLAINS, FEWEST, LEVEL};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::heldout::Unseen;
use pipeline_numerics::distributions::student_t_two_sided;
use pipeline_numerics::statistics::{mean, median, standard_deviation};
use rayon::prelude::*;

/// The tests of which most torques have the sign that the route does not give. Flexion is negative; where all are, `muscle` may be wrong.
pub fn wrong_signs(data: &Data) -> Vec<RecordingError> {
    let rigid = |r: &Reading| r.shown(&[0.0; SIZES]).map_or(0.0, |s| s.torque);
    let one = |own: &[Reading]| {
        let other = own.iter().filter(|r| r.torque_nm * rigid(r) < 0.0).count();
        let off = |sign: f64| -> f64 {
            let squares: Vec<f64> = own
                .iter()
                .map(|r| sign * r.torque_nm - rigid(r))
                .map(|e| e * e)
                .collect();
            mean(&squares).sqrt()
        };
        (2 * other > own.len()).then(|| RecordingError {
            group: data.tests[own[0].test].to_owned(),
            level: Level::Test,
            kind: ErrorKind::Sign,
            quantity: Some("torque_nm".to_owned()),
            value: None,
            unit: "N.m".to_owned(),
            p: None,
            rms: off(1.0),
            rms_corrected: Some(off(-1.0)),
            set_aside: false,
        })
    };
    data.readings
        .chunk_by(|a, b| a.test == b.test)
        .filter_map(one)
        .collect()
}

/// Tests whose lengths or arms by hand are, on average, too far from those of the drawing beside the other tests, and the data without what was
/// taken by hand in these.
pub fn without_odd_hands(data: &mut Data) -> Vec<RecordingError> {
    let mut errors = Vec::new();
    for (quantity, is_arm) in [("muscle_length", false), ("moment_arm", true)] {
        let tests = misses_by_hand(data, is_arm);
        let Some((k, by, p)) = oddest(&tests) else {
            continue;
        };
        let (test, misses) = &tests[k];
        let rms = |less: f64| {
            mean(
                &misses
                    .iter()
                    .map(|m| (m - less) * (m - less))
                    .collect::<Vec<f64>>(),
            )
            .sqrt()
        };
        errors.push(RecordingError {
            group: data.tests[*test].to_owned(),
            level: Level::Test,
            kind: ErrorKind::Length,
            quantity: Some(quantity.to_owned()),
            value: Some(-by),
            unit: "mm".to_owned(),
            p: Some(p),
            rms: rms(0.0),
            rms_corrected: Some(rms(by)),
            set_aside: true,
        });
        for r in data.readings.iter_mut().filter(|r| r.test == *test) {
            match is_arm {
                true => r.by_hand.arm_m = None,
                false => r.by_hand.length_m = None,
            }
        }
    }
    errors
}

/// By test, lengths or arms by hand less those of the drawing, mm; tests without any have no entry.
fn misses_by_hand(data: &Data, is_arm: bool) -> Vec<(usize, Vec<f64>)> {
    let miss = |r: &Reading| {
        let drawn = r.shown(&[0.0; SIZES])?;
        let of = |measured: Option<f64>, drawn: f64| Some(1e3 * (measured? - drawn));
        match is_arm {
            true => of(r.by_hand.arm_m, drawn.arm.abs() * r.by_hand.arm_m?.signum()),
            false => of(r.by_hand.length_m, drawn.length),
        }
    };
    let of_test = |own: &[Reading]| {
        let misses: Vec<f64> = own.iter().filter_map(miss).collect();
        (!misses.is_empty()).then(|| (own[0].test, misses))
    };
    data.readings
        .chunk_by(|a, b| a.test == b.test)
        .filter_map(of_test)
        .collect()
}

/// The entry that is, on average, too far from the others, by how much, mm, and with which probability; none with too few others.
fn oddest(tests: &[(usize, Vec<f64>)]) -> Option<(usize, f64, f64)> {
    if tests.len() <= FEWEST {
        return None;
    }
    let off = |k: usize| {
        let others = tests.iter().enumerate().filter(|(j, _)| *j != k);
        let others: Vec<f64> = others.map(|(_, (_, m))| mean(m)).collect();
        let sd = standard_deviation(&others).max(settings::USUAL_BIAS_MM);
        let by = mean(&tests[k].1) - mean(&others);
        let count = others.len() as f64;
        let t = by / (sd * (1.0 + 1.0 / count).sqrt());
        let p = student_t_two_sided(t, count - 1.0) * tests.len() as f64;
        (k, by, p.min(1.0))
    };
    let worst = (0..tests.len()).map(off).min_by(|a, b| a.2.total_cmp(&b.2));
    worst.filter(|(_, _, p)| *p < LEVEL)
}

/// The test that is furthest off, if it is too improbable beside the others; its number.
pub fn furthest_off(
    setting: &Setting,
    problem: &TorqueProblem,
    model: &Fitted,
) -> Option<(usize, RecordingError)> {
    let tests: Vec<(usize, usize)> = problem
        .tests
        .iter()
        .enumerate()
        .filter_map(|(test, node)| Some((test, (*node)?)))
        .filter(|(_, node)| setting.active[*node])
        .collect();
    if tests.len() <= FEWEST {
        return None;
    }
    let off = |(test, node): &(usize, usize)| {
        let rest = setting.without(*node);
        let fitted = rest.fit(
            &model.cleared(&rest),
            std::slice::from_ref(&model.variances),
        );
        let unseen = Unseen::new(&rest, &fitted);
        let predicted = unseen.predict_where(*node, |i| problem.is_torque(i));
        let pairs = predicted.errors.iter().zip(&predicted.sd);
        let squares: Vec<f64> = pairs.map(|(e, sd)| e / sd).map(|u| u * u).collect();
        (*test, mean(&squares).sqrt(), problem.sizes(&fitted.point))
    };
    let all: Vec<(usize, f64, [f64; SIZES])> = tests.par_iter().map(off).collect();
    let (test, off, sizes) = all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let others = tests.len() as f64 - 1.0;
    let p = (student_t_two_sided(off, others - 1.0) * tests.len() as f64).min(1.0);
    if p > LEVEL {
        return None;
    }
    let of = |t: usize| -> Vec<Reading> {
        let all = problem.data.readings.iter();
        all.filter(|r| r.test == t).copied().collect()
    };
    let left: Vec<f64> = tests
        .iter()
        .filter(|(t, _)| *t != test)
        .filter_map(|(t, _)| Some(by_test::with_own_offset(&sizes, &of(*t)).1?.rmse))
        .collect();
    let own = of(test);
    let taken = mistakes::explanation(&own, &sizes, median(&left));
    let error = RecordingError {
        group: problem.data.tests[test].to_owned(),
        level: Level::Test,
        kind: taken.as_ref().map_or(ErrorKind::Outlier, |t| t.kind),
        quantity: taken.as_ref().map(|t| t.quantity.to_owned()),
        value: taken.as_ref().map(|t| t.value),
        unit: taken.as_ref().map_or("", |t| t.unit).to_owned(),
        p: Some(p),
        rms: by_test::size(&own, &sizes).map_or(f64::NAN, |s| s.rmse),
        rms_corrected: taken.map(|t| t.rms),
        set_aside: true,
    };
    Some((test, error))
}

/// Lengths by hand that were called odd because the test is mounted elsewhere than noted are right: one mistake is named, not two.
pub fn without_what_it_explains(errors: &mut Vec<RecordingError>, mounted: &RecordingError) {
    let of = |e: &RecordingError, quantity: &str| {
        e.value.filter(|_| e.quantity.as_deref() == Some(quantity))
    };
    let Some(by) = of(mounted, "mounting_length") else {
        return;
    };
    errors.retain(|e| {
        let odd = of(e, "muscle_length").filter(|_| e.group == mounted.group);
        odd.is_none_or(|odd| (odd - by).abs() > EXPLAINS * settings::USUAL_BIAS_MM)
    });
}
