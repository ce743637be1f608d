#![warn(missing_docs)]
//! A model of the static force as source code of other languages, which controllers, simulations and designs take in.
//!
//! Every language has the same function, `bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa)` in N, its gradient and its
//! domain, and is held to the same points (`golden_vectors.csv`).
//!
//! | file | idea |
//! |---|---|
//! | [`law`] | the one form of the law that all languages have, with its derivatives |
//! | [`domain`] | the box of the readings fitted, and the bounded continuation beyond it |
//! | [`model`] | a law with its domain and what has to be said of it |
//! | [`source`] | a model from a fit, or from published coefficients |
//! | [`effects`] | a model from the loop's answer: coefficients with effects, and which effects a static function of an actuator can hold |
//! | [`golden`] | the points |
//! | [`header`] | what stands at the head of every file |
//! | [`languages`] | one file a language, with its template in `templates/` |
//!
//! A language is one file and one line in [`languages::LANGUAGES`].
//!
//! Pure: fits and findings in, text out. Deliberately absent: effects of the rig, for they stay where the rig is.

pub mod domain;
pub mod effects;
pub mod golden;
pub mod header;
pub mod languages;
pub mod law;
pub mod model;
pub mod source;
#[cfg(test)]
mod tests;

pub use languages::LANGUAGES;
pub use model::Model;
