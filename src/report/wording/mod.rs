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

/// Level at which the loop lets something into a model.
pub const COMES_IN: f64 = 0.02;
/// Probability below which any other test has found something.
pub const SIGNIFICANT: f64 = 0.05;

/// Log-likelihoods that differ by less tell nothing apart.
pub const ALIKE: f64 = 2.0;
