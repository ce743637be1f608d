//! Rows that are no measurements.
//!
//! Each row is left out for the first of these that holds: a cell that is no number, an unknown state, a pressure or force that no such
//! rig produces, a clock that runs backwards, an isolated spike. The clock is mended by keeping the longest sequence of rows whose time
//! does not decrease, which drops a single wrong stamp as well as a tail of nonsense, whichever is less. A log of which more than a
//! small fraction is unusable is left out whole: such logs are broken in ways that the remaining rows may share.

use pipeline_base::columns::{ANGLE, FORCE, LENGTH, PHASE, PRESSURE, TIME, TORQUE};
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::session::{Sampling, Session};
use pipeline_config::CleanOptions;
use pipeline_ingest::LogSamples;
use pipeline_numerics::statistics::quantile_range;
use std::collections::BTreeMap;

/// A log with the rows that are measurements.
#[derive(Clone, Debug)]
pub struct Screened<'a> {
    /// The log as ingested.
    pub log: &'a LogSamples,
    /// Indices of the usable rows, rising.
    pub rows: Vec<usize>,
}

impl Screened<'_> {
    /// The values of a column in the usable rows; empty where the log lacks it.
    pub fn column(&self, name: &str) -> Vec<f64> {
        self.log
            .column(name)
            .map(|values| self.rows.iter().map(|r| values[*r]).collect())
            .unwrap_or_default()
    }

    /// Line in the file of the usable row number `k`.
    pub fn line(&self, k: usize) -> u64 {
        self.log.first_line + self.rows[k] as u64
    }
}

/// Why a row is left out: one byte a row, for logs are long.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
enum Reason {
    /// The row stays.
    None,
    NotANumber,
    UnknownState,
    NoPressure,
    NoForce,
    NoLength,
    NoAngle,
    Backwards,
    Spike,
}

impl Reason {
    fn text(self) -> &'static str {
        match self {
            Reason::None => "none",
            Reason::NotANumber => "a cell that is not a finite number",
            Reason::UnknownState => "an unknown state",
            Reason::NoPressure => "a pressure outside the possible range",
            Reason::NoForce => "a force outside the possible range",
            Reason::NoLength => "a length that is not positive",
            Reason::NoAngle => "an angle beyond half a turn: is its unit right?",
            Reason::Backwards => "the clock runs backwards",
            Reason::Spike => "an isolated spike",
        }
    }
}

/// Screens one log; `None` where it is left out whole. What is left out is added to `rejects`.
pub fn screen<'a>(
    session: &Session,
    log: &'a LogSamples,
    options: &CleanOptions,
    rejects: &mut Vec<Reject>,
) -> Option<Screened<'a>> {
    let mut reasons = vec![Reason::None; log.len()];
    impossible_values(log, options, &mut reasons);
    if session.sampling == Sampling::Timeseries {
        backward_clock(log, &mut reasons);
        spikes(log, options.spike_fraction, &mut reasons);
    }
    let bad = log.len() - usable(&reasons).count();
    let by_reason = summarise(log, &reasons);
    let timeseries = session.sampling == Sampling::Timeseries;
    if bad == log.len() || (timeseries && bad as f64 > options.most_bad_rows * log.len() as f64) {
        rejects.push(whole_log(session, log, bad, &by_reason));
        return None;
    }
    rejects.extend(
        by_reason
            .into_iter()
            .map(|(reason, (first, last, count))| Reject {
                session: session.id.clone(),
                log: log.spec.name(),
                first_row: Some(first),
                last_row: Some(last),
                count,
                extent: Extent::Row,
                reason: reason.to_owned(),
            }),
    );
    let rows = usable(&reasons).collect();
    Some(Screened { log, rows })
}

/// The rows that stay.
fn usable(reasons: &[Reason]) -> impl Iterator<Item = usize> {
    let rows = reasons.iter().enumerate();
    rows.filter(|(_, reason)| **reason == Reason::None)
        .map(|(k, _)| k)
}

fn mark(reasons: &mut [Reason], values: &[f64], reason: Reason, bad: impl Fn(f64) -> bool) {
    for (slot, value) in reasons.iter_mut().zip(values) {
        if *slot == Reason::None && bad(*value) {
            *slot = reason;
        }
    }
}

fn impossible_values(log: &LogSamples, options: &CleanOptions, reasons: &mut [Reason]) {
    for name in [TIME, FORCE, TORQUE, ANGLE, PRESSURE, LENGTH] {
        if let Some(values) = log.column(name) {
            mark(reasons, values, Reason::NotANumber, |x| !x.is_finite());
        }
    }
    let [low, high] = options.pressure_range_kpa;
    if let Some(values) = log.column(PRESSURE) {
        mark(reasons, values, Reason::NoPressure, |p| p < low || p > high);
    }
    if let Some(values) = log.column(FORCE) {
        mark(reasons, values, Reason::NoForce, |f| {
            f.abs() > options.largest_force_n
        });
    }
    if let Some(values) = log.column(LENGTH) {
        mark(reasons, values, Reason::NoLength, |l| l <= 0.0);
    }
    if let Some(values) = log.column(ANGLE) {
        mark(reasons, values, Reason::NoAngle, |a| {
            a.abs() > std::f64::consts::PI
        });
    }
    if let Some(values) = log.column(PHASE) {
        mark(reasons, values, Reason::UnknownState, |x| x.is_nan());
    }
}

/// Marks the rows outside the longest sequence whose time does not decrease.
fn backward_clock(log: &LogSamples, reasons: &mut [Reason]) {
    let Some(time) = log.column(TIME) else { return };
    let usable: Vec<usize> = usable(reasons).collect();
    if usable.windows(2).all(|w| time[w[0]] <= time[w[1]]) {
        return;
    }
    let kept = longest_rising(&usable, time);
    let mut keep = kept.iter().peekable();
    for k in usable {
        if keep.peek() == Some(&&k) {
            keep.next();
        } else {
            reasons[k] = Reason::Backwards;
        }
    }
}

/// The longest subsequence of `rows` along which `time` does not decrease (patience sorting, O(n log n)).
fn longest_rising(rows: &[usize], time: &[f64]) -> Vec<usize> {
    let mut ends: Vec<usize> = Vec::new();
    let mut before: Vec<Option<usize>> = vec![None; rows.len()];
    for (k, row) in rows.iter().enumerate() {
        let place = ends.partition_point(|e| time[rows[*e]] <= time[*row]);
        before[k] = place.checked_sub(1).map(|p| ends[p]);
        if place == ends.len() {
            ends.push(k);
        } else {
            ends[place] = k;
        }
    }
    let mut at = ends.last().copied();
    let mut kept = Vec::with_capacity(ends.len());
    while let Some(k) = at {
        kept.push(rows[k]);
        at = before[k];
    }
    kept.reverse();
    kept
}

/// Marks samples that stand out alone while their neighbours agree.
fn spikes(log: &LogSamples, fraction: f64, reasons: &mut [Reason]) {
    for name in [FORCE, PRESSURE] {
        let Some(values) = log.column(name) else {
            continue;
        };
        let usable: Vec<usize> = usable(reasons).collect();
        let levels: Vec<f64> = usable.iter().map(|k| values[*k]).collect();
        let range = quantile_range(&levels, 0.01, 0.99);
        let limit = (fraction * range).max(20.0);
        for (w, row) in levels.windows(3).zip(usable.iter().skip(1)) {
            let (beside, between) = ((w[0] - w[2]).abs(), 0.5 * (w[0] + w[2]));
            if beside < 0.25 * limit && (w[1] - between).abs() > limit {
                reasons[*row] = Reason::Spike;
            }
        }
    }
}

type Summary = BTreeMap<&'static str, (u64, u64, u64)>;

/// First line, last line and count of every reason.
fn summarise(log: &LogSamples, reasons: &[Reason]) -> Summary {
    let mut summary = Summary::new();
    let rows = reasons.iter().enumerate();
    for (k, reason) in rows.filter(|(_, reason)| **reason != Reason::None) {
        let line = log.first_line + k as u64;
        let slot = summary.entry(reason.text()).or_insert((line, line, 0));
        slot.1 = line;
        slot.2 += 1;
    }
    summary
}

fn whole_log(session: &Session, log: &LogSamples, bad: usize, summary: &Summary) -> Reject {
    let parts: Vec<String> = summary
        .iter()
        .map(|(reason, (first, _, count))| format!("{reason} in {count} rows from line {first}"))
        .collect();
    let share = 100.0 * bad as f64 / log.len().max(1) as f64;
    Reject {
        session: session.id.clone(),
        log: log.spec.name(),
        first_row: Some(log.first_line),
        last_row: Some(log.first_line + log.len().saturating_sub(1) as u64),
        count: log.len() as u64,
        extent: Extent::Log,
        reason: format!("{share:.1}% of the rows are unusable: {}", parts.join("; ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_stamp_costs_one_row_and_a_clock_that_starts_again_costs_its_shorter_part() {
        let rows: Vec<usize> = (0..6).collect();
        assert_eq!(
            longest_rising(&rows, &[0.0, 1.0, 99.0, 2.0, 2.0, 3.0]),
            [0, 1, 3, 4, 5]
        );
        assert_eq!(
            longest_rising(&rows, &[0.0, 1.0, 2.0, 3.0, 0.1, 0.2]),
            [0, 1, 2, 3]
        );
        assert_eq!(longest_rising(&[], &[]), [0_usize; 0]);
    }
}
