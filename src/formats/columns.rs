//! A table that is held in memory, for the formats whose readers give all of it at once.

use super::table::{Cells, Table, Wanted, quoted};
use pipeline_base::diagnostics::Diagnostic;

/// Columns with their names; they may differ in length, which is for the caller to judge.
#[derive(Debug, Default)]
pub struct Columns {
    names: Vec<String>,
    cells: Vec<Cells>,
    first_line: u64,
}

impl Columns {
    /// A table whose first row of data stands in row `first_line` of the file, counted from 1.
    pub fn starting_at(first_line: u64) -> Self {
        Self {
            first_line,
            ..Self::default()
        }
    }

    /// Adds a column; without a name it is known by its place.
    pub fn push(&mut self, name: impl Into<String>, cells: Cells) {
        self.names.push(name.into());
        self.cells.push(cells);
    }
}

impl Table for Columns {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn read(&self, wanted: &[Wanted]) -> Result<Vec<Cells>, Diagnostic> {
        Ok(wanted.iter().map(|w| self.cells[w.index].clone()).collect())
    }

    fn quote(&self, row: usize, index: usize) -> String {
        match self.cells.get(index) {
            Some(Cells::Numbers(numbers)) => match numbers.get(row) {
                Some(x) if !x.is_nan() => format!("\"{x}\""),
                _ => "no number".to_owned(),
            },
            Some(Cells::Texts(texts)) => match texts.get(row) {
                Some(text) if !text.trim().is_empty() => quoted(text),
                _ => "an empty cell".to_owned(),
            },
            None => "no such column".to_owned(),
        }
    }

    fn first_line(&self) -> u64 {
        self.first_line
    }
}

/// A column of texts.
pub fn texts(values: impl IntoIterator<Item = Option<String>>) -> Cells {
    Cells::Texts(values.into_iter().collect())
}
