//! The interval of a reading; [`crate`] has what it is of.

use pipeline_diagnose::mixed_law::{Forecast, Parts};
use pipeline_fit::GroupFit;
use pipeline_numerics::distributions::student_t_quantile;
use pipeline_numerics::statistics::{mean, standard_deviation};
use serde::Serialize;

/// Confidence of the interval.
pub const CONFIDENCE: f64 = 0.95;

/// An interval, and what it is made of: standard deviations in N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end, N; never below zero but where a rig with a zero of its own is read.
    pub low_n: f64,
    /// Upper end, N.
    pub high_n: f64,
    /// By source.
    #[serde(flatten)]
    pub parts: Parts,
    /// Of an eps_620 that was not given.
    pub contraction_620_n: f64,
    /// Degrees of freedom of Student's t.
    pub freedom: f64,
}

impl Interval {
    /// The interval of a forecast; `contraction_620_n` is the standard deviation from an eps_620 that was not given.
    pub fn of(forecast: &Forecast, contraction_620_n: f64) -> Self {
        let t = student_t_quantile(0.5 + 0.5 * CONFIDENCE, forecast.freedom);
        let (low_n, high_n) = forecast.within(t, contraction_620_n);
        Self {
            low_n,
            high_n,
            parts: forecast.parts,
            contraction_620_n,
            freedom: forecast.freedom,
        }
    }
}

/// Mean and standard deviation of eps_620 over the specimens of a group; the deviation is none for a single one.
pub fn free_contraction(fit: &GroupFit) -> (f64, Option<f64>) {
    let all: Vec<f64> = fit.specimens.iter().map(|s| s.contraction_620).collect();
    let deviation = (all.len() > 1).then(|| standard_deviation(&all));
    (mean(&all), deviation)
}
