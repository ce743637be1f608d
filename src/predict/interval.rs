//! The interval for a muscle that was not measured; [`crate`] has the formula and what it assumes.

use pipeline_fit::GroupFit;
use pipeline_fit::engine::EquationFit;
use pipeline_numerics::distributions::student_t_quantile;
use pipeline_numerics::statistics::{mean, standard_deviation, sum_of_squares};
use serde::Serialize;

/// Confidence of the interval.
pub const CONFIDENCE: f64 = 0.95;

/// An interval, and what it is made of: standard deviations in N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end, N; never below zero.
    pub low_n: f64,
    /// Upper end, N.
    pub high_n: f64,
    /// Of the fit.
    pub fit_n: f64,
    /// Of the gains of specimens.
    pub specimens_n: f64,
    /// Of readings around a specimen's own curve.
    pub readings_n: f64,
    /// Of an eps_620 that was not given.
    pub contraction_620_n: f64,
    /// Degrees of freedom of Student's t.
    pub freedom: usize,
}

/// Mean and standard deviation of eps_620 over the specimens of a group; the deviation is none for a single one.
pub fn free_contraction(fit: &GroupFit) -> (f64, Option<f64>) {
    let all: Vec<f64> = fit.specimens.iter().map(|s| s.contraction_620).collect();
    let deviation = (all.len() > 1).then(|| standard_deviation(&all));
    (mean(&all), deviation)
}

/// The interval of a force; `None` where the group has too few specimens.
///
/// `force` gives the law's force in N at the state, for coefficients and an eps_620; `assumed` is the standard deviation of an eps_620
/// that was not given.
pub fn interval(
    fit: &GroupFit,
    joint: &EquationFit,
    contraction_620: f64,
    assumed: Option<f64>,
    force: &dyn Fn(&[f64], f64) -> f64,
) -> Option<Interval> {
    let scatter = fit.scatter.as_ref()?;
    let all = joint.values();
    let estimate = force(&all, contraction_620);
    let g = joint.folds.len() as f64;
    let without: Vec<f64> = joint
        .folds
        .iter()
        .map(|fold| force(&fold.coefficients, contraction_620) - estimate)
        .collect();
    let fit_n = ((g - 1.0) / g * sum_of_squares(&without)).sqrt();
    let specimens_n = scatter.between * estimate;
    let contraction_620_n = assumed.map_or(0.0, |deviation| {
        let at = |e: f64| force(&all, e.clamp(1e-3, 1.0 - 1e-3));
        let change = at(contraction_620 + deviation) - at(contraction_620 - deviation);
        0.5 * change.abs() * (1.0 + 1.0 / g).sqrt()
    });
    let parts = [fit_n, specimens_n, scatter.within_n, contraction_620_n];
    let t = student_t_quantile(0.5 + 0.5 * CONFIDENCE, scatter.freedom as f64);
    let half = t * sum_of_squares(&parts).sqrt();
    Some(Interval {
        low_n: (estimate - half).max(0.0),
        high_n: estimate + half,
        fit_n,
        specimens_n,
        readings_n: scatter.within_n,
        contraction_620_n,
        freedom: scatter.freedom,
    })
}
