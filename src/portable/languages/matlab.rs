//! MATLAB and Octave: one function with several outputs, and the names that the other languages have.

use super::{Comment, File, Language, source};
use crate::model::Model;

/// MATLAB.
pub const LANGUAGE: Language = Language {
    name: "MATLAB and Octave",
    files,
};

const COMMENT: Comment = Comment {
    first: "",
    line: "% ",
    last: "",
};

fn files(model: &Model) -> Vec<File> {
    let force = include_str!("../templates/bpa_force.m");
    let gradient = include_str!("../templates/bpa_force_gradient.m");
    let domain = include_str!("../templates/bpa_domain.m");
    vec![
        ("bpa_force.m", source(force, &COMMENT, model)),
        ("bpa_force_gradient.m", gradient.to_owned()),
        ("bpa_domain.m", domain.to_owned()),
    ]
}
