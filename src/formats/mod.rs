//! Raw formats: what a laboratory puts below `raw/`, turned into checked values and their diagnostics.
//!
//! A log format is one file here and one line in [`LOG_FORMATS`]; it turns bytes into [`csv::RawLog`] and knows nothing of sessions.

pub mod csv;
pub mod discover;
pub mod session_toml;
