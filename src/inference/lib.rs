#![warn(missing_docs)]
//! One mixed model, and what is asked of it.
#[cfg(test)]
mod dense_tests;
pub mod fit;
pub mod gram;
pub mod heldout;
pub mod problem;
pub mod profile;
pub mod screen;
pub mod search;
pub mod statistic;
pub mod system;
pub mod tree;
pub mod variance;
