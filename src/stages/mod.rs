//! The stages, in the order in which they run.

pub mod clean;
pub mod ingest;
pub mod normalize;
