//! A session with its samples and steady readings, and the numbers that make its logs.

use crate::{Failure, Files};
use pipeline::base::columns::{FORCE, PRESSURE, TIME};
use pipeline::base::reading::Reading;
use pipeline::base::session::{Phase, Session};
use pipeline::config::CleanOptions;
use pipeline::formats::session_toml;
use pipeline::numerics::statistics::{mean, median, quantile, standard_deviation};
use pipeline::stages::clean::clean;
use pipeline::stages::ingest::{LogSamples, ingest};

/// Longest time before a window in which its step began, s.
const STEP_S: f64 = 0.5;

/// The session that the bytes of a `session.toml` describe.
pub fn checked(toml: &[u8]) -> Result<Session, Failure> {
    let text = std::str::from_utf8(toml)?;
    session_toml::read("session.toml", text).map_err(|mistakes| format!("{mistakes:?}").into())
}

/// A session with its samples and steady readings.
pub struct Look {
    pub name: &'static str,
    pub session: Session,
    logs: Vec<LogSamples>,
    pub readings: Vec<Reading>,
}

impl Look {
    pub fn new(name: &'static str, files: &Files) -> Result<Self, Failure> {
        let session = checked(&files[0].1)?;
        let bytes = |log: &str| files.iter().find(|(name, _)| name == log);
        let logs = session
            .logs
            .iter()
            .map(|l| Ok(bytes(&l.file).map(|(_, b)| b.clone()).unwrap_or_default()))
            .collect();
        let logs = ingest(&session, name, logs).logs;
        let readings = clean(&session, &logs, &CleanOptions::default()).readings;
        Ok(Self {
            name,
            session,
            logs,
            readings,
        })
    }

    pub fn measuring(&self) -> impl Iterator<Item = &LogSamples> {
        self.logs.iter().filter(|l| !l.spec.is_zero)
    }

    fn log(&self, file: &str) -> &LogSamples {
        let own = self.logs.iter().find(|l| l.spec.file == file);
        own.unwrap_or(&self.logs[0])
    }

    /// The samples of a reading's window.
    pub fn window<'a>(&'a self, r: &Reading, column: &str) -> &'a [f64] {
        let log = self.log(&r.log);
        let place = |line: i64| (line - log.first_line as i64).max(0) as usize;
        let values = log.column(column).unwrap_or_default();
        &values[place(r.first_row)..=place(r.last_row).min(values.len() - 1)]
    }

    /// The samples between a reading's step and its window.
    fn step<'a>(&'a self, r: &Reading, column: &str) -> &'a [f64] {
        let log = self.log(&r.log);
        let time = log.column(TIME).unwrap_or_default();
        let end = (r.first_row - log.first_line as i64).max(0) as usize;
        let start = time.partition_point(|t| *t < time[end] - STEP_S);
        &log.column(column).unwrap_or_default()[start.min(end)..end]
    }

    pub fn spacings_ms(&self) -> Vec<f64> {
        let spacing = |log: &LogSamples| -> Vec<f64> {
            let time = log.column(TIME).unwrap_or_default();
            time.windows(2).map(|w| 1e3 * (w[1] - w[0])).collect()
        };
        self.measuring().flat_map(spacing).collect()
    }

    /// Change along a window, per second.
    fn slope(&self, r: &Reading, column: &str) -> f64 {
        let (time, values) = (self.window(r, TIME), self.window(r, column));
        let (t0, v0) = (mean(time), mean(values));
        let products = time.iter().zip(values).map(|(t, v)| (t - t0) * (v - v0));
        let squares = time.iter().map(|t| (t - t0) * (t - t0));
        products.sum::<f64>() / squares.sum::<f64>()
    }

    fn of(&self, phase: Phase, number: impl Fn(&Reading) -> f64) -> Vec<f64> {
        let own = self.readings.iter().filter(|r| r.phase == Some(phase));
        own.map(number).collect()
    }

    pub fn all(&self, number: impl Fn(&Reading) -> f64) -> Vec<f64> {
        self.readings.iter().map(number).collect()
    }

    /// What a log is made of, in the order in which it is printed.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let spacings = self.spacings_ms();
        let share = |ms: f64| {
            let hits = spacings.iter().filter(|s| (*s - ms).abs() < 0.1).count();
            100.0 * hits as f64 / spacings.len() as f64
        };
        let runs = self.measuring().count() as f64;
        let count = |phase| self.of(phase, |_| 1.0).len() as f64 / runs;
        let up = Phase::Pressurizing;
        let over = |r: &Reading, column| {
            let peak = self
                .step(r, column)
                .iter()
                .copied()
                .fold(f64::NAN, f64::max);
            peak - mean(self.window(r, column))
        };
        let raw = |column: &str| -> Vec<f64> {
            let values = self.measuring().filter_map(|l| l.column(column));
            values
                .flatten()
                .copied()
                .filter(|x| x.is_finite())
                .collect()
        };
        let zero = |column| {
            let logs = self.logs.iter().filter(|l| l.spec.is_zero);
            logs.filter_map(|l| l.column(column))
                .flatten()
                .copied()
                .filter(|x| x.is_finite())
                .collect::<Vec<f64>>()
        };
        let levels = self.of(up, |r| r.value(PRESSURE));
        let steps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
        let rising: Vec<f64> = steps.into_iter().filter(|s| *s > 0.0).collect();
        let sd =
            |column: &'static str| move |r: &Reading| standard_deviation(self.window(r, column));
        vec![
            ("rows a run", raw(TIME).len() as f64 / runs),
            ("mean spacing of samples (ms)", mean(&spacings)),
            ("  spacings of 0 ms (%)", share(0.0)),
            ("  of 1 ms (%)", share(1.0)),
            ("  of 2 ms (%)", share(2.0)),
            ("  of 3 ms (%)", share(3.0)),
            ("step of the force converter (N)", quantum(&raw(FORCE))),
            (
                "step of the pressure converter (kPa)",
                quantum(&raw(PRESSURE)),
            ),
            ("plateaus a run, filling", count(up)),
            ("plateaus a run, venting", count(Phase::Depressurizing)),
            ("step of pressure, filling (kPa)", median(&rising)),
            ("highest plateau (kPa)", quantile(&levels, 1.0)),
            ("sd of force on a plateau (N)", median(&self.all(sd(FORCE)))),
            ("  its 90% quantile", quantile(&self.all(sd(FORCE)), 0.9)),
            (
                "sd of pressure on a plateau (kPa)",
                median(&self.all(sd(PRESSURE))),
            ),
            ("  its 90% quantile", quantile(&self.all(sd(PRESSURE)), 0.9)),
            (
                "correlation of neighbouring samples' force",
                median(&self.all(|r| neighbours(self.window(r, FORCE)))),
            ),
            (
                "overshoot of pressure, filling (kPa)",
                median(&self.of(up, |r| over(r, PRESSURE))),
            ),
            (
                "  its 90% quantile",
                quantile(&self.of(up, |r| over(r, PRESSURE)), 0.9),
            ),
            (
                "overshoot of force, filling (N)",
                median(&self.of(up, |r| over(r, FORCE))),
            ),
            (
                "  its 90% quantile",
                quantile(&self.of(up, |r| over(r, FORCE)), 0.9),
            ),
            (
                "drift of pressure, filling (kPa/s)",
                median(&self.of(up, |r| self.slope(r, PRESSURE))),
            ),
            (
                "drift of pressure, venting (kPa/s)",
                median(&self.of(Phase::Depressurizing, |r| self.slope(r, PRESSURE))),
            ),
            (
                "drift of force, filling (N/s)",
                median(&self.of(up, |r| self.slope(r, FORCE))),
            ),
            (
                "drift of force, venting (N/s)",
                median(&self.of(Phase::Depressurizing, |r| self.slope(r, FORCE))),
            ),
            ("zero log: force (N)", mean(&zero(FORCE))),
            (
                "zero log: sd of force (N)",
                standard_deviation(&zero(FORCE)),
            ),
            ("zero log: pressure (kPa)", mean(&zero(PRESSURE))),
        ]
    }
}

/// The usual distance between neighbouring levels.
fn quantum(values: &[f64]) -> f64 {
    let mut levels = values.to_vec();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let steps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
    median(&steps)
}

/// Correlation of each sample with the one before it.
fn neighbours(values: &[f64]) -> f64 {
    let middle = mean(values);
    let products = values.windows(2).map(|w| (w[0] - middle) * (w[1] - middle));
    let squares = values.iter().map(|v| (v - middle) * (v - middle));
    products.sum::<f64>() / squares.sum::<f64>()
}
