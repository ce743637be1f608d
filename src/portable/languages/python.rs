//! Python with NumPy: scalars and arrays.

use super::{Comment, File, Language, source};
use crate::model::Model;

/// Python.
pub const LANGUAGE: Language = Language {
    name: "Python (NumPy)",
    files,
};

pub(super) const COMMENT: Comment = Comment {
    first: "",
    line: "# ",
    last: "",
};

fn files(model: &Model) -> Vec<File> {
    let template = include_str!("../templates/bpa_model.py");
    vec![("bpa_model.py", source(template, &COMMENT, model))]
}
