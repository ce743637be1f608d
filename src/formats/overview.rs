//! A log as it is before anybody has said what its columns are: every column with its place and its cells.

use super::log::{self, RawLog, Request};
use super::table::Table;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::{Cells, Part, Position};
use std::collections::BTreeSet;

/// A column that nobody has described yet.
#[derive(Clone, Debug)]
pub struct Undescribed {
    /// Where it stands.
    pub position: Position,
    /// Its numbers, NaN where there is none; nothing where it holds words.
    pub numbers: Vec<f64>,
    /// Its words; nothing where it holds numbers.
    pub words: Vec<Option<String>>,
}

/// Every column of a log: by name where the first row names columns, by index else. Columns without a name among named ones, and
/// further columns of one name, cannot be asked for and are left out.
///
/// # Errors
/// The log cannot be read.
pub fn overview(
    file: &str,
    bytes: &[u8],
    part: Option<&Part>,
) -> Result<Vec<Undescribed>, Diagnostic> {
    let positions = log::with_table(file, bytes, part, true, |table| Ok(positions(table)))?;
    let requests: Vec<Request> = positions
        .iter()
        .map(|position| Request {
            name: place(position),
            position: position.clone(),
            cells: Cells::Either,
            codes: Vec::new(),
        })
        .collect();
    let RawLog { columns, words, .. } = log::read(file, bytes, part, &requests)?;
    let of_place = |(k, (position, numbers))| Undescribed {
        position,
        numbers,
        words: words.get(&k).cloned().unwrap_or_default(),
    };
    let places = positions.into_iter().zip(columns).enumerate();
    Ok(places.map(of_place).collect())
}

/// A column's place in words.
pub fn place(position: &Position) -> String {
    match position {
        Position::Index(index) => format!("column {index}"),
        Position::Name(name) => name.clone(),
    }
}

fn positions(table: &dyn Table) -> Vec<Position> {
    let names = table.names();
    let is_word = |name: &String| !name.is_empty() && name.parse::<f64>().is_err();
    if !names.iter().any(is_word) {
        return (0..names.len()).map(Position::Index).collect();
    }
    let mut seen = BTreeSet::new();
    names
        .iter()
        .filter(|name| !name.is_empty() && seen.insert(name.as_str()))
        .map(|name| Position::Name(name.clone()))
        .collect()
}
