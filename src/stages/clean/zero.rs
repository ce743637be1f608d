//! The zero of the force channel.
//!
//! The rule, in this order; what was applied is written down for every session, with the evidence against it:
//!
//! 1. `zero-log`: the median of the zero log, which survives spikes and, as long as fewer than half of its samples are clipped, the
//!    converter's limit.
//! 2. `slack`: where the zero log is missing, was left out, or has half of its samples at the limit (then the true zero is only known
//!    to lie at or beyond it), the force at which the session's own plateaus stand while the actuator is slack: a run of plateaus from
//!    the lowest pressure upwards, over at least 60 kPa, along which the force does not change.
//!    Of time series only: points were zeroed by whoever wrote them down.
//! 3. `clipped-zero-log`: no slack state either, but a clipped zero log: its limit is the nearest that can be said.
//! 4. `none`: nothing is taken off.
//!
//! A zero log that contradicts the slack state is still applied, because it is what the measurers declared, and because a zero that
//! moved between zero log and test is an effect that the residual search must be able to find; the difference is reported. What the zeros of a
//! campaign say of one of them is judged where its sessions come together (`pipeline_fit::zeros`).

use crate::screen::Screened;
use pipeline_base::columns::{FORCE, PRESSURE};
use pipeline_base::reading::Reading;
use pipeline_base::session::{ColumnSpec, Sampling};
use pipeline_config::ZeroRule;
use pipeline_numerics::statistics::{median, quantile_range};
use serde::{Deserialize, Serialize};

/// Where a zero came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroSource {
    /// The median of the zero log.
    ZeroLog,
    /// The force of the session's slack plateaus.
    Slack,
    /// The limit at which the zero log is clipped.
    ClippedZeroLog,
    /// Nothing was taken off.
    None,
}

impl ZeroSource {
    /// The word used in tables.
    pub fn name(self) -> &'static str {
        match self {
            ZeroSource::ZeroLog => "zero-log",
            ZeroSource::Slack => "slack",
            ZeroSource::ClippedZeroLog => "clipped-zero-log",
            ZeroSource::None => "none",
        }
    }
}

/// The zero of one session, and what speaks for and against it. Forces in N.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Zero {
    /// Where it came from.
    pub source: ZeroSource,
    /// What was taken off every force.
    pub applied_n: f64,
    /// Median of the zero log.
    pub zero_log_n: Option<f64>,
    /// Fraction of the zero log's samples at the converter's limit.
    pub zero_log_clipped: Option<f64>,
    /// Median pressure of the zero log, kPa: what the pressure channel shows without pressure. Not taken off.
    pub zero_log_pressure_kpa: Option<f64>,
    /// Force at which the slack actuator stands in the session's own logs, before any zero.
    pub slack_n: Option<f64>,
    /// Whether the zero log and the slack state differ by more than the tolerance.
    pub contradicted: bool,
}

/// Tolerance between zero log and slack state: the larger of 3 N and 1% of the session's range of force.
const TOLERANCE_N: f64 = 3.0;
const TOLERANCE_FRACTION: f64 = 0.01;
/// Fraction of clipped samples from which the median of a zero log is only a limit.
const HALF: f64 = 0.5;

/// Determines the zero from the screened logs and the readings as yet without zero.
pub fn determine(
    column: &ColumnSpec,
    logs: &[Screened],
    readings: &[Reading],
    rule: ZeroRule,
    sampling: Sampling,
) -> Zero {
    let zero_logs = || logs.iter().filter(|l| l.log.spec.is_zero);
    let forces: Vec<f64> = zero_logs().flat_map(|l| l.column(FORCE)).collect();
    let pressures: Vec<f64> = zero_logs().flat_map(|l| l.column(PRESSURE)).collect();
    let some = |values: &[f64]| (!values.is_empty()).then(|| median(values));
    let clipped = forces.iter().filter(|f| is_clipped(column, **f)).count();
    let share = clipped as f64 / forces.len().max(1) as f64;
    let tolerance = tolerance(readings);
    // Points were zeroed by whoever wrote them down. What they show of a zero is for the residual search: taken off in the sessions in which
    // the actuator happens to go slack, and in no others, it would look like anything.
    let slack = match sampling {
        Sampling::Timeseries => slack_level(readings, tolerance),
        Sampling::Points => None,
    };
    let zero_log = some(&forces);
    let (source, applied) = match (rule, zero_log, slack) {
        (ZeroRule::None, _, _) => (ZeroSource::None, 0.0),
        (_, Some(level), _) if share < HALF => (ZeroSource::ZeroLog, level),
        (_, _, Some(level)) => (ZeroSource::Slack, level),
        (_, Some(limit), None) => (ZeroSource::ClippedZeroLog, limit),
        (_, None, None) => (ZeroSource::None, 0.0),
    };
    let differ = |a: f64, b: f64| (a - b).abs() > tolerance;
    Zero {
        source,
        applied_n: applied,
        zero_log_n: zero_log,
        zero_log_clipped: zero_log.map(|_| share),
        zero_log_pressure_kpa: some(&pressures),
        slack_n: slack,
        contradicted: zero_log.zip(slack).is_some_and(|(a, b)| differ(a, b)),
    }
}

/// Whether a force stands at one of the converter's limits.
pub fn is_clipped(column: &ColumnSpec, force: f64) -> bool {
    let margin = |limit: f64| 1e-6 * limit.abs().max(1.0);
    column
        .saturation_low
        .is_some_and(|l| force <= l + margin(l))
        || column
            .saturation_high
            .is_some_and(|h| force >= h - margin(h))
}

fn force_range(readings: &[Reading]) -> f64 {
    let forces: Vec<f64> = readings
        .iter()
        .map(|r| r.value(FORCE))
        .filter(|f| f.is_finite())
        .collect();
    if forces.is_empty() {
        return 0.0;
    }
    quantile_range(&forces, 0.0, 1.0)
}

/// By how much zero log and slack state may differ, and a slack state in itself, N.
fn tolerance(readings: &[Reading]) -> f64 {
    TOLERANCE_N.max(TOLERANCE_FRACTION * force_range(readings))
}

/// The force along the longest run of plateaus from the lowest pressure upwards in which it stays within `tolerance`; `None` if that
/// run is shorter than five plateaus or spans less than 60 kPa, or if the force never leaves it.
fn slack_level(readings: &[Reading], tolerance: f64) -> Option<f64> {
    const FEWEST: usize = 5;
    const SPAN_KPA: f64 = 60.0;
    let mut pairs: Vec<(f64, f64)> = readings
        .iter()
        .map(|r| (r.value(PRESSURE), r.value(FORCE)))
        .filter(|(p, f)| p.is_finite() && f.is_finite())
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let slack = pairs
        .iter()
        .take_while(|(_, f)| {
            (low, high) = (low.min(*f), high.max(*f));
            high - low <= tolerance
        })
        .count();
    let spans = slack >= FEWEST && pairs[slack - 1].0 - pairs[0].0 >= SPAN_KPA;
    (spans && slack < pairs.len()).then(|| {
        let forces: Vec<f64> = pairs[..slack].iter().map(|(_, f)| *f).collect();
        median(&forces)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(pressure: f64, force: f64) -> Reading {
        Reading {
            log: String::new(),
            run: None,
            first_row: 0,
            last_row: 0,
            phase: None,
            samples: 1,
            sd_force_n: f64::NAN,
            zero_force_n: f64::NAN,
            zero_pressure_kpa: f64::NAN,
            sd_pressure_kpa: f64::NAN,
            values: [(PRESSURE.to_owned(), pressure), (FORCE.to_owned(), force)].into(),
            labels: std::collections::BTreeMap::new(),
        }
    }

    #[test]
    fn slack_states_may_differ_by_three_newtons_or_a_hundredth_of_the_range() {
        let up_to = |force: f64| [reading(0.0, 0.0), reading(600.0, force)];
        assert_eq!(tolerance(&[]), 3.0);
        assert_eq!(tolerance(&up_to(299.0)), 3.0);
        assert_eq!(tolerance(&up_to(500.0)), 5.0);
    }

    #[test]
    fn a_slack_actuator_shows_the_zero_and_a_taut_one_does_not() {
        let force = |p: f64| -4.0 + 0.5 * (p - 200.0).max(0.0);
        let slack: Vec<Reading> = (0..30)
            .map(|k| f64::from(k) * 20.0)
            .map(|p| reading(p, force(p)))
            .collect();
        assert_eq!(slack_level(&slack, 3.0), Some(-4.0));
        let taut: Vec<Reading> = (0..30)
            .map(|k| f64::from(k) * 20.0)
            .map(|p| reading(p, 0.6 * p))
            .collect();
        assert_eq!(slack_level(&taut, 3.0), None);
        let dead: Vec<Reading> = (0..30).map(|k| reading(f64::from(k) * 20.0, 1.0)).collect();
        assert_eq!(
            slack_level(&dead, 3.0),
            None,
            "a channel that never moves shows nothing"
        );
    }
}
