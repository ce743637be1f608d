//! Figures and documents that could not be built: each is left out, named and counted, and takes nothing else with it.

use pipeline_base::error::{Error, Result, panic_message};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a report is made of beside its tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// A figure, in all its formats.
    Figure,
    /// A PDF of pages.
    Document,
}

impl Part {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Part::Figure => "figure",
            Part::Document => "document",
        }
    }
}

/// What was being done when it failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Choosing what a figure shows.
    Composing,
    /// Laying a figure out and drawing it.
    Drawing,
    /// Writing the drawing as PDF and PNG.
    Converting,
    /// Typesetting the pages of a document.
    Typesetting,
    /// Writing the page for a browser.
    Writing,
}

/// A figure or document that could not be built.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LeftOut {
    /// What it is.
    pub part: Part,
    /// Name of its files without extension, or of the document's file.
    pub name: String,
    /// What was being done.
    pub task: Task,
    /// What went wrong.
    pub why: String,
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.part.text(), self.name, self.why)
    }
}

/// What the work gives; where it fails or panics, that part is left out.
pub fn attempt<T>(
    part: Part,
    name: &str,
    task: Task,
    work: impl FnOnce() -> Result<T>,
) -> std::result::Result<T, LeftOut> {
    // Nothing that the work has touched is looked at again: what it would have given is dropped with it.
    let done = catch_unwind(AssertUnwindSafe(work));
    let why = match done {
        Ok(Ok(value)) => return Ok(value),
        Ok(Err(Error::Internal(why))) => why,
        Ok(Err(other)) => other.to_string(),
        Err(panic) => panic_message(panic.as_ref()),
    };
    Err(LeftOut {
        part,
        name: name.to_owned(),
        task,
        why,
    })
}

/// How many figures and documents were left out, in words: "1 figure and 2 documents".
pub fn counted(left_out: &[LeftOut]) -> String {
    let of = |part: Part| {
        let count = left_out.iter().filter(|l| l.part == part).count();
        let plural = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("{count} {}{plural}", part.text()))
    };
    let parts = [Part::Figure, Part::Document].into_iter().filter_map(of);
    parts.collect::<Vec<String>>().join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failing(part: Part, name: &str, work: impl FnOnce() -> Result<()>) -> LeftOut {
        attempt(part, name, Task::Drawing, work).unwrap_err()
    }

    #[test]
    fn what_fails_and_what_panics_is_named_alike() {
        let fails = failing(Part::Figure, "f620", || Err(Error::internal("no room")));
        assert_eq!(fails.to_string(), "figure f620: no room");
        let none: Vec<usize> = Vec::new();
        let panics = failing(Part::Document, "force.pdf", || {
            assert!(none[none.len()] > 0);
            Ok(())
        });
        let said = panics.to_string();
        assert!(
            said.starts_with("document force.pdf: index out of bounds"),
            "{said}"
        );
        assert_eq!(
            counted(&[fails.clone(), panics, fails]),
            "2 figures and 1 document"
        );
        assert_eq!(attempt(Part::Figure, "", Task::Drawing, || Ok(1)), Ok(1));
    }
}
