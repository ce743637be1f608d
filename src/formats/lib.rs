#![warn(missing_docs)]
//! Raw formats: what a laboratory puts below `raw/`, turned into checked values and their diagnostics.
//!
//! A log format turns bytes into a [`table::Table`] and knows nothing of sessions; [`log`] takes from the table what a session asks for,
//! so that the same content in any format gives the same rows. A log's format is told by its bytes, never by its name, and any of
//! them may be compressed ([`gzip`]).

mod columns;
pub mod csv;
mod dialect;
pub mod discover;
mod foreign;
mod guard;
mod gzip;
mod leg;
pub mod log;
pub mod log_file;
mod mat5;
mod mat73;
pub mod overview;
mod parquet;
mod session_checks;
mod session_columns;
mod session_joint;
mod session_sd;
mod session_specimen;
pub mod session_toml;
mod shared_logs;
pub mod table;
pub mod text_format;
mod words;
mod workspace;
mod xlsx;

use table::LogFormat;

/// Every log format; the first that knows the bytes as its own reads them, and text is what nobody else knows.
pub const FORMATS: &[LogFormat] = &[
    xlsx::FORMAT,
    parquet::FORMAT,
    mat5::FORMAT,
    mat73::FORMAT,
    csv::FORMAT,
];

/// The formats as a list for a message or a help text.
pub fn list_of_formats() -> String {
    let names: Vec<&str> = FORMATS.iter().map(|f| f.name).collect();
    names.join(", ")
}
