//! Cleaning of logs.

use crate::documented::Comments;
use pipeline_numerics::plateaus::PlateauOptions;
use serde::{Deserialize, Serialize};

/// Where the zero of the force channel comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroRule {
    /// The session's zero log; see `stages::clean::zero` for what happens where it cannot be used.
    ZeroLog,
    /// Forces are taken as they were logged.
    None,
}

documented! {
/// Options of the clean stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CleanOptions {
    /// "zero-log" or "none".
    pub zero: ZeroRule,
    /// Width of the bins in which the pressure is examined, s.
    pub bin_s: f64,
    /// Rate of pressure above which a valve must be open, kPa/s.
    pub step_rate_kpa_per_s: f64,
    /// Time after a step that is left out, s.
    pub settle_s: f64,
    /// Length of a plateau's window, s.
    pub window_s: f64,
    /// Shortest window that is used, s.
    pub shortest_window_s: f64,
    /// Pressure by which two windows between the same two steps must differ, kPa.
    pub distinct_kpa: f64,
    /// A pause of the clock that ends a plateau, s.
    pub longest_gap_s: f64,
    /// Change of pressure that turns filling into venting where no state is logged, kPa.
    pub turning_kpa: f64,
    /// Fewest samples of a plateau.
    pub fewest_samples: usize,
    /// Pressure may drift by this much within a window, kPa.
    pub largest_drift_kpa: f64,
    /// Force may drift by this fraction of the session's range of force within a window (at least 2 N).
    pub largest_force_drift: f64,
    /// Fraction of a plateau's samples at the converter's limit above which it is censored.
    pub most_clipped: f64,
    /// Fraction of unusable rows above which a log is left out.
    pub most_bad_rows: f64,
    /// Gauge pressures outside this range are invalid, kPa.
    pub pressure_range_kpa: [f64; 2],
    /// Larger forces are invalid, N.
    pub largest_force_n: f64,
    /// An isolated sample that differs from its neighbours by this fraction of the channel's range is a spike.
    pub spike_fraction: f64,
}
}

impl Default for CleanOptions {
    fn default() -> Self {
        Self {
            zero: ZeroRule::ZeroLog,
            bin_s: 0.02,
            step_rate_kpa_per_s: 60.0,
            settle_s: 0.15,
            window_s: 0.25,
            shortest_window_s: 0.1,
            distinct_kpa: 5.0,
            longest_gap_s: 0.1,
            turning_kpa: 4.0,
            fewest_samples: 10,
            largest_drift_kpa: 5.0,
            largest_force_drift: 0.01,
            most_clipped: 0.05,
            most_bad_rows: 0.01,
            pressure_range_kpa: [-50.0, 1500.0],
            largest_force_n: 20_000.0,
            spike_fraction: 0.1,
        }
    }
}

impl CleanOptions {
    /// The options of the plateau search.
    pub fn plateaus(&self) -> PlateauOptions {
        PlateauOptions {
            bin_s: self.bin_s,
            step_rate_kpa_per_s: self.step_rate_kpa_per_s,
            settle_s: self.settle_s,
            window_s: self.window_s,
            shortest_window_s: self.shortest_window_s,
            distinct_kpa: self.distinct_kpa,
            longest_gap_s: self.longest_gap_s,
        }
    }
}
