//! Logs as text, one row a line: bytes in, columns of numbers or texts out.
//!
//! Parsing is polars'. Blanks around a number, as `printf("%f, %f")` leaves them, are taken off before; a blank line is a row without
//! numbers, so that the rows of a table and the lines of its file keep in step.

use super::dialect::Dialect;
use super::table::{Cells, LogFormat, Source, Table, Wanted, quoted, unreadable};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::frame;
use polars::prelude::*;
use std::borrow::Cow;
use std::io::Cursor;

/// Text with commas, semicolons or tabs.
pub const FORMAT: LogFormat = LogFormat {
    name: "text (CSV with comma, semicolon or tab)",
    part: None,
    recognises: |_| true,
    open,
};

/// A log of text: as it stands in the file, and as it is parsed.
struct Text<'a> {
    file: &'a str,
    original: &'a str,
    plain: Cow<'a, str>,
    dialect: Dialect,
    has_header: bool,
    names: Vec<String>,
}

fn open<'a>(source: &Source<'a>) -> Result<Box<dyn Table + 'a>, Diagnostic> {
    let original = utf8(source.file, source.bytes)?;
    let Some(first) = original.lines().find(|l| !l.trim().is_empty()) else {
        return Err(unreadable(
            source.file,
            "an empty file",
            "rows of numbers",
            "check whether the logger wrote it, or remove the [[log]]",
        ));
    };
    let dialect = Dialect::of(original);
    let name = |field: &str| field.trim().trim_matches('"').to_owned();
    Ok(Box::new(Text {
        file: source.file,
        original,
        plain: dialect.plain(original),
        dialect,
        has_header: source.has_header,
        names: first.split(dialect.separator).map(name).collect(),
    }))
}

fn utf8<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, Diagnostic> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let row = 1 + bytes[..e.valid_up_to()]
            .iter()
            .filter(|b| **b == b'\n')
            .count();
        unreadable(
            file,
            "bytes that are not UTF-8",
            "plain text",
            format!(
                "write encoding = \"latin-1\" below [format] in session.toml if the log has umlauts, µ or °; else save it as CSV in UTF-8, or in another of the \
                 formats: {}",
                super::list_of_formats()
            ),
        )
        .at_row(row as u64)
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

impl Text<'_> {
    fn schema(&self, wanted: &[Wanted]) -> Schema {
        let is_number = |k: usize| {
            let mut of_column = wanted.iter().filter(|w| w.index == k).peekable();
            of_column.peek().is_some() && of_column.all(|w| !w.as_text)
        };
        (0..self.names.len())
            .map(|k| {
                let dtype = if is_number(k) {
                    DataType::Float64
                } else {
                    DataType::String
                };
                Field::new(PlSmallStr::from(k.to_string()), dtype)
            })
            .collect()
    }

    fn parse(&self, wanted: &[Wanted]) -> PolarsResult<DataFrame> {
        let mut projection: Vec<usize> = wanted.iter().map(|w| w.index).collect();
        projection.sort_unstable();
        projection.dedup();
        CsvReadOptions::default()
            .with_has_header(self.has_header)
            .with_schema(Some(Arc::new(self.schema(wanted))))
            .with_projection(Some(Arc::new(projection)))
            .with_ignore_errors(true)
            .with_n_threads(Some(1))
            .with_rechunk(true)
            .map_parse_options(|o| {
                o.with_separator(self.dialect.separator as u8)
                    .with_truncate_ragged_lines(true)
                    .with_missing_is_null(true)
            })
            .into_reader_with_file_handle(Cursor::new(self.plain.as_bytes()))
            .finish()
    }

    /// Quotes that pair across cells or lines would join rows in silence.
    fn check_rows(&self, rows: usize) -> Result<(), Diagnostic> {
        if memchr::memchr(b'"', self.plain.as_bytes()).is_none() {
            return Ok(());
        }
        let lines = self.plain.lines().count() - usize::from(self.has_header);
        if rows == lines {
            return Ok(());
        }
        Err(unreadable(
            self.file,
            format!("quotes that join cells: {rows} rows in {lines} lines"),
            "one row a line",
            "take the quotes out, or close each in its cell",
        ))
    }

    fn parsed(&self, wanted: &[Wanted]) -> PolarsResult<Vec<Cells>> {
        let frame = self.parse(wanted)?;
        let cells = |w: &Wanted| {
            let column = frame.column(&w.index.to_string())?;
            Ok(match column.dtype() {
                DataType::Float64 => Cells::Numbers(frame::numbers(column.f64()?)),
                _ => Cells::Texts(column.str()?.clone()),
            })
        };
        wanted.iter().map(cells).collect()
    }
}

impl Table for Text<'_> {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn read(&self, wanted: &[Wanted]) -> Result<Vec<Cells>, Diagnostic> {
        if self.has_header && self.original.lines().nth(1).is_none() {
            return Ok(wanted.iter().map(|_| Cells::Numbers(Vec::new())).collect());
        }
        let cells = self.parsed(wanted).map_err(|e| {
            unreadable(
                self.file,
                quoted(&e.to_string()),
                "a table of rows",
                "open the file and look",
            )
        })?;
        self.check_rows(cells.first().map_or(0, Cells::len))?;
        Ok(cells)
    }

    fn quote(&self, row: usize, index: usize) -> String {
        let line = self
            .original
            .lines()
            .nth(row + usize::from(self.has_header));
        let cell = line.and_then(|l| l.split(self.dialect.separator).nth(index));
        match cell.map(str::trim) {
            None => "no such field".to_owned(),
            Some("") => "an empty field".to_owned(),
            Some(cell) => quoted(cell),
        }
    }

    fn first_line(&self) -> u64 {
        1 + u64::from(self.has_header)
    }
}
