#![warn(missing_docs)]
//! Prediction: the force of a muscle that somebody describes, or of which there are a few readings, with an interval.
//!
//! | file | idea |
//! |---|---|
//! | [`muscle`] | a muscle and its contraction as they are described; what makes no sense |
//! | [`law`] | which law answers: that of a mixed model, a fit by least squares, or a published model |
//! | [`interval`] | the interval |
//! | [`answer`] | the answer at one state: force, interval, what each effect does, what lies outside of what was measured, every other model |
//! | [`sweep`] | answers along one quantity, and the designer's table |
//! | [`inverse`] | the pressure or length for a force |
//! | [`design`] | the shortest muscle that meets a curve of force or torque |
//! | [`difference`] | whether two fits say the same force, at a stated margin |
//! | [`torque`] | the torque over the range of a knee, beside a human muscle |
//!
//! Pure: fits and mixed models in, numbers out. Reading `derived/`, units and printing are the command line's ([`pipeline_cli`]).
//!
//! # Whose force
//! The law is that of the mixed model ([`pipeline_diagnose::mixed_law`]): coefficients, effects and smooth misfit, estimated together. The force is that
//! of the **actuator** at the length and pressure that are given: effects of the rig that the search found (zeros and gains of sensors, a frame that
//! yields, an offset of all lengths) are in the model, so that the coefficients are free of them, and not in the force. What the rig would read is one
//! option away ([`pipeline_diagnose::mixed_law::Whose`]). Which effects did what is part of the answer.
//!
//! # The interval
//! It is to hold, in 95 of 100 cases, the force of **a specimen that was not measured**, of the same make, in a session of its own whose length is set as
//! well as those of the rig are (or to a standard deviation that is given), in the range that was measured: mean -/+ t(0.975; nu) s, cut off at zero, with s^2
//! the sum of
//!
//! ```text
//! estimation     coefficients, effects and common misfit: their joint covariance
//! gain           of the specimen                                           (of a pool also gain and zero of a campaign)
//! lengths        resting and contracted length of the specimen: as declared, else rounded to 1 mm, the contracted one with the scatter that was found
//! set length     of the session
//! misfit         of session and stroke; near the onset of the force also what readings there show beside the law
//! zero, noise    of what the rig reads only
//! eps_620        where it was not given, instead of the error of a contracted length: half the change of the force from one standard deviation below
//!                the mean of the specimens to one above, times sqrt(1 + 1/G)
//! ```
//! and nu the degrees of freedom of such a sum by Satterthwaite. Readings of the muscle change mean and covariance of all that is not known, by Bayes' rule.
//!
//! Assumptions, in the order in which they would hurt: the specimens measured are a sample of those that will be built; what they scatter is a gain and a
//! length; the misfit of the law is smooth. Without a mixed model there is no interval: a campaign of one specimen or of hardly any readings, and a pool that
//! is too large to be assessed, have a fit by least squares alone. None for published models, which print no scatter of specimens.
//!
//! The coverage is measured on simulated campaigns in `tests/it/predict_coverage.rs` and on the laboratory's rig in `tests/it/rig.rs`; `docs/predict.md` has
//! the numbers. The part of eps_620 has not been measured.

pub mod answer;

pub mod design;
pub mod difference;
pub mod interval;
pub mod inverse;
pub mod law;
pub mod muscle;
pub mod sweep;
pub mod torque;

pub use answer::{Answer, Predictor};
pub use law::{Choice, Fitted, Law, Laws};
pub use muscle::{Contraction, FreeLength, Muscle};
