//! Raw formats: what a laboratory puts below `raw/`, turned into checked values and their diagnostics.
//!
//! A log format turns bytes into a [`csv::RawLog`] and knows nothing of sessions.

pub mod csv;
pub mod discover;
mod leg;
mod session_columns;
mod session_joint;
pub mod session_toml;
mod words;
