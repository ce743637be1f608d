//! The test rig in software: a truth file in, a campaign of raw sessions out.
//!
//! [`read_truth`] checks the truth file, [`simulate`] measures it in memory, [`write()`](fn@write) puts it below a folder and the
//! truth that was drawn into a file outside of it; [`rows`] skips the logs and gives their steady readings, for tests with many
//! seeds.
//!
//! | file | idea |
//! |---|---|
//! | [`truth`], `truth_lists`, [`coefficients`], [`rig_settings`] | the truth file, strictly read |
//! | [`draw`] | strengths, zeros and pressures of the sessions |
//! | [`staircase`] | pressure over time |
//! | [`chain`] | length, pressure, force, sensor: where effects belong |
//! | `log`, `session_file`, `number` | the bytes of the files |
//! | [`steady`] | steady readings without logs |
//! | [`write`](mod@write) | folders |
//!
//! Architecture invariant: everything but [`write`](mod@write) is a pure function of the truth file. Transcendental functions come
//! from `libm` and random numbers from ChaCha8 ([`crate::base::random`]), so that equal truth files give equal bytes on every machine.

pub mod chain;
pub mod coefficients;
pub mod draw;
mod log;
mod number;
pub mod rig_settings;
mod session_file;
pub mod staircase;
pub mod steady;
pub mod truth;
mod truth_lists;
pub mod write;

#[cfg(test)]
mod tests;

pub use draw::{DrawnSession, DrawnTruth};
pub use steady::{SteadyRow, rows};
pub use truth::{Truth, read_truth};
pub use write::{Written, write};

use crate::base::session::Sampling;

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
    for run in &drawn.truth.runs {
        let bytes = match sampling {
            Sampling::Timeseries => log::run_log(drawn, session, *run),
            Sampling::Points => log::points_log(drawn, session, *run),
        };
        files.push((session_file::log_name(sampling, run.number), bytes));
    }
    SessionFiles {
        folder: session.folder.clone(),
        files,
    }
}
