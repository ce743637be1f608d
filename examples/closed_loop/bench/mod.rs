//! The benchmark of the loop: campaigns that scatter as a rig does, an effect put into some of them, searched, and judged on what was found.
//!
//! | file | idea |
//! |---|---|
//! | [`cases`] | what is put in, and how a size of the findings becomes one of the simulator |
//! | [`trial`] | one campaign of the benchmark; how large its effect is |
//! | [`plan`] | all of them |
//! | [`judge`] | what a search found against what was put in |
//! | [`outcome`] | what is kept of a search: one line of the log |
//! | [`progress`] | running them in parallel, and not running again what the log has |
//! | [`rate`] | shares with their bounds, medians |
//! | [`table`] | the table in Markdown, with the bars |
//! | [`digest`] | the answers for twelve fixed campaigns as one number |
//! | [`findings_digest`] | findings as one number |
//!
//! Shared by the example `closed_loop` and by the tests.

// The example and the tests each use a part.
#![allow(dead_code)]

pub mod cases;
pub mod digest;
pub mod findings_digest;
pub mod judge;
pub mod outcome;
pub mod plan;
pub mod progress;
pub mod rate;
pub mod search;
pub mod table;
pub mod trial;
