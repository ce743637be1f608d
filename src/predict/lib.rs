#![warn(missing_docs)]
//! Prediction: the force of a muscle that somebody describes, with an interval for a muscle that was not measured.
//!
//! | file | idea |
//! |---|---|
//! | [`muscle`] | a muscle and its contraction as they are described; what makes no sense |
//! | [`law`] | which fit, or which published model, answers |
//! | [`interval`] | the interval |
//! | [`answer`] | the answer at one state: force, interval, what lies outside of what was measured, every other model |
//! | [`calibration`] | a muscle of which some readings are known |
//! | [`sweep`] | answers along one quantity, and the designer's table |
//! | [`inverse`] | the pressure or length for a force |
//! | [`design`] | the shortest muscle that meets a curve of force or torque |
//! | [`difference`] | whether two fits say the same force, at a stated margin |
//! | [`torque`] | the torque over the range of a knee, beside a human muscle |
//!
//! Pure: fits in, numbers out. Reading `derived/fits.json`, units and printing are the command line's ([`pipeline_cli`]).
//!
//! # The interval
//! It is to hold, in 95 of 100 cases, one steady reading of the force of **a specimen that was not measured**, of the same make, on the
//! same rig, in the range that was measured. Its force is F = k f(x) + e, with f the law, k the specimen's gain and e what is left
//! around its own curve. What is predicted is f^(x), the joint fit (Eq. 9) at the state x, and the variance of F - f^(x) is taken as
//!
//! ```text
//! s^2 = (G - 1)/G sum_g (f_g(x) - f^(x))^2     the fit itself: jackknife over the G specimens (Tukey 1958; Efron 1982), f_g without g
//!     + tau^2 f^(x)^2                          gains of specimens: the same fraction everywhere   (stages::fit::scatter)
//!     + sigma^2                                readings around a specimen's own curve, in N           (stages::fit::scatter)
//!     + s_e^2                                  where eps_620 was not given
//! interval: f^(x) -/+ t(0.975; G - q) s, cut off at zero
//! ```
//! with q the coefficients of the law of length that were fitted (b1 and b2, or b1 alone): G - q are the degrees of freedom of tau^2, the
//! largest part in the middle of the measured lengths; at their ends the fit's part can be larger, and at forces of a few newtons sigma^2.
//! s_e is half the change of the force when eps_620 moves from one standard deviation below the mean of the specimens to one above, times
//! sqrt(1 + 1/G): a muscle whose eps_620 nobody measured has one of that
//! distribution. Given a relative contraction, the force does not depend on it.
//!
//! Assumptions, in the order in which they would hurt: the specimens measured are a sample of those that will be built; they differ by a
//! factor, the same at every pressure and contraction (what does not fit into a factor is counted in sigma); the law has the right shape,
//! for what it misses everywhere is seen by sigma only on the average; tau and the jackknife's part are independent, which errs on the
//! wide side. Between G - q = 1 and 2 degrees of freedom the interval is very wide (t = 12.7 and 4.3): two or three muscles say little
//! about the next one. Without G > q there is no interval, and none for published models, which print no scatter of specimens.
//!
//! The coverage is measured on simulated campaigns in `tests/it/predict_coverage.rs`, with eps_620 given and inside the measured lengths:
//! the simulator makes just what the first three assumptions say, so it tests the arithmetic and the degrees of freedom, not whether real
//! muscles keep to them. The part s_e has not been measured.

pub mod answer;
pub mod calibration;
pub mod design;
pub mod difference;
pub mod interval;
pub mod inverse;
pub mod law;
pub mod muscle;
pub mod sweep;
pub mod torque;

pub use answer::{Answer, Predictor};
pub use law::{Choice, Law};
pub use muscle::{Contraction, FreeLength, Muscle};
