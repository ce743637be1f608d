//! C99, also for C++: no dependencies but the mathematics library.

use super::{Comment, File, Language, source};
use crate::model::Model;

/// C.
pub const LANGUAGE: Language = Language { name: "C99", files };

const COMMENT: Comment = Comment {
    first: "/*\n",
    line: " * ",
    last: "\n */",
};

fn files(model: &Model) -> Vec<File> {
    let of = |template| source(template, &COMMENT, model);
    vec![
        ("bpa_model.h", of(include_str!("../templates/bpa_model.h"))),
        ("bpa_model.c", of(include_str!("../templates/bpa_model.c"))),
    ]
}
