//! LAR-compatible statistics of a force surface against the NumPy implementation in `tests/scripts/lar.py`.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use pipeline::numerics::dual_problem::DualProblem;
use pipeline::numerics::lar::{LarFit, LarOptions, Weighting, fit_lar};
use pipeline::numerics::real::{Dual, Real};

/// Hundreds of passes, hence made once.
static LAR: LazyLock<LarFit> = LazyLock::new(|| fit(Weighting::Lar));

const START: [f64; 3] = [0.2, 2.0, 1.0];

fn read(name: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/lar")
        .join(name);
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

/// F* = c0 (exp(-c1 e) - 1) + P exp(-c2 e^2).
fn surface<R: Real>(c: &[R; 3], e: f64, pressure: f64) -> R {
    c[0] * ((-(c[1] * e)).exp() - 1.0) + (-(c[2] * (e * e))).exp() * pressure
}

fn fit(weighting: Weighting) -> LarFit {
    let rows: Vec<[f64; 3]> = read("surface.csv")
        .iter()
        .map(|row| std::array::from_fn(|k| row[k].parse().unwrap()))
        .collect();
    let observed: Vec<f64> = rows.iter().map(|row| row[2]).collect();
    let model = |i: usize, c: &[Dual<3>; 3]| surface(c, rows[i][0], rows[i][1]);
    let options = LarOptions {
        weighting,
        ..LarOptions::default()
    };
    fit_lar(
        &DualProblem::new(&observed, model),
        &observed,
        &START,
        &options,
    )
    .unwrap()
}

fn statistic(fit: &LarFit, name: &str) -> f64 {
    let index = || name[name.len() - 1..].parse::<usize>().unwrap();
    match name {
        "s_ols" => fit.s_ols,
        "sigma" => fit.sigma,
        "s_rob" => fit.s_rob,
        "rmse" => fit.rmse,
        "sse" => fit.sse,
        "r2" => fit.r2,
        "adjusted_r2" => fit.adjusted_r2,
        "passes" => fit.passes as f64,
        _ if name.starts_with("ordinary") => fit.ordinary_parameters[index()],
        _ if name.starts_with("lower") => fit.confidence[index()].0,
        _ if name.starts_with("upper") => fit.confidence[index()].1,
        _ => fit.parameters[index()],
    }
}

#[test]
fn every_printed_statistic_is_that_of_numpy() {
    let (lar, bisquare) = (&*LAR, &fit(Weighting::Bisquare));
    assert!(lar.converged && bisquare.converged);
    for row in read("expected.csv") {
        let fit = if row[0] == "lar" { lar } else { bisquare };
        let (found, expected) = (statistic(fit, &row[1]), row[2].parse::<f64>().unwrap());
        let close = (found - expected).abs() <= 1e-7 * expected.abs();
        assert!(
            close,
            "{} {}: {found} instead of {expected}",
            row[0], row[1]
        );
    }
}

/// The worked consequence: LAR prints little more than `3/sqrt(9 + 257) = 0.184` of the ordinary scale, though it fits no better.
#[test]
fn lar_prints_a_fifth_of_the_scale_of_its_residuals() {
    let fit = &*LAR;
    let sse: f64 = fit.residuals.iter().map(|r| r * r).sum();
    assert!((sse / 254.0).sqrt() >= fit.s_ols);
    let ratio = fit.rmse / fit.s_ols;
    assert!((0.184..0.19).contains(&ratio), "{ratio}");
}
