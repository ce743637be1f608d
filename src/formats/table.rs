//! What a log format is: bytes in, a table of columns out.

use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::session::{Part, PartKind};
use polars::prelude::StringChunked;

/// No log is larger than this once it is decompressed, bytes: what claims to be is a mistake or an attack.
pub const LARGEST_LOG: u64 = 1 << 30;

/// A log format.
pub struct LogFormat {
    /// The name for messages.
    pub name: &'static str,
    /// What the parts of such a file are, where it may hold several tables.
    pub part: Option<PartKind>,
    /// Whether some bytes are of this format: a look at their beginning.
    pub recognises: fn(&[u8]) -> bool,
    /// Opens the table.
    pub open: for<'a> fn(&Source<'a>) -> Result<Box<dyn Table + 'a>, Diagnostic>,
}

/// A log file, before anything is known of it.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The name for messages.
    pub file: &'a str,
    /// Its contents, not empty and not compressed.
    pub bytes: &'a [u8],
    /// Which of its tables is wanted, where one is named.
    pub part: Option<&'a Part>,
    /// Whether the first row of a sheet or text names the columns.
    pub has_header: bool,
}

/// A column to be read.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Place in the table, counted from 0.
    pub index: usize,
    /// Whether its cells may be words.
    pub as_text: bool,
}

/// The cells of a column.
#[derive(Clone, Debug)]
pub enum Cells {
    /// Numbers; NaN where there is none.
    Numbers(Vec<f64>),
    /// Texts, of which all may be numbers; null where nothing stands.
    Texts(StringChunked),
}

impl Cells {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Cells::Numbers(numbers) => numbers.len(),
            Cells::Texts(texts) => texts.len(),
        }
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A log as its file holds it.
pub trait Table {
    /// The names of the columns, one each: cells of the first row, names of variables, or nothing where a matrix has none.
    fn names(&self) -> &[String];

    /// The wanted columns, in that order.
    ///
    /// # Errors
    /// Contents that the format does not allow.
    fn read(&self, wanted: &[Wanted]) -> Result<Vec<Cells>, Diagnostic>;

    /// What stands in a cell, for a message; `row` counts rows of data from 0.
    fn quote(&self, row: usize, index: usize) -> String;

    /// Line or row in the file of the first row of data, counted from 1.
    fn first_line(&self) -> u64;
}

/// A defect for which a log is left out; the session goes on without it.
pub fn unreadable(
    file: &str,
    found: impl Into<Box<str>>,
    expected: impl Into<Box<str>>,
    hint: impl Into<Box<str>>,
) -> Diagnostic {
    Diagnostic::error(file, found, expected, hint).with_severity(Severity::Warning)
}

/// A text in a message, between quotes and not longer than a line holds.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.chars().take(40).collect::<String>())
}
