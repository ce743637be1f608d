#![warn(missing_docs)]
//! Raw formats: what a laboratory puts below `raw/`, turned into checked values and their diagnostics.
//!
//! A log format turns bytes into a [`table::Table`] and knows nothing of sessions; [`log`] takes from the table what a session asks for,
//! so that the same content in any format gives the same rows. A log's format is told by its bytes, never by its name, and any of
//! them may be compressed ([`gzip`]).

mod columns;
mod dialect;
pub mod discover;
mod foreign;
mod guard;
mod gzip;
mod leg;
pub mod log;
pub mod log_file;
pub mod overview;
mod session_checks;
mod session_columns;
mod session_joint;
mod session_sd;
mod session_specimen;
pub mod session_toml;
mod shared_logs;
pub mod table;
pub mod text_format;
mod unnamed_logs;
mod words;
mod workspace;

use table::LogFormat;

/// Declares the files of the log formats and lists these, so that both stand in one line a format.
macro_rules! log_formats {
    ($($visibility:vis $file:ident,)+) => {
        $($visibility mod $file;)+

        /// Every log format; the first that recognises the bytes reads them, and what none recognises is read as text.
        pub const FORMATS: &[LogFormat] = &[$($file::FORMAT),+];
    };
}

// rustfmt does not follow modules declared by a macro: check them with `rustfmt --edition 2024 --check src/formats/*.rs`.
log_formats! {
    xlsx,
    parquet,
    mat5,
    mat73,
    pub csv,
}

/// The formats as a list for a message or a help text.
pub fn list_of_formats() -> String {
    let names: Vec<&str> = FORMATS.iter().map(|f| f.name).collect();
    names.join(", ")
}
