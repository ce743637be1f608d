//! One reading for every steady plateau of a time series.
//!
//! A plateau is used if it has enough samples, if the converter clips next to none of them, and if pressure and force stand still in
//! it; else it is left out with its reason. The reading is the mean over the window.

use crate::screen::Screened;
use crate::zero::is_clipped;
use pipeline_base::columns::{FORCE, PHASE, PRESSURE, TIME};
use pipeline_base::reading::Reading;
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::session::{ColumnSpec, Phase, Session};
use pipeline_config::CleanOptions;
use pipeline_numerics::plateaus::{Plateau, find_plateaus, rising};
use pipeline_numerics::statistics::{mean, quantile_range, standard_deviation, sum};
use std::collections::BTreeMap;
use std::ops::Range;

const TOO_SHORT: &str = "a steady stretch too short to be used";
const TOO_FEW: &str = "too few samples";
/// Why a plateau or a row of points is left out that the converter cannot show.
pub const CLIPPED: &str = "force at the limit of the converter";
/// Why a plateau is left out whose pressure had not settled.
pub const PRESSURE_DRIFTS: &str = "pressure still drifts";
/// Why a plateau is left out whose force had not settled.
pub const FORCE_DRIFTS: &str = "force still drifts";
const BETWEEN: &str = "outside the steady windows";
/// Force may always drift by this much within a window, N.
const FORCE_DRIFT_N: f64 = 2.0;

/// The columns of a log in its usable rows.
struct Series<'a> {
    log: &'a Screened<'a>,
    time: Vec<f64>,
    pressure: Vec<f64>,
    force: Vec<f64>,
    phase: Vec<f64>,
    others: Vec<(&'a str, Vec<f64>)>,
}

/// Adds the readings of one log, and everything of it that was left out.
pub fn readings(
    session: &Session,
    log: &Screened,
    options: &CleanOptions,
    readings: &mut Vec<Reading>,
    rejects: &mut Vec<Reject>,
) {
    let series = Series::new(log);
    let found = find_plateaus(&series.time, &series.pressure, &options.plateaus());
    let reject = |range: &Range<usize>, extent: Extent, reason: &str| Reject {
        session: session.id.clone(),
        log: log.log.spec.name(),
        first_row: Some(log.line(range.start)),
        last_row: Some(log.line(range.end - 1)),
        count: range.len() as u64,
        extent,
        reason: reason.to_owned(),
    };
    let column = session.column(FORCE);
    let drift_n = drift_limit(&series.force, options);
    let (mut used, mut counted) = (Vec::new(), 0);
    for plateau in &found.plateaus {
        match series.defect(&plateau.window, column, options, drift_n) {
            Some(reason) => {
                counted += plateau.window.len();
                rejects.push(reject(&plateau.window, Extent::Plateau, reason));
            }
            None => used.push(plateau),
        }
    }
    for segment in &found.too_short {
        counted += segment.len();
        rejects.push(reject(segment, Extent::Plateau, TOO_SHORT));
    }
    counted += used.iter().map(|p| p.window.len()).sum::<usize>();
    if counted < log.rows.len() {
        let mut between = reject(&(0..log.rows.len()), Extent::Transient, BETWEEN);
        between.count = (log.rows.len() - counted) as u64;
        rejects.push(between);
    }
    let phases = series.phases(&used, options.turning_kpa);
    readings.extend(
        used.iter()
            .zip(phases)
            .map(|(p, phase)| series.reading(&p.window, phase)),
    );
}

/// By how much the force may drift within a window of a log with these forces, N.
fn drift_limit(force: &[f64], options: &CleanOptions) -> f64 {
    if force.is_empty() {
        return f64::INFINITY;
    }
    let range = quantile_range(force, 0.01, 0.99);
    FORCE_DRIFT_N.max(options.largest_force_drift * range)
}

impl<'a> Series<'a> {
    fn new(log: &'a Screened<'a>) -> Self {
        let named = [TIME, PRESSURE, FORCE, PHASE];
        let others = log
            .log
            .columns
            .iter()
            .filter(|(name, _)| !named.contains(&name.as_str()))
            .map(|(name, _)| (name.as_str(), log.column(name)))
            .collect();
        Self {
            log,
            time: log.column(TIME),
            pressure: log.column(PRESSURE),
            force: log.column(FORCE),
            phase: log.column(PHASE),
            others,
        }
    }

    /// Why a window cannot be used.
    fn defect(
        &self,
        window: &Range<usize>,
        column: Option<&ColumnSpec>,
        options: &CleanOptions,
        drift_n: f64,
    ) -> Option<&'static str> {
        let time = &self.time[window.clone()];
        if window.len() < options.fewest_samples {
            return Some(TOO_FEW);
        }
        let force = self.force.get(window.clone()).unwrap_or_default();
        let clipped = column.map_or(0, |c| force.iter().filter(|f| is_clipped(c, **f)).count());
        if clipped as f64 > options.most_clipped * window.len() as f64 {
            return Some(CLIPPED);
        }
        if drift(time, &self.pressure[window.clone()]) > options.largest_drift_kpa {
            return Some(PRESSURE_DRIFTS);
        }
        (drift(time, force) > drift_n).then_some(FORCE_DRIFTS)
    }

    /// Filling or venting: what most of the segment's rows state, else what follows from the sequence of levels.
    fn phases(&self, used: &[&Plateau], turning_kpa: f64) -> Vec<Option<Phase>> {
        if self.phase.is_empty() {
            let levels: Vec<f64> = used
                .iter()
                .map(|p| mean(&self.pressure[p.window.clone()]))
                .collect();
            let name = |up: bool| {
                if up {
                    Phase::Pressurizing
                } else {
                    Phase::Depressurizing
                }
            };
            return rising(&levels, turning_kpa)
                .into_iter()
                .map(|up| Some(name(up)))
                .collect();
        }
        used.iter()
            .map(|plateau| {
                let states = &self.phase[plateau.segment.clone()];
                let filling = states
                    .iter()
                    .filter(|c| **c == Phase::Pressurizing.code())
                    .count();
                let code = if 2 * filling >= states.len() {
                    Phase::Pressurizing
                } else {
                    Phase::Depressurizing
                };
                Some(code)
            })
            .collect()
    }

    fn reading(&self, window: &Range<usize>, phase: Option<Phase>) -> Reading {
        let over = |values: &[f64]| mean(&values[window.clone()]);
        // Of a column beside force and pressure single cells may be missing.
        let known = |values: &[f64]| {
            let here = values[window.clone()].iter().copied();
            mean(&here.filter(|x| x.is_finite()).collect::<Vec<f64>>())
        };
        let mut values: BTreeMap<String, f64> = self
            .others
            .iter()
            .map(|(name, column)| ((*name).to_owned(), known(column)))
            .filter(|(_, x)| x.is_finite())
            .collect();
        values.insert(TIME.to_owned(), over(&self.time));
        values.insert(PRESSURE.to_owned(), over(&self.pressure));
        if !self.force.is_empty() {
            values.insert(FORCE.to_owned(), over(&self.force));
        }
        let scatter = |column: &[f64]| {
            column
                .get(window.clone())
                .map_or(f64::NAN, standard_deviation)
        };
        Reading {
            log: self.log.log.spec.name(),
            run: self.log.log.spec.run,
            first_row: self.log.line(window.start) as i64,
            last_row: self.log.line(window.end - 1) as i64,
            phase,
            samples: window.len() as i64,
            sd_force_n: scatter(&self.force),
            zero_force_n: f64::NAN,
            zero_pressure_kpa: f64::NAN,
            sd_pressure_kpa: scatter(&self.pressure),
            values,
            labels: self.labels(window),
        }
    }

    /// The word that most rows of a window have in each column of labels, the first by name of equals.
    fn labels(&self, window: &Range<usize>) -> BTreeMap<String, String> {
        let rows = &self.log.rows[window.clone()];
        let usual = |words: &[Option<String>]| {
            let mut counts: BTreeMap<&String, usize> = BTreeMap::new();
            for word in rows.iter().filter_map(|r| words[*r].as_ref()) {
                *counts.entry(word).or_default() += 1;
            }
            let most = counts.values().copied().max()?;
            let first = counts.into_iter().find(|(_, n)| *n == most)?;
            Some(first.0.clone())
        };
        let columns = self.log.log.labels.iter();
        columns
            .filter_map(|(name, words)| Some((name.clone(), usual(words)?)))
            .collect()
    }
}

/// The change of a quantity over a window along its least-squares line; 0 for an empty column.
fn drift(time: &[f64], values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let (t0, v0) = (mean(time), mean(values));
    let products: Vec<f64> = time
        .iter()
        .zip(values)
        .map(|(t, v)| (t - t0) * (v - v0))
        .collect();
    let squares: Vec<f64> = time.iter().map(|t| (t - t0) * (t - t0)).collect();
    let span = time[time.len() - 1] - time[0];
    let slope = sum(&products) / sum(&squares).max(f64::MIN_POSITIVE);
    (slope * span).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_may_drift_by_two_newtons_or_a_share_of_its_range() {
        let options = CleanOptions {
            largest_force_drift: 0.01,
            ..CleanOptions::default()
        };
        let up_to = |force: f64| (0..=100).map(|k| f64::from(k) * force / 98.0).collect();
        let limit = |force: Vec<f64>| drift_limit(&force, &options);
        assert_eq!(limit(up_to(196.0)), 2.0);
        // From the 1st to the 99th percentile it is 400 N.
        assert!((limit(up_to(400.0)) - 4.0).abs() < 1e-9);
        assert_eq!(limit(Vec::new()), f64::INFINITY);
    }
}
