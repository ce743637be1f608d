//! The stages, in the order in which they run.

pub mod clean;
pub mod compare;
pub mod fit;
pub mod ingest;
pub mod normalize;
pub mod report;
