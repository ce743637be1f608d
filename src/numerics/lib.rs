#![warn(missing_docs)]
//! Numerical methods: slices in, vectors out.
//!
//! | module | idea |
//! |---|---|
//! | [`real`] | numbers that carry exact derivatives |
//! | [`matrix`], [`qr`], [`covariance`] | dense linear least squares and what it says about uncertainty |
//! | [`trust_region`], [`levenberg_marquardt`], [`fit`] | nonlinear least squares: one step, one minimum, one report |
//! | [`bounds`], [`loss`], [`dual_problem`] | box constraints, robust losses, problems written as a closure |
//! | [`lar`] | the statistics that the papers printed, reproduced under their own name |
//! | [`plateaus`] | the steady stretches of a staircase of pressure |
//! | [`special`], [`distributions`] | incomplete beta and gamma functions, and the distributions made of them |
//! | [`statistics`] | sums, quantiles, goodness of fit |
//! | [`interpolate`], [`cubic_spline`] | curves through knots |
//! | [`group_polynomials`] | estimating equations of groups that are left out or taken several times |
//! | [`jackknife`], [`running`] | intervals from refits without a group; running medians and the normal quantile plot |
//!
//! Architecture invariant: nothing here does I/O, sees a data frame, keeps a global, starts a thread or draws a random number.
//! Sums run in slice order and transcendental functions come from `libm`, so equal inputs give equal bits on every platform.

pub mod bounds;
pub mod cholesky;
pub mod covariance;
pub mod cubic_spline;
pub mod distributions;
pub mod dual_problem;
pub mod fit;
mod fit_report;
pub mod group_polynomials;
pub mod interpolate;
pub mod jackknife;
pub mod lar;
mod lar_scale;
pub mod levenberg_marquardt;
pub mod loss;
pub mod matrix;
pub mod plateaus;
mod problem;
pub mod qr;
pub mod real;
pub mod running;
pub mod special;
pub mod statistics;
pub mod trust_region;
