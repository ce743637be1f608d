//! One number of a table, as `pipeline explain` is asked for it: `FILE:LINE:COLUMN`.

use crate::explain::on_disk;
use crate::places::Places;
use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_golden::table::Table;
use std::collections::BTreeMap;

/// Formats of a table in which no cell is looked up: their lines are not rows.
const PRINTED: [&str; 3] = [".md", ".tex", ".typ"];

/// One number of a table, with what its row says of where it belongs.
pub(super) struct Number {
    pub line: usize,
    pub column: String,
    pub value: String,
    /// Campaign, session and so on, by column.
    pub row: BTreeMap<String, String>,
}

/// `FILE:LINE:COLUMN` in its parts.
///
/// # Errors
/// A line without a column.
pub(super) fn place(artifact: &str) -> Result<(&str, Option<(usize, &str)>)> {
    let mut parts = artifact.rsplitn(3, ':');
    if let (Some(column), Some(line), Some(file)) = (parts.next(), parts.next(), parts.next())
        && let Ok(line) = line.parse()
    {
        return Ok((file, Some((line, column))));
    }
    match artifact.rsplit_once(':') {
        Some((file, line)) if file.contains('.') && line.parse::<usize>().is_ok() => {
            Err(Error::Usage(format!(
                "{artifact} names a line but no column; a number is FILE:LINE:COLUMN, such as {artifact}:value"
            )))
        }
        _ => Ok((artifact, None)),
    }
}

/// The cell of a table at a line of its file, counted from 1 with the header, and a column: its name, or its number from 1.
pub(super) fn number(
    places: &Places,
    output: &str,
    (line, column): (usize, &str),
) -> Result<Number> {
    let path = on_disk(places, output);
    let shown = path.display();
    if !output.ends_with(".csv") {
        let printed = PRINTED
            .iter()
            .find_map(|ending| output.strip_suffix(ending));
        let instead = printed.map_or_else(String::new, |stem| {
            let csv = on_disk(places, &format!("{stem}.csv"));
            format!(": {}:LINE:{column}", csv.display())
        });
        return Err(Error::Usage(format!(
            "{shown} has no cells to look up; a number is FILE:LINE:COLUMN of a table in CSV{instead}"
        )));
    }
    let table = Table::read(&path)?;
    let by_name = table.column(column);
    let by_number = || column.parse::<usize>().ok()?.checked_sub(1);
    let at = by_name.or_else(by_number);
    let at = at.filter(|at| *at < table.columns.len());
    let at = at.ok_or_else(|| {
        let near = nearest(column, table.columns.iter().map(String::as_str));
        let hint = near.map_or_else(
            || format!("; it has {}", table.columns.join(", ")),
            |near| format!("; did you mean {near}?"),
        );
        Error::Usage(format!("{shown} has no column {column}{hint}"))
    })?;
    let row = line.checked_sub(2).and_then(|k| table.rows.get(k));
    let row = row.ok_or_else(|| {
        Error::Usage(format!(
            "{shown} has no row on line {line}: its rows are on lines 2 to {}",
            table.rows.len() + 1
        ))
    })?;
    let named = table.columns.iter().cloned().zip(row.iter().cloned());
    Ok(Number {
        line,
        column: table.columns[at].clone(),
        value: row[at].clone(),
        row: named.collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_a_line_and_a_column_behind_the_file() {
        let parts = |artifact| place(artifact).unwrap();
        assert_eq!(
            parts("tables/a.csv:12:rmse"),
            ("tables/a.csv", Some((12, "rmse")))
        );
        assert_eq!(parts("tables/a.csv"), ("tables/a.csv", None));
        assert_eq!(parts("C:\\x:y"), ("C:\\x:y", None));
        assert!(place("tables/a.csv:12").is_err());
    }
}
