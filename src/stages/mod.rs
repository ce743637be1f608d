//! The stages, in the order in which they run: ingest, clean, normalize, fit, compare, diagnose, torque, report.
//!
//! A stage is a pure function from values to values, errors among them. It knows neither the cache nor the command line; what it
//! reads and writes, and under which key, is [`crate::run`]'s business.

pub mod clean;
pub mod compare;
pub mod diagnose;
pub mod fit;
pub mod ingest;
pub mod normalize;
pub mod report;
pub mod torque;
