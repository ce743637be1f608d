#![warn(missing_docs)]
//! The mechanics: pure equations of actuators and joints. What these lack is in `pipeline_effects`, which stands above it, so that an edit of an
//! effect redoes no stage before the search.
//!
//! | module | idea |
//! |---|---|
//! | [`models`] | one file a force model: equations, published coefficients, domain |
//! | [`knee`] | joints, routes, moment arms, torque of actuators and of human muscles |
//!
//! Architecture invariant: no I/O, no data frame, no fitting. Transcendental functions come from `libm`, so equal inputs give equal bits on every platform.

pub mod knee;
pub mod models;
