#![warn(missing_docs)]
//! The test rig in software: a truth file in, a campaign of raw sessions out.
//!
//! [`read_truth`] checks the truth file, [`simulate`] measures it in memory, [`write()`](fn@write) puts it below a folder and the
//! truth that was drawn into a file outside of it; [`rows`] skips the logs and gives their steady readings, [`campaign_rows()`] the
//! same as normalised rows, for tests and benchmarks with many seeds.
//!
//! | file | idea |
//! |---|---|
//! | [`truth`], `truth_lists`, [`coefficients`], [`rig_settings`] | the truth file, strictly read |
//! | [`calendar`], [`schedule`], [`logged_columns`], [`effect_tables`], [`effect_places`] | its optional parts: dates, points, columns, effects |
//! | [`draw`], [`effect_draws`] | gains, zeros, pressures and sizes of effects, session by session |
//! | [`staircase`] | pressure over time |
//! | [`effects`] | one file an effect: operators on the chain |
//! | [`moment`], [`setting`], [`chain`] | length, pressure, force, sensor: where effects work |
//! | `log`, `session_file`, `number` | the bytes of the files |
//! | [`steady`], [`campaign_rows`](mod@campaign_rows) | steady readings without logs, and their rows |
//! | [`rig_like`] | campaigns that scatter as a laboratory's rig does, as rows: what the residual search is judged on |
//! | [`write`](mod@write) | folders |
//!
//! Architecture invariant: everything but [`write`](mod@write) is a pure function of the truth file. Transcendental functions come
//! from `libm` and random numbers from ChaCha8 ([`pipeline_base::random`]), so that equal truth files give equal bytes on every machine.

pub mod calendar;
pub mod campaign_rows;
pub mod chain;
pub mod coefficients;
pub mod draw;
pub mod effect_draws;
pub mod effect_places;
pub mod effect_tables;
pub mod effects;
mod log;
pub mod logged_columns;
pub mod moment;
mod number;
pub mod rig_like;
pub mod rig_settings;
pub mod schedule;
mod session_file;
pub mod setting;
pub mod staircase;
pub mod steady;
pub mod truth;
mod truth_lists;
pub mod write;

#[cfg(test)]
mod tests;

pub use campaign_rows::{CampaignRows, campaign_rows};
pub use draw::{DrawnSession, DrawnTruth};
pub use steady::{SteadyRow, rows};
pub use truth::{Truth, read_truth};
pub use write::{Written, write};

use pipeline_base::session::Sampling;

/// One session folder in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SessionFiles {
    /// Folder below the campaign's, with a forward slash.
    pub folder: String,
    /// Names and contents; `session.toml` comes first.
    pub files: Vec<(String, Vec<u8>)>,
}

/// A simulated campaign in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// The folders.
    pub sessions: Vec<SessionFiles>,
    /// What the logs do not say.
    pub drawn: DrawnTruth,
}

/// Measures a campaign.
pub fn simulate(truth: &Truth) -> Campaign {
    let drawn = DrawnTruth::new(truth);
    let sessions = drawn.sessions.iter().map(|s| files(&drawn, s)).collect();
    Campaign { sessions, drawn }
}

fn files(drawn: &DrawnTruth, session: &DrawnSession) -> SessionFiles {
    let text = session_file::text(drawn, session);
    let mut files = vec![("session.toml".to_owned(), text.into_bytes())];
    let sampling = drawn.truth.sampling;
    if sampling == Sampling::Timeseries {
        let zero = log::zero_log(drawn, session);
        files.push((session_file::ZERO_LOG.to_owned(), zero));
    }
    for (k, run) in drawn.truth.runs.iter().enumerate() {
        let bytes = match sampling {
            Sampling::Timeseries => log::run_log(drawn, session, k),
            Sampling::Points => log::points_log(drawn, session, k),
        };
        files.push((session_file::log_name(sampling, run.number), bytes));
    }
    SessionFiles {
        folder: session.folder.clone(),
        files,
    }
}
