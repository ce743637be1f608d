//! Derivatives, the common misfit, and the ends of the domains of published laws.

use super::ForceProblem;
use super::directions::cosine;
use super::forward::{CONTRACTED, REST, SLOTS};
use super::misfit::common_pairs;
use crate::base::Base;
use crate::data::Data;
use crate::library::{Column, Scope, What};
use crate::slack::Side;
use pipeline_inference::problem::Problem;

use crate::library;
use pipeline_config::FitOptions;
use pipeline_numerics::matrix::{Matrix, norm};
use pipeline_numerics::qr::PivotedQr;
use pipeline_simulate::rig_like;

#[test]
fn derivatives_by_the_lengths_of_a_specimen_are_those_of_other_conditions() {
    let rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
    let rows: Vec<&_> = rows.iter().collect();
    let data = Data::new(&rows);
    let library = library::terms(&data);
    let base = Base::new(10, true, 2, &FitOptions::default());
    let problem = ForceProblem::new(&base, &data, &library);
    let frame = library
        .iter()
        .position(|t| t.scope == Scope::All && t.is_frame());
    let frame = frame.unwrap();
    let mut point = problem.start();
    point.terms.push((frame, library[frame].start(20.0)));
    let step = 1e-5;
    for i in (0..data.len()).filter(|i| problem.side[*i] != Side::Corner) {
        let (_, gradient, _) = problem.derivatives::<SLOTS>(&point, i);
        let value = |rest: f64, contracted: f64| {
            let mut at = data.conditions[i];
            at.rest_length_m += rest;
            at.contracted_length_m += contracted;
            problem.value(&point, i, &at)
        };
        let rest = value(step, 0.0) - value(-step, 0.0);
        let contracted = value(0.0, step) - value(0.0, -step);
        for (slot, difference) in [(REST, rest), (CONTRACTED, contracted)] {
            let slope = difference / (2e3 * step);
            assert!(
                (gradient[slot] - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                "{i} {slot}: {} {slope}",
                gradient[slot]
            );
        }
    }
}

#[test]
fn what_a_column_may_be_beside_its_polynomial_has_a_bump() {
    let rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
    let rows: Vec<&_> = rows.iter().collect();
    let data = Data::new(&rows);
    let library = library::terms(&data);
    let base = Base::new(10, true, 4, &FitOptions::default());
    let problem = ForceProblem::new(&base, &data, &library);
    let humidity = data.extras.iter().position(|e| e.name == "humidity");
    let offset = Column::Offset(humidity.unwrap());
    let place = |column: Column| library.iter().position(|t| t.what == What::Column(column));
    let mut point = problem.start();
    let offset_term = place(offset).unwrap();
    point.terms.push((offset_term, vec![1.0, 0.0]));
    let columns = problem.bends(&point, offset_term);
    // The share of a bump's variance that columns leave, and that a parabola leaves of it.
    let along = &data.extras[humidity.unwrap()].values;
    let bump: Vec<f64> = along.iter().map(|x| libm::exp(-8.0 * x * x)).collect();
    let left = |columns: Vec<Vec<f64>>| {
        let mut all = Matrix::zeros(along.len(), columns.len() + 1);
        all.column_mut(0).fill(1.0);
        for (k, column) in columns.iter().enumerate() {
            all.column_mut(k + 1)
                .copy_from_slice(&column[..along.len()]);
        }
        let factor = PivotedQr::new(all);
        let mut rest = bump.clone();
        factor.apply_q_transposed(&mut rest);
        let rank = factor.rank(factor.default_tolerance());
        norm(&rest[rank..]) / norm(&bump)
    };
    let squares = along.iter().map(|x| x * x).collect();
    assert!(left(vec![along.clone(), squares]) > 0.3);
    assert!(left(columns) < 0.1);
    // The channels of force and pressure are part of the law, not columns beside it.
    let force = place(Column::Force).unwrap();
    point.terms = vec![(force, vec![0.1, 0.0])];
    assert!(problem.bends(&point, force).is_empty());
}

#[test]
fn the_common_misfit_is_nothing_that_the_law_could_be() {
    let rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
    let rows: Vec<&_> = rows.iter().collect();
    let data = Data::new(&rows);
    let base = Base::new(10, true, 4, &FitOptions::default());
    let problem = ForceProblem::new(&base, &data, &[]).with_reference();
    let scaled = |column: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let of = |i: usize| match problem.misfit_scale(i) {
            scale if scale > 0.0 => column(i) / scale,
            _ => 0.0,
        };
        (0..data.len()).map(of).collect()
    };
    assert_eq!(problem.slopes.len(), 5);
    let mut largest = 0.0_f64;
    for c in 0..common_pairs().count() {
        let misfit = scaled(&|i| problem.common_misfit[i][c]);
        for slope in &problem.slopes {
            let law = scaled(&|i| slope[i]);
            assert!(cosine(&law, &misfit).abs() < 1e-9, "{c}");
        }
        largest = largest.max(norm(&misfit));
    }
    // The cosines themselves are of the order of one at each reading.
    assert!(largest > 0.1 * (data.len() as f64).sqrt(), "{largest}");
}

#[test]
fn what_is_known_of_the_law_is_one_reading_a_coefficient_in_standard_deviations() {
    let rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
    let rows: Vec<&_> = rows.iter().collect();
    let data = Data::new(&rows);
    let base = Base::new(10, true, 4, &FitOptions::default());
    let problem = ForceProblem::new(&base, &data, &[]);
    let n = data.len();
    // 1/b2, c1 and c2; of b1 and c0 nothing is known.
    assert_eq!(problem.observed().len(), n + 3);
    let mut point = problem.start();
    let usual = problem.predict(&point)[n..].to_vec();
    assert_eq!(usual, problem.observed()[n..]);
    // One standard deviation more of c1, half of its published value.
    point.coefficients[3] += 0.5 * 4.254;
    let linear = problem.linearise(&point);
    let changes = linear.predicted[n..].iter().zip(&usual);
    let changes: Vec<f64> = changes.map(|(a, b)| a - b).collect();
    for (change, expected) in changes.iter().zip([0.0, 1.0, 0.0]) {
        assert!((change - expected).abs() < 1e-12, "{changes:?}");
    }
    assert!((linear.by_coefficients[3][n + 1] - 1.0 / 2.127).abs() < 1e-12);
    assert!(linear.random[n..].iter().flatten().all(|z| *z == 0.0));
    // Where the law with its dependence on the length is compared with that without, nothing is known of it in either, so that likelihoods compare.
    for other in base.with_and_without_length_law().unwrap() {
        let problem = ForceProblem::new(&other, &data, &[]);
        assert_eq!(problem.observed().len(), n + 2);
        assert_eq!(problem.observed()[n..], usual[1..]);
    }
    for base in [
        Base::new(10, false, 4, &FitOptions::default()),
        Base::published("festo_tool", true).unwrap(),
    ] {
        let problem = ForceProblem::new(&base, &data, &[]);
        assert_eq!(problem.observed().len(), n, "{}", base.id);
    }
}

/// At no contraction a resting length that is a little shorter is outside what Hunt's model describes.
#[test]
fn at_the_end_of_the_domain_of_a_published_law_all_derivatives_are_finite() {
    let settings = rig_like::Settings {
        specimens: Some(4),
        ..rig_like::Settings::default()
    };
    let rows = rig_like::campaign(9000, &settings).rows;
    let rows: Vec<&_> = rows.iter().collect();
    let data = Data::new(&rows);
    for model in ["hunt2017", "festo_tool"] {
        let base = Base::published(model, true).unwrap();
        let problem = ForceProblem::new(&base, &data, &[]).with_reference();
        let mut point = problem.start();
        // Among them 0.1 mm more than the set length, which stretches an actuator at no contraction.
        point.random.fill(0.1);
        let linear = problem.linearise(&point);
        let random = linear.random.iter().flatten();
        let all = random.chain(&linear.predicted);
        assert!(all.copied().all(f64::is_finite), "{model}");
    }
}
