//! Fits of the new model, and their intervals.

use crate::documented::Comments;
use serde::{Deserialize, Serialize};

/// How the interval of a coefficient is made; `stages::fit::intervals` has the methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IntervalMethod {
    /// Refits without each specimen, Student's t.
    Jackknife,
    /// Refits to specimens drawn with replacement, percentiles.
    Bootstrap,
    /// Profile of the sum of squares; counts every row as independent.
    Profile,
    /// Covariance of the linearised model; counts every row as independent.
    Linearised,
}

impl IntervalMethod {
    /// Every method, in the order of the tables.
    pub const ALL: [IntervalMethod; 4] = [
        IntervalMethod::Jackknife,
        IntervalMethod::Bootstrap,
        IntervalMethod::Profile,
        IntervalMethod::Linearised,
    ];

    /// What tables call it.
    pub fn name(self) -> &'static str {
        match self {
            IntervalMethod::Jackknife => "jackknife by specimen",
            IntervalMethod::Bootstrap => "bootstrap by specimen",
            IntervalMethod::Profile => "profile likelihood",
            IntervalMethod::Linearised => "linearised",
        }
    }
}

documented! {
/// Options of the fit stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitOptions {
    /// "huber", "least_squares", "lar", "bisquare" or "cauchy".
    pub loss: String,
    /// Where Huber's loss becomes linear, in units of the least-squares RMSE.
    pub huber_at_rmse: f64,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Which interval the tables print: "jackknife", "bootstrap", "profile" or "linearised"; the first two go by specimen. All are in
    /// `intervals.csv`.
    pub interval: IntervalMethod,
    /// Refits of the bootstrap by specimen; of more than 10,000 readings fewer, down to 200, where steps from the full fit do not give them.
    pub bootstrap_refits: usize,
    /// Seed of the bootstrap and of the split by row.
    pub seed: u64,
    /// Fraction of each session's rows that the split by row trains on, as in the force paper.
    pub train_fraction: f64,
    /// Rows with |eps*| up to this count as measured at resting length.
    pub at_rest: f64,
    /// Rows within this of 620 kPa give the measured maximum force, kPa.
    pub near_620_kpa: f64,
    /// Length at which the end caps of 10 mm actuators touch, m.
    pub l_0_10mm_m: f64,
    /// The same for 20 mm.
    pub l_0_20mm_m: f64,
    /// Whether zero logs that were recorded while the actuator pulled give way to the usual zero of their campaign: in sessions at resting length, where one
    /// is further above those of sessions away from it than one more would be by chance (Student's t at 3e-5). Else every zero is taken off as it is declared.
    pub usual_zeros: bool,
    /// Also fit each diameter over all measured campaigns that have it.
    pub pool: bool,
}
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            loss: "huber".to_owned(),
            huber_at_rmse: 3.0,
            confidence: 0.95,
            interval: IntervalMethod::Jackknife,
            bootstrap_refits: 1000,
            seed: 1,
            train_fraction: 0.8,
            at_rest: 0.05,
            near_620_kpa: 15.0,
            l_0_10mm_m: 0.0075,
            l_0_20mm_m: 0.013,
            usual_zeros: true,
            pool: true,
        }
    }
}
