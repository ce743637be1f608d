//! Diagnose.
pub mod base;
pub mod data;
pub mod model;
pub mod term;
pub mod candidates;
pub mod linear;
pub mod search;
pub mod findings;
