//! Names, numbers and sentences made of the values of [`pipeline_findings`]. The report and the command line take theirs from here, so that
//! one thing has one name and one quantity one value wherever it is read.
//!
//! | module | what |
//! |---|---|
//! | [`number`] | errors, probabilities, sizes and units as people read them |
//! | [`name`] | effects, columns, random effects, sources of error, reasons |
//! | [`sentence`] | the answer of a campaign in sentences |
//!
//! Architecture invariant: text goes out of here and is never read back; whoever has to decide something reads the values.

pub mod name;
pub mod number;
pub mod sentence;
#[cfg(test)]
pub(crate) mod tests;

pub use pipeline_inference::decisions::{ALIKE, COMES_IN, LEVEL as SIGNIFICANT};

/// An error is lower than another, and not by chance of the last digit, if it is below this share of it.
pub const CLEARLY_LOWER: f64 = 0.98;
