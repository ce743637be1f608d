//! A table as a CSV file holds it: texts, by RFC 4180.

use pipeline_base::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::Path;

/// A table of texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Names of the columns, in order.
    pub columns: Vec<String>,
    /// The rows; each as long as `columns`.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or is no table.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(Error::io("read", path))?;
        let unreadable = |what| Error::Usage(format!("{} is no table: {what}", path.display()));
        Self::parse(&text).map_err(unreadable)
    }

    /// Parses comma separated values with one header line; what is wrong with them, if anything.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        let mut rows = records(text)?.into_iter();
        let columns = rows.next().ok_or("it is empty")?;
        let rows: Vec<Vec<String>> = rows.collect();
        match rows.iter().position(|r| r.len() != columns.len()) {
            Some(k) => Err(format!(
                "row {} has {} fields, the header has {}",
                k + 1,
                rows[k].len(),
                columns.len()
            )),
            None => Ok(Self { columns, rows }),
        }
    }

    /// The place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }

    /// The places of the rows by the texts of their key columns; rows of one key get an ordinal, in their order. A column that is missing
    /// counts as empty.
    pub fn by_key(&self, key: &[String]) -> BTreeMap<(Vec<&str>, usize), usize> {
        let places: Vec<Option<usize>> = key.iter().map(|k| self.column(k)).collect();
        let mut rows = BTreeMap::new();
        let mut seen: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
        for (k, row) in self.rows.iter().enumerate() {
            let of = |place: &Option<usize>| place.map_or("", |p| row[p].as_str());
            let texts: Vec<&str> = places.iter().map(of).collect();
            let ordinal = seen.entry(texts.clone()).or_default();
            *ordinal += 1;
            rows.insert((texts, *ordinal), k);
        }
        rows
    }
}

/// The records of a text; a quoted field may hold commas, line ends and doubled quotes.
fn records(text: &str) -> std::result::Result<Vec<Vec<String>>, String> {
    let mut records = Vec::new();
    let (mut record, mut field, mut quoted) = (Vec::new(), String::new(), false);
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        match c {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                field.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => record.push(std::mem::take(&mut field)),
            '\r' if !quoted && characters.peek() == Some(&'\n') => {}
            '\n' if !quoted => {
                record.push(std::mem::take(&mut field));
                records.push(std::mem::take(&mut record));
            }
            c => field.push(c),
        }
    }
    if quoted {
        return Err("a quoted field does not end".to_owned());
    }
    if !(record.is_empty() && field.is_empty()) {
        record.push(field);
        records.push(record);
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_hold_commas_line_ends_and_quotes() {
        let table = Table::parse("a,b\r\n\"x, \"\"y\"\"\nz\",1\n,\n").unwrap();
        assert_eq!(table.columns, ["a", "b"]);
        assert_eq!(table.rows, [["x, \"y\"\nz", "1"], ["", ""]]);
        assert!(Table::parse("").is_err());
        assert!(
            Table::parse("a,b\n1\n")
                .unwrap_err()
                .contains("row 1 has 1 fields")
        );
        assert!(Table::parse("a\n\"b\n").is_err());
    }

    #[test]
    fn rows_of_one_key_get_an_ordinal() {
        let table = Table::parse("k,v\na,1\nb,2\na,3\n").unwrap();
        let rows = table.by_key(&["k".to_owned()]);
        assert_eq!(rows[&(vec!["a"], 1)], 0);
        assert_eq!(rows[&(vec!["a"], 2)], 2);
        assert_eq!(rows[&(vec!["b"], 1)], 1);
    }
}
