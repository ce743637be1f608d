//! What is wrong with an input, said so that a person can mend it.
//!
//! A diagnostic names the file (relative to its raw directory, so that outputs are the same on every machine), the row and the
//! column, what was found, what was expected, and what to do.

use crate::names::plain_path;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};

/// How much is lost through the defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Nothing is lost, but somebody should know.
    Note,
    /// Rows or a log are left out; the session is used.
    Warning,
    /// The session is left out.
    Error,
}

/// One defect of one input file. Its texts are boxed, because they never grow and a diagnostic is returned as an error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Diagnostic {
    /// How much is lost.
    pub severity: Severity,
    /// The file, relative to the raw directory (or as given on the command line, for a configuration).
    pub file: Box<str>,
    /// Line in the file, counted from 1.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub row: Option<u64>,
    /// Column or key.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub column: Option<Box<str>>,
    /// What stands there.
    pub found: Box<str>,
    /// What should stand there.
    pub expected: Box<str>,
    /// What to do about it.
    pub hint: Box<str>,
}

impl Diagnostic {
    /// An error: the session is left out.
    pub fn error(
        file: impl Into<Box<str>>,
        found: impl Into<Box<str>>,
        expected: impl Into<Box<str>>,
        hint: impl Into<Box<str>>,
    ) -> Self {
        Self {
            severity: Severity::Error,
            file: file.into(),
            row: None,
            column: None,
            found: found.into(),
            expected: expected.into(),
            hint: hint.into(),
        }
    }

    /// The same defect with another severity.
    pub fn with_severity(mut self, severity: Severity) -> Self {
        self.severity = severity;
        self
    }

    /// The same defect, with its line counted from 1.
    pub fn at_row(mut self, row: u64) -> Self {
        self.row = Some(row);
        self
    }

    /// The same defect, with the column or key in which it stands.
    pub fn in_column(mut self, column: impl Into<Box<str>>) -> Self {
        self.column = Some(column.into());
        self
    }

    /// The same defect, with the path of its file, which was named relative to this folder.
    pub fn below(mut self, folder: &Path) -> Self {
        let file = Path::new(&*self.file);
        let below = plain_path(file).map_or_else(|| file.to_owned(), PathBuf::from);
        self.file = folder.join(below).display().to_string().into();
        self
    }

    /// File, row and column in the form that editors turn into a link.
    pub fn place(&self) -> String {
        let mut place = self.file.to_string();
        if let Some(row) = self.row {
            place.push_str(&format!(":{row}"));
        }
        if let Some(column) = &self.column {
            place.push_str(&format!(" [{column}]"));
        }
        place
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let label = match self.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        let (place, found) = (self.place(), shown(&self.found));
        let (expected, hint) = (&self.expected, &self.hint);
        write!(
            f,
            "{label}: {}: found {found}; expected {}; {}",
            shown(&place),
            shown(expected),
            shown(hint)
        )
    }
}

/// A text of which parts may come from a file, as it may be shown: control characters, which would steer a terminal, by their codes, and no
/// more than a few lines.
fn shown(text: &str) -> String {
    const MOST: usize = 2000;
    let mut shown = String::with_capacity(text.len().min(MOST));
    for (k, c) in text.chars().enumerate() {
        if k == MOST {
            shown.push_str("...");
            break;
        }
        if c.is_control() && c != '\n' {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// The known name nearest to `name`, if one is near enough to be a slip of the finger.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|k| (strsim::damerau_levenshtein(name, k), k))
        .min_by_key(|(distance, k)| (*distance, *k))
        .filter(|(distance, k)| *distance <= 1 + k.len().max(name.len()) / 3)
        .map(|(_, k)| k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagnostic_reads_as_one_line_with_place_found_expected_and_hint() {
        let d = Diagnostic::error(
            "a/session.toml",
            "-182",
            "a positive length in mm",
            "write the distance between the hose clamps",
        )
        .at_row(12)
        .in_column("specimen.rest_length_mm");
        assert_eq!(
            d.to_string(),
            "error: a/session.toml:12 [specimen.rest_length_mm]: found -182; expected a positive length in mm; \
             write the distance between the hose clamps"
        );
    }

    #[test]
    fn nearest_finds_slips_and_leaves_strangers_alone() {
        let known = ["force", "pressure", "time"];
        assert_eq!(nearest("presure", known), Some("pressure"));
        assert_eq!(nearest("froce", known), Some("force"));
        assert_eq!(nearest("humidity", known), None);
    }
}
