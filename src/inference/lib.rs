// The engine prints nothing: what it finds are values.
#![deny(clippy::print_stderr, clippy::print_stdout, clippy::dbg_macro)]
//! One mixed model, and what is asked of it.
//!
//! y_i = h(x_i; theta, phi, b) + m_i + e_i: a forward model with coefficients theta, amplitudes phi of effects, random effects b of groups, a smooth
//! misfit m and noise e. Linearised about the mode of b, y is Gaussian; every answer is a query of that one model.
//!
//! | module | idea |
//! |---|---|
//! | [`decisions`] | the numbers that decide what is answered |
//! | [`problem`] | what a problem tells the engine: readings with their groups, forward model with derivatives, components, terms |
//! | [`tree`], [`gram`], [`system`] | the hierarchy of groups, sums of products, and the factor from which likelihood, gradient, estimates and projections follow |
//! | [`variance`] | maximum of the likelihood over the standard deviations |
//! | [`fit`] | the nonlinear model: linearise, estimate, move, again |
//! | [`statistic`], [`screen`] | what may be added, and how improbable the strongest candidate is: a bootstrap of the maximum |
//! | [`search`] | forward, deletions, swaps; what does as well in the place of what was found |
//! | [`power`] | how strong a direction has to be to be found |
//! | [`profile`] | intervals |
//! | [`form`] | whether a term's size is one number: gain and probability of further columns at the root with one variance |
//! | [`query`] | of a fitted model: what a component gains and its interval, estimates by group, what rests on the misfit's prior |
//! | [`heldout`] | predictive density, budget, and errors after a few readings of groups that took no part |
//!
//! Architecture invariant: nothing here knows force or torque, session or actuator, reads or writes, or makes a sentence. Random numbers come from the
//! caller, one stream a draw, so that the number of threads does not matter.

#![warn(missing_docs)]
// Elimination and substitution are written as in the textbooks, by index.
#![allow(clippy::needless_range_loop)]

#[cfg(test)]
mod decision_tests;
pub mod decisions;
#[cfg(test)]
mod dense_tests;
pub mod fit;
pub mod form;
pub mod gram;
pub mod heldout;
pub mod power;
pub mod problem;
pub mod profile;
pub mod query;
#[cfg(test)]
mod reference_tests;
#[cfg(test)]
mod root_tests;
pub mod screen;
pub mod search;
#[cfg(test)]
mod starts_tests;
pub mod statistic;
pub mod system;
pub mod tree;
pub mod variance;
