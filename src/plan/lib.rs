#![warn(missing_docs)]
#![deny(clippy::print_stderr, clippy::print_stdout, clippy::dbg_macro)]
//! A campaign that has not been measured yet: what it could show, what error to expect on unseen specimens, and what would lower it.
//!
//! | module | has |
//! |---|---|
//! | [`design`] | the campaign as it is planned, and its reading from a file |
//! | [`draw`] | readings as it would give them: the law, and scatter drawn with the sizes that are expected |
//! | [`foresee`] | the residual search on several such draws, and on those of designs that have one thing more |
//!
//! Nothing is computed in another way than it will be: the planned campaign is drawn without any effect, and the search that will be made of the
//! readings is made of the draws. Its detection limits, aliases and expected errors are those that the campaign will have, but for what its scatter
//! will be in fact. A number is the median over the draws.

pub mod design;
pub mod draw;
pub mod foresee;
