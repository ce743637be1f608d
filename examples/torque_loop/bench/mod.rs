//! The benchmark of the loop on torque: simulated joints, an effect put into some of them, searched, and judged on what was found.
//!
//! | file | idea |
//! |---|---|
//! | [`joint`] | the joints |
//! | [`trial`] | one joint of the benchmark, searched; how large its effect is; what was found |
//! | [`table`] | the table in Markdown, with the bars |
//! | [`digest`] | the answers for four fixed joints as one number |
//!
//! Shared by the example `torque_loop` and by the tests; shares and digests are those of the example `closed_loop`.

// The example and the tests each use a part, and the tests have the shared files in both benchmarks.
#![allow(dead_code, clippy::duplicate_mod)]

pub mod digest;
#[path = "../../closed_loop/bench/findings_digest.rs"]
mod findings_digest;
pub mod joint;
#[path = "../../closed_loop/bench/rate.rs"]
mod rate;
pub mod table;
pub mod trial;
