//! What the files of a folder are.

use super::{Comment, File, Language, fill};
use crate::golden::POINTS;
use crate::model::Model;

/// The page.
pub const LANGUAGE: Language = Language {
    name: "README",
    files,
};

/// Lines of code in Markdown.
const COMMENT: Comment = Comment {
    first: "```text\n",
    line: "",
    last: "\n```",
};

fn files(model: &Model) -> Vec<File> {
    let places = [
        ("HEADER", COMMENT.of(model)),
        ("TITLE", model.title.clone()),
        ("DIAMETER_MM", model.diameter_mm.to_string()),
        ("POINTS", POINTS.to_string()),
    ];
    vec![(
        "README.md",
        fill(include_str!("../templates/README.md"), &places),
    )]
}
