#![warn(missing_docs)]
//! What everything else stands on: units, column names, tables, readings and rows, diagnostics, errors and seeded
//! random numbers.
//!
//! Architecture invariant: nothing in here knows a stage, a model, the cache or the command line.

pub mod columns;
pub mod date;
pub mod diagnostics;
pub mod digest;
pub mod error;
pub mod frame;
pub mod group;
pub mod json;
pub mod names;
pub mod normalized;
pub mod random;
pub mod reading;
pub mod reject;
pub mod row;
pub mod session;
pub mod toml_reader;
pub mod toml_syntax;
pub mod units;
