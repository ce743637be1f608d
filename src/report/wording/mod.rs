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

use pipeline_findings::CampaignFindings;

/// Probability below which a test has found something, but for [`level`].
pub const SIGNIFICANT: f64 = 0.05;
/// Level at which the loop lets something into a model of forces.
pub const OF_FORCES: f64 = 0.02;
/// Level at which the loop lets something into a model.
pub fn level(found: &CampaignFindings) -> f64 {
    match found.kind.as_str() {
        "knee-torque" => SIGNIFICANT,
        _ => OF_FORCES,
    }
}

/// Log-likelihoods that differ by less tell nothing apart.
pub const ALIKE: f64 = 2.0;
