//! One steady reading: a plateau of a time series, or a row of points.

use crate::columns::{self, derived};
use crate::error::{Error, Result};
use crate::frame::{Frame, Values};
use crate::session::Phase;
use std::collections::{BTreeMap, BTreeSet};

/// A steady reading as cleaned: the force zero taken off, nothing normalised yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Log file within the session.
    pub log: String,
    /// Run number, as declared.
    pub run: Option<i64>,
    /// First line of the log that entered, counted from 1.
    pub first_row: i64,
    /// Last line of the log that entered.
    pub last_row: i64,
    /// Filling or venting, where it is known.
    pub phase: Option<Phase>,
    /// Samples averaged.
    pub samples: i64,
    /// Standard deviation of the samples' force, N; NaN for a single sample.
    pub sd_force_n: f64,
    /// Standard deviation of the samples' pressure, kPa; NaN for a single sample.
    pub sd_pressure_kpa: f64,
    /// Zero of the force channel that was taken off, N; NaN where there is none.
    pub zero_force_n: f64,
    /// What the pressure channel shows in the session's zero log, without pressure, kPa; NaN where there is none. Not taken off.
    pub zero_pressure_kpa: f64,
    /// Every quantity and extra column, by column name, in the unit used inside.
    pub values: BTreeMap<String, f64>,
    /// Every column of words, by name: what names the load cell, the bench, the operator.
    pub labels: BTreeMap<String, String>,
}

impl Reading {
    /// A quantity or extra column; NaN where the log has none.
    pub fn value(&self, column: &str) -> f64 {
        self.values.get(column).copied().unwrap_or(f64::NAN)
    }
}

/// The readings as a table; extra columns follow the fixed ones by name.
pub fn to_frame(readings: &[Reading]) -> Frame {
    let numbers = |f: &dyn Fn(&Reading) -> f64| Values::Number(readings.iter().map(f).collect());
    let integers =
        |f: &dyn Fn(&Reading) -> Option<i64>| Values::Integer(readings.iter().map(f).collect());
    let texts =
        |f: &dyn Fn(&Reading) -> Option<String>| Values::Text(readings.iter().map(f).collect());
    let mut frame = Frame::default()
        .with(derived::LOG, texts(&|r| Some(r.log.clone())))
        .with(derived::RUN, integers(&|r| r.run))
        .with(derived::ROW, integers(&|r| Some(r.first_row)))
        .with(derived::LAST_ROW, integers(&|r| Some(r.last_row)))
        .with(
            columns::PHASE,
            texts(&|r| r.phase.map(|p| p.name().to_owned())),
        )
        .with(derived::SAMPLES, integers(&|r| Some(r.samples)))
        .with(derived::SD_FORCE, numbers(&|r| r.sd_force_n))
        .with(derived::SD_PRESSURE, numbers(&|r| r.sd_pressure_kpa))
        .with(derived::ZERO_FORCE, numbers(&|r| r.zero_force_n))
        .with(derived::ZERO_PRESSURE, numbers(&|r| r.zero_pressure_kpa));
    let names: BTreeSet<&String> = readings.iter().flat_map(|r| r.values.keys()).collect();
    for name in names {
        frame = frame.with(name, numbers(&|r| r.value(name)));
    }
    let names: BTreeSet<&String> = readings.iter().flat_map(|r| r.labels.keys()).collect();
    for name in names {
        frame = frame.with(name, texts(&|r| r.labels.get(name).cloned()));
    }
    frame
}

/// The readings in a table written by [`to_frame`].
///
/// # Errors
/// A table that lacks one of the fixed columns.
pub fn from_frame(frame: &Frame) -> Result<Vec<Reading>> {
    let fixed = [
        derived::LOG,
        derived::RUN,
        derived::ROW,
        derived::LAST_ROW,
        columns::PHASE,
        derived::SAMPLES,
        derived::SD_FORCE,
        derived::SD_PRESSURE,
        derived::ZERO_FORCE,
        derived::ZERO_PRESSURE,
    ];
    let missing = || Error::Internal("a table of readings without its fixed columns".to_owned());
    let logs = frame.texts(fixed[0]).ok_or_else(missing)?;
    let runs = frame.integers(fixed[1]).ok_or_else(missing)?;
    let first = frame.integers(fixed[2]).ok_or_else(missing)?;
    let last = frame.integers(fixed[3]).ok_or_else(missing)?;
    let phases = frame.texts(fixed[4]).ok_or_else(missing)?;
    let samples = frame.integers(fixed[5]).ok_or_else(missing)?;
    let sd_force = frame.numbers(fixed[6]).ok_or_else(missing)?;
    let sd_pressure = frame.numbers(fixed[7]).ok_or_else(missing)?;
    let zero_force = frame.numbers(fixed[8]).ok_or_else(missing)?;
    let zero_pressure = frame.numbers(fixed[9]).ok_or_else(missing)?;
    let names = frame.columns.iter().map(|(name, _)| name.as_str());
    let others: Vec<&str> = names.filter(|n| !fixed.contains(n)).collect();
    let reading = |k: usize| Reading {
        log: logs[k].clone().unwrap_or_default(),
        run: runs[k],
        first_row: first[k].unwrap_or(0),
        last_row: last[k].unwrap_or(0),
        phase: phases[k].as_deref().and_then(phase_named),
        samples: samples[k].unwrap_or(0),
        sd_force_n: sd_force[k],
        sd_pressure_kpa: sd_pressure[k],
        zero_force_n: zero_force[k],
        zero_pressure_kpa: zero_pressure[k],
        values: others
            .iter()
            .filter_map(|name| Some(((*name).to_owned(), frame.numbers(name)?[k])))
            .filter(|(_, value)| !value.is_nan())
            .collect(),
        labels: others
            .iter()
            .filter_map(|name| Some(((*name).to_owned(), frame.texts(name)?[k].clone()?)))
            .collect(),
    };
    Ok((0..frame.height()).map(reading).collect())
}

/// The phase of that name.
pub fn phase_named(name: &str) -> Option<Phase> {
    [Phase::Pressurizing, Phase::Depressurizing]
        .into_iter()
        .find(|p| p.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_survive_the_table() {
        let reading = |k: i64| Reading {
            log: format!("test{k}.csv"),
            run: (k > 0).then_some(k),
            first_row: 10 * k,
            last_row: 10 * k + 9,
            phase: (k > 0).then_some(Phase::Depressurizing),
            samples: 10,
            sd_force_n: 0.5,
            sd_pressure_kpa: 0.25,
            zero_force_n: -5.5,
            zero_pressure_kpa: 8.9,
            values: [
                ("force_n".to_owned(), k as f64),
                ("humidity".to_owned(), 40.0),
            ]
            .into(),
            labels: [("bench".to_owned(), format!("bench {k}"))].into(),
        };
        let readings = vec![reading(0), reading(1)];
        assert_eq!(from_frame(&to_frame(&readings)).unwrap(), readings);
        assert!(from_frame(&to_frame(&[])).unwrap().is_empty());
    }
}
