//! The stages, in the order in which they run: ingest, clean, normalize, fit, compare, diagnose, torque, report.
//!
//! A stage is a pure function from values to values, errors among them. It knows neither the cache nor the command line; what it
//! reads and writes, and under which key, is [`crate::run`]'s business.

pub use pipeline_clean as clean;
pub use pipeline_compare as compare;
pub use pipeline_diagnose as diagnose;
pub use pipeline_fit as fit;
pub use pipeline_ingest as ingest;
pub use pipeline_normalize as normalize;
pub use pipeline_torque as torque;

pub mod report;
