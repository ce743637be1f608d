//! The intervals of coefficients against closed forms, an independent implementation (`scripts/profiles.py`), and complete enumeration.

use pipeline::base::row::Row;
use pipeline::config::{FitOptions, IntervalMethod};
use pipeline::numerics::distributions::student_t_quantile;
use pipeline::numerics::real::{Dual, Real};
use pipeline::stages::fit::engine::{Equation, EquationFit, Symbol};

/// Rows with `x` as pressure and `y` as force; the specimens in turn.
fn rows(data: &[(f64, f64)], specimens: &[&str]) -> Vec<Row> {
    let row = |(k, (x, y)): (usize, &(f64, f64))| {
        let mut row = Row::blank();
        (row.pressure_kpa, row.force_n) = (*x, *y);
        row.specimen = specimens[k % specimens.len()].to_owned();
        row
    };
    data.iter().enumerate().map(row).collect()
}

fn fit<const N: usize>(
    rows: &[Row],
    start: [f64; N],
    model: &(dyn Fn(&Row, &[Dual<N>; N]) -> Dual<N> + Sync),
    refits: usize,
) -> EquationFit {
    fit_at(0.95, rows, start, model, refits)
}

fn fit_at<const N: usize>(
    confidence: f64,
    rows: &[Row],
    start: [f64; N],
    model: &(dyn Fn(&Row, &[Dual<N>; N]) -> Dual<N> + Sync),
    refits: usize,
) -> EquationFit {
    let free = Symbol {
        name: "c",
        unit: "1",
        bounds: (-1e3, 1e3),
        published: None,
    };
    let equation = Equation::<N> {
        id: "test",
        title: "test",
        unit: "1",
        symbols: [free; N],
        starts: vec![start],
        held: &|_| [None; N],
        observed: &|r| r.force_n,
        model,
    };
    let options = FitOptions {
        loss: "least_squares".to_owned(),
        bootstrap_refits: refits,
        confidence,
        ..FitOptions::default()
    };
    let rows: Vec<&Row> = rows.iter().collect();
    equation.fit(&rows, &options).unwrap()
}

fn ends(fit: &EquationFit, k: usize, method: IntervalMethod) -> (Option<f64>, Option<f64>) {
    let found = fit.coefficients[k]
        .intervals
        .iter()
        .find(|i| i.method == method);
    let interval = found.unwrap_or_else(|| panic!("no {method:?}"));
    (interval.low, interval.high)
}

fn assert_ends(found: (Option<f64>, Option<f64>), low: f64, high: f64, tolerance: f64) {
    let (a, b) = (found.0.unwrap(), found.1.unwrap());
    assert!((a / low - 1.0).abs() < tolerance, "{a} is not {low}");
    assert!((b / high - 1.0).abs() < tolerance, "{b} is not {high}");
}

const BOD: [(f64, f64); 6] = [
    (1.0, 8.3),
    (2.0, 10.3),
    (3.0, 19.0),
    (4.0, 16.0),
    (5.0, 15.6),
    (7.0, 19.8),
];

const PUROMYCIN: [(f64, f64); 12] = [
    (0.02, 76.0),
    (0.02, 47.0),
    (0.06, 97.0),
    (0.06, 107.0),
    (0.11, 123.0),
    (0.11, 139.0),
    (0.22, 159.0),
    (0.22, 152.0),
    (0.56, 191.0),
    (0.56, 201.0),
    (1.1, 207.0),
    (1.1, 200.0),
];

/// At 99% the profile of b never reaches the level above: that end is open, and is said so instead of being guessed.
#[test]
fn profiles_of_bod_and_an_open_end() {
    let model = |r: &Row, c: &[Dual<2>; 2]| -(c[0] * ((-(c[1] * r.pressure_kpa)).exp() - 1.0));
    let fit = fit(&rows(&BOD, &["a"]), [20.0, 0.5], &model, 0);
    let profile = IntervalMethod::Profile;
    assert_ends(ends(&fit, 0, profile), 14.049_364_16, 38.456_197_97, 1e-5);
    assert_ends(
        ends(&fit, 1, profile),
        0.131_397_746_7,
        1.808_169_594_7,
        1e-5,
    );
    let linearised = IntervalMethod::Linearised;
    assert_ends(ends(&fit, 0, linearised), 12.212_797_9, 26.072_352_7, 1e-6);
    let wide = fit_at(0.99, &rows(&BOD, &["a"]), [20.0, 0.5], &model, 0);
    assert_eq!(ends(&wide, 1, profile).1, None);
}

#[test]
fn profiles_of_puromycin() {
    let model = |r: &Row, c: &[Dual<2>; 2]| c[0] * r.pressure_kpa / (c[1] + r.pressure_kpa);
    let fit = fit(&rows(&PUROMYCIN, &["a"]), [200.0, 0.06], &model, 0);
    let profile = IntervalMethod::Profile;
    assert_ends(ends(&fit, 0, profile), 197.301_932_90, 229.289_055_06, 1e-5);
    assert_ends(ends(&fit, 1, profile), 0.046_920_342, 0.086_156_913, 1e-5);
}

/// Without curvature the profile is the linearised interval, exactly.
#[test]
fn the_profile_of_a_straight_line_is_its_linearised_interval() {
    let model = |r: &Row, c: &[Dual<2>; 2]| c[0] + c[1] * r.pressure_kpa;
    let fit = fit(&rows(&BOD, &["a", "b", "c"]), [1.0, 1.0], &model, 0);
    for k in 0..2 {
        let (low, high) = ends(&fit, k, IntervalMethod::Linearised);
        let profile = ends(&fit, k, IntervalMethod::Profile);
        assert_ends(profile, low.unwrap(), high.unwrap(), 1e-5);
    }
}

/// The mean of three specimens with one value each: the jackknife is Student's interval of a mean, and the 27 equally likely draws give the
/// percentiles.
#[test]
fn a_mean_of_three_specimens_by_closed_form_and_by_enumeration() {
    let values = [10.0, 11.0, 15.0];
    let data = values.map(|y| (1.0, y));
    let model = |_: &Row, c: &[Dual<1>; 1]| c[0];
    let fit = fit(&rows(&data, &["a", "b", "c"]), [1.0], &model, 20_000);
    let deviations: f64 = values.iter().map(|y| (y - 12.0) * (y - 12.0)).sum();
    let half = student_t_quantile(0.975, 2.0) * (deviations / 2.0 / 3.0).sqrt();
    let jackknife = ends(&fit, 0, IntervalMethod::Jackknife);
    assert_ends(jackknife, 12.0 - half, 12.0 + half, 1e-9);
    // One draw in 27 is (a, a, a) and one is (c, c, c): both beyond the 2.5% at either end.
    assert_ends(ends(&fit, 0, IntervalMethod::Bootstrap), 10.0, 15.0, 1e-9);
}

/// Tenfold readings of the same specimens say nothing new of specimens, though they narrow what counts readings.
#[test]
fn copies_of_readings_narrow_no_interval_that_goes_by_specimen() {
    let data: Vec<(f64, f64)> = (0..12)
        .map(|k| {
            (
                f64::from(k),
                3.0 + 0.5 * f64::from(k) + f64::from(k * k % 5),
            )
        })
        .collect();
    let once = rows(&data, &["a", "b", "c", "d"]);
    let tenfold: Vec<Row> = once.iter().flat_map(|r| vec![r.clone(); 10]).collect();
    let model = |r: &Row, c: &[Dual<2>; 2]| c[0] + c[1] * r.pressure_kpa;
    let (one, ten) = (
        fit(&once, [1.0, 1.0], &model, 500),
        fit(&tenfold, [1.0, 1.0], &model, 500),
    );
    for k in 0..2 {
        for method in [IntervalMethod::Jackknife, IntervalMethod::Bootstrap] {
            let (low, high) = ends(&one, k, method);
            assert_ends(ends(&ten, k, method), low.unwrap(), high.unwrap(), 1e-6);
        }
        let width = |fit: &EquationFit| {
            let (low, high) = ends(fit, k, IntervalMethod::Linearised);
            high.unwrap() - low.unwrap()
        };
        assert!(width(&ten) < 0.35 * width(&one));
    }
}

#[test]
fn below_three_specimens_nothing_goes_by_specimen() {
    let model = |r: &Row, c: &[Dual<2>; 2]| c[0] + c[1] * r.pressure_kpa;
    let fit = fit(&rows(&BOD, &["a", "b"]), [1.0, 1.0], &model, 100);
    let methods: Vec<IntervalMethod> = fit.coefficients[0]
        .intervals
        .iter()
        .map(|i| i.method)
        .collect();
    assert_eq!(
        methods,
        [IntervalMethod::Profile, IntervalMethod::Linearised]
    );
    assert_eq!(fit.ci_method, "linearised");
}
