#![warn(missing_docs)]
//! The mechanics: pure equations of actuators, rigs and joints.
//!
//! | module | idea |
//! |---|---|
//! | [`models`] | one file a force model: equations, published coefficients, domain |
//! | [`effects`] | one file an effect: what a force model or a rig may lack, as an operator on the forward model |
//! | [`knee`] | joints, routes, moment arms, torque of actuators and of human muscles |
//!
//! Architecture invariant: no I/O, no data frame, no fitting. Transcendental functions come from `libm`, so equal inputs give equal bits on every platform.

pub mod effects;
pub mod knee;
pub mod models;
