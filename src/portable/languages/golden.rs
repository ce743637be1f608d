//! The points that every language is held to.

use super::{File, Language};
use crate::golden;
use crate::model::Model;

/// The points.
pub const LANGUAGE: Language = Language {
    name: "golden vectors",
    files,
};

fn files(model: &Model) -> Vec<File> {
    vec![("golden_vectors.csv", golden::csv(model))]
}
