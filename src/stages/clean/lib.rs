#![warn(missing_docs)]
//! Clean: from a session's logs to its steady readings, with everything that was left out and why.
//!
//! | step | file |
//! |---|---|
//! | rows that are no measurements: text, impossible values, a clock that runs backwards, spikes | [`screen`] |
//! | the zero of the force channel | [`zero`] |
//! | steady plateaus of a time series, one reading each | [`steady`] |
//! | rows of points, one reading each | [`points`] |
//!
//! Only what is declared is corrected: the zero that the zero log states. Drift, gain, compliance and the zero of the pressure are left
//! in the readings on purpose; to find them is the business of the stage `diagnose`, which could not find what was silently removed
//! here.

pub mod points;
pub mod screen;
pub mod steady;
pub mod zero;

use pipeline_base::columns::FORCE;
use pipeline_base::reading::Reading;
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::session::{Sampling, Session};
use pipeline_config::CleanOptions;
use pipeline_ingest::LogSamples;
use screen::Screened;
use serde::{Deserialize, Serialize};
use zero::{Zero, ZeroSource};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// What clean says of a session beside its readings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CleanHeader {
    /// The zero of the force channel; none for torque sessions.
    pub zero: Option<Zero>,
    /// Everything that was left out.
    pub rejects: Vec<Reject>,
    /// Rows that were looked at, zero logs included.
    pub rows: u64,
}

/// What clean gives for one session.
#[derive(Clone, Debug, PartialEq)]
pub struct Cleaned {
    /// Everything but the readings.
    pub header: CleanHeader,
    /// The readings, log by log in the order of time or row.
    pub readings: Vec<Reading>,
}

/// Cleans the logs of one session.
pub fn clean(session: &Session, logs: &[LogSamples], options: &CleanOptions) -> Cleaned {
    let mut rejects = Vec::new();
    let screened: Vec<Screened> = logs
        .iter()
        .filter_map(|log| screen::screen(session, log, options, &mut rejects))
        .collect();
    let mut readings = Vec::new();
    for log in screened.iter().filter(|l| !l.log.spec.is_zero) {
        match session.sampling {
            Sampling::Timeseries => {
                steady::readings(session, log, options, &mut readings, &mut rejects)
            }
            Sampling::Points => points::readings(session, log, &mut readings, &mut rejects),
        }
    }
    for log in screened.iter().filter(|l| !l.log.spec.is_zero) {
        let name = log.log.spec.name();
        if !readings.iter().any(|r| r.log == name) {
            let reason = "no steady reading in it";
            rejects.push(nothing(session, name, Extent::Log, reason));
        }
    }
    let zero = session.column(FORCE).map(|column| {
        zero::determine(column, &screened, &readings, options.zero, session.sampling)
    });
    if let Some(zero) = &zero {
        take_off(zero, &mut readings);
    }
    if readings.is_empty() {
        let reason = match logs.iter().any(|log| !log.spec.is_zero) {
            true => "no steady reading is left",
            false => "none of its logs can be read",
        };
        rejects.push(nothing(session, String::new(), Extent::Session, reason));
    }
    Cleaned {
        header: CleanHeader {
            zero,
            rejects,
            rows: logs.iter().map(|l| l.len() as u64).sum(),
        },
        readings,
    }
}

/// Takes the zero of the force off all readings.
fn take_off(zero: &Zero, readings: &mut [Reading]) {
    for reading in readings {
        reading.zero_pressure_kpa = zero.zero_log_pressure_kpa.unwrap_or(f64::NAN);
        if let Some(force) = reading.values.get_mut(FORCE) {
            *force -= zero.applied_n;
            reading.zero_force_n = match zero.source {
                ZeroSource::None => f64::NAN,
                _ => zero.applied_n,
            };
        }
    }
}

/// A log or a session of which no reading is left.
fn nothing(session: &Session, log: String, extent: Extent, reason: &str) -> Reject {
    Reject {
        session: session.id.clone(),
        log,
        first_row: None,
        last_row: None,
        count: 0,
        extent,
        reason: reason.to_owned(),
    }
}
