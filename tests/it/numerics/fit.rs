//! The fitter on problems whose answer is known: minima, bounds, losses, and what it says of parameters and failures.

use pipeline::numerics::dual_problem::DualProblem;
use pipeline::numerics::fit::{Fit, Options, ParameterState, Status, fit, fit_multi_start};
use pipeline::numerics::levenberg_marquardt::LeastSquaresProblem;
use pipeline::numerics::loss::Loss;
use pipeline::numerics::matrix::Matrix;
use pipeline::numerics::real::{Dual, Real};

/// Rosenbrock's valley, with the sign of the Jacobian to choose: a model may be wrong about its derivatives.
struct Rosenbrock {
    sign: f64,
}

impl LeastSquaresProblem for Rosenbrock {
    fn parameters(&self) -> usize {
        2
    }
    fn observations(&self) -> usize {
        2
    }
    fn residuals(&self, p: &[f64], r: &mut [f64]) {
        r[0] = -10.0 * (p[1] - p[0] * p[0]);
        r[1] = 1.0 - p[0];
    }
    fn jacobian(&self, p: &[f64], j: &mut Matrix) {
        j[(0, 0)] = self.sign * -20.0 * p[0];
        j[(0, 1)] = self.sign * 10.0;
        j[(1, 0)] = self.sign;
        j[(1, 1)] = 0.0;
    }
}

fn bounded(bounds: &[(f64, f64)]) -> Options {
    Options {
        bounds: Some(bounds.to_vec()),
        ..Options::default()
    }
}

fn with_loss(loss: Loss) -> Options {
    Options {
        loss,
        ..Options::default()
    }
}

/// 20 rows of `3 + 0.5 x` with a small ripple.
fn ripple_line() -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..20).map(f64::from).collect();
    let y = x.iter().map(|x| 3.0 + 0.5 * x + 0.05 * libm::sin(7.0 * x));
    (x.clone(), y.collect())
}

fn fit_line(x: &[f64], y: &[f64], start: &[f64], options: &Options) -> Fit {
    let line = |i: usize, p: &[Dual<2>; 2]| p[0] + p[1] * x[i];
    fit(&DualProblem::new(y, line), start, options)
}

#[test]
fn rosenbrocks_valley_is_followed_to_its_end() {
    let found = fit(&Rosenbrock { sign: 1.0 }, &[-1.2, 0.5], &Options::default());
    assert_eq!(found.status, Status::Converged);
    assert_eq!(found.states, [ParameterState::Ok; 2]);
    assert!(found.parameters.iter().all(|p| (p - 1.0).abs() < 1e-15));
    assert!(found.scale.is_nan(), "two rows leave no degree of freedom");
}

#[test]
fn wrong_derivatives_stall_and_are_not_called_converged() {
    let found = fit(
        &Rosenbrock { sign: -1.0 },
        &[-1.2, 1.0],
        &Options::default(),
    );
    assert_eq!(found.status, Status::Stalled);
    assert_eq!(found.states, [ParameterState::Unmoved; 2]);
}

#[test]
fn too_few_iterations_are_said_so() {
    let options = Options {
        max_iterations: 1,
        ..Options::default()
    };
    let found = fit(&Rosenbrock { sign: 1.0 }, &[-1.2, 1.0], &options);
    assert_eq!(found.status, Status::MaxIterations);
}

#[test]
fn a_straight_line_has_the_textbook_errors() {
    let (x, y) = ripple_line();
    let found = fit_line(&x, &y, &[0.0, 0.0], &Options::default());
    let centre = x.iter().sum::<f64>() / 20.0;
    let spread: f64 = x.iter().map(|x| (x - centre) * (x - centre)).sum();
    let error = (found.sse / 18.0 / spread).sqrt();
    assert!((found.standard_errors()[1] / error - 1.0).abs() < 1e-13);
}

/// The model panics outside the box, so no trial point was ever there.
#[test]
fn bounds_are_respected_at_every_step_and_said_so() {
    let x: Vec<f64> = (0..15).map(|i| f64::from(i) / 5.0).collect();
    let y: Vec<f64> = x.iter().map(|x| 2.0 * libm::exp(-1.3 * x) + 0.4).collect();
    let model = |i: usize, p: &[Dual<3>; 3]| {
        assert!((0.0..=5.0).contains(&p[0].value) && (0.1..=1.0).contains(&p[1].value));
        p[0] * (-(p[1] * x[i])).exp() + p[2]
    };
    let box_of = bounded(&[(0.0, 5.0), (0.1, 1.0), (f64::NEG_INFINITY, f64::INFINITY)]);
    for start in [[4.0, 0.2, 0.0], [0.0, 1.0, 3.0], [9.0, -3.0, 0.0]] {
        let found = fit(&DualProblem::new(&y, model), &start, &box_of);
        assert_eq!(found.status, Status::Converged, "{start:?}");
        assert_eq!(found.parameters[1], 1.0);
        assert_eq!(found.states[1], ParameterState::AtUpperBound);
        assert!(found.standard_errors()[1].is_nan() && found.standard_errors()[0] > 0.0);
        let held = DualProblem::new(&y, model).with_held([None, Some(1.0), None]);
        let expected = fit(&held, &[1.0, 0.0], &Options::default());
        assert!((found.parameters[0] - expected.parameters[0]).abs() < 1e-12);
        assert!((found.parameters[2] - expected.parameters[1]).abs() < 1e-12);
        let push = found.jacobian.transpose_multiply(&found.residuals);
        assert!(push[1] > 0.0, "the data push outwards");
    }
}

#[test]
fn a_bound_that_does_not_bind_changes_nothing_and_a_lower_one_is_named() {
    let (x, y) = ripple_line();
    let free = fit_line(&x, &y, &[0.0, 0.0], &Options::default());
    let wide = fit_line(&x, &y, &[0.0, 0.0], &bounded(&[(-9.0, 9.0), (-9.0, 9.0)]));
    for (a, b) in free.parameters.iter().zip(&wide.parameters) {
        assert!((a - b).abs() < 1e-13);
    }
    let narrow = fit_line(&x, &y, &[5.0, 0.0], &bounded(&[(4.0, 9.0), (-9.0, 9.0)]));
    assert_eq!(
        narrow.states,
        [ParameterState::AtLowerBound, ParameterState::Ok]
    );
}

#[test]
fn robust_losses_resist_outliers() {
    let (x, mut y) = ripple_line();
    let clean = fit_line(&x, &y, &[0.0, 0.0], &Options::default());
    y[3] += 40.0;
    y[17] += 25.0;
    let error = |found: &Fit| (found.parameters[1] - clean.parameters[1]).abs();
    let fooled = fit_line(&x, &y, &[0.0, 0.0], &Options::default());
    assert!(error(&fooled) > 0.1);
    for loss in &Loss::ALL[1..] {
        let found = fit_line(&x, &y, &[0.0, 0.0], &with_loss(*loss));
        assert_eq!(found.status, Status::Converged, "{loss}");
        assert!(error(&found) < 0.01, "{loss}: {:?}", found.parameters);
        assert!(found.passes > 0 && found.scale < 0.2 && found.weights[3] < 0.05);
    }
}

#[test]
fn a_given_scale_is_used_as_it_is() {
    let (x, y) = ripple_line();
    let options = Options {
        scale: Some(1e3),
        ..with_loss(Loss::Huber { k: 1.345 })
    };
    let found = fit_line(&x, &y, &[0.0, 0.0], &options);
    assert_eq!(found.scale, 1e3);
    assert_eq!(found.weights, [1.0; 20]);
}

#[test]
fn parameters_that_the_data_do_not_determine_are_named() {
    let (x, y) = ripple_line();
    // Only the product of the first two matters; the fourth does not occur at all.
    let model = |i: usize, p: &[Dual<4>; 4]| p[0] * p[1] + p[2] * x[i];
    let start = [1.0, 2.0, 0.0, 7.0];
    let found = fit(&DualProblem::new(&y, model), &start, &Options::default());
    let parameters = vec![0, 1, 3];
    assert_eq!(found.status, Status::Singular { parameters });
    assert_eq!(found.states[2], ParameterState::Ok);
    assert_eq!(found.states[3], ParameterState::NotIdentified);
    assert_eq!(found.parameters[3], 7.0);
    let line = fit_line(&x, &y, &[0.0, 0.0], &Options::default());
    assert!((found.parameters[0] * found.parameters[1] - line.parameters[0]).abs() < 1e-12);
    let errors = found.standard_errors();
    assert!(errors[0].is_nan() && errors[3].is_nan() && errors[2].is_finite());
}

#[test]
fn a_parameter_whose_rows_the_loss_gave_up_is_not_identified() {
    let (_, mut y) = ripple_line();
    (y[18], y[19]) = (-1e6, 1e6);
    let step = |i: usize, p: &[Dual<2>; 2]| p[0] + p[1] * if i >= 18 { 1.0 } else { 0.0 };
    let bisquare = with_loss(Loss::Bisquare { k: 4.685 });
    let found = fit(&DualProblem::new(&y, step), &[0.0, 1.0], &bisquare);
    assert_eq!(found.weights[18..], [0.0, 0.0]);
    assert_eq!(
        found.states,
        [ParameterState::Ok, ParameterState::NotIdentified]
    );
    assert_eq!(
        found.status,
        Status::Singular {
            parameters: vec![1]
        }
    );
    assert!(found.standard_errors()[1].is_nan());
}

#[test]
fn a_step_to_where_the_model_is_undefined_is_rejected() {
    let x = [0.5, 1.0, 2.0, 3.0, 5.0];
    let y = x.map(|x| libm::log(1e-3 + x));
    // Undefined for p <= -0.5, where the first full step from 30 leads.
    let model = |i: usize, p: &[Dual<1>; 1]| (p[0] + x[i]).ln();
    let found = fit(&DualProblem::new(&y, model), &[30.0], &Options::default());
    assert_eq!(found.status, Status::Converged);
    assert!((found.parameters[0] - 1e-3).abs() < 1e-14);
    let nowhere = fit(&DualProblem::new(&y, model), &[-1.0], &Options::default());
    assert_eq!(nowhere.status, Status::NotFinite);
    assert_eq!(nowhere.parameters, [-1.0]);
}

#[test]
fn a_perfect_start_is_unmoved() {
    let x = [0.0, 1.0, 2.0];
    let found = fit_line(&x, &[1.0, 3.0, 5.0], &[1.0, 2.0], &with_loss(Loss::Lar));
    assert_eq!(found.status, Status::Converged);
    assert_eq!(found.states, [ParameterState::Unmoved; 2]);
    assert_eq!(found.sse, 0.0);
}

#[test]
fn without_rows_nothing_is_determined() {
    let found = fit_line(&[], &[], &[1.0, 2.0], &Options::default());
    let parameters = vec![0, 1];
    assert_eq!(found.status, Status::Singular { parameters });
}

#[test]
fn the_best_of_many_starts_wins() {
    let x: Vec<f64> = (0..60).map(|i| f64::from(i) / 6.0).collect();
    let y: Vec<f64> = x.iter().map(|x| libm::sin(2.0 * x)).collect();
    let wave = |i: usize, p: &[Dual<1>; 1]| (p[0] * x[i]).sin();
    let problem = DualProblem::new(&y, wave);
    let alone = fit(&problem, &[4.0], &Options::default());
    assert!(alone.sse > 1.0, "a local minimum");
    let starts: Vec<Vec<f64>> = [4.0, 3.0, 2.1, 1.0].map(|f| vec![f]).to_vec();
    let best = fit_multi_start(&problem, &starts, &with_loss(Loss::Lar)).unwrap();
    assert!((best.parameters[0] - 2.0).abs() < 1e-12);
    assert!(fit_multi_start(&problem, &[], &Options::default()).is_none());
}
