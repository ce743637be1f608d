//! `[format]` of a `session.toml`: what a text log needs before it is a table. A preamble is cut off, and what is not UTF-8 becomes it.

use crate::log::{self, RawLog, Request};
use crate::table::unreadable;
use crate::{FORMATS, csv, foreign, gzip};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::{Encoding, Part, TextFormat};
use pipeline_base::toml_reader::Section;
use std::borrow::Cow;

/// Most lines of a preamble.
const MOST_ROWS: i64 = 10_000;

/// The table; mistakes go to its reader.
pub fn text_format(table: &Section) -> TextFormat {
    let skip_rows = table.get("skip_rows").and_then(|entry| {
        let rows = entry.integer()?;
        if (0..=MOST_ROWS).contains(&rows) {
            return Some(rows as u64);
        }
        let expected = format!("a number of lines from 0 to {MOST_ROWS}");
        entry.reject(
            &expected,
            "count the lines above the header or the first row",
        );
        None
    });
    let encodings = [("utf-8", Encoding::Utf8), ("latin-1", Encoding::Latin1)];
    let encoding = table.get("encoding").and_then(|e| e.choice(&encodings));
    table.close();
    TextFormat {
        skip_rows: skip_rows.unwrap_or_default(),
        encoding: encoding.unwrap_or_default(),
    }
}

/// Reads a log as [`log::read`] does, after what its text format asks for. Lines count from the first one of the file.
///
/// # Errors
/// Those of [`log::read`], and a format for text where the log is none.
pub fn read(
    (file, bytes): (&str, &[u8]),
    format: TextFormat,
    part: Option<&Part>,
    requests: &[Request],
) -> Result<RawLog, Diagnostic> {
    if format == TextFormat::default() {
        return log::read(file, bytes, part, requests);
    }
    let text = applied(file, bytes, format)?;
    let below = |mut diagnostic: Diagnostic| {
        diagnostic.row = diagnostic.row.map(|row| row + format.skip_rows);
        diagnostic
    };
    let mut log = log::read(file, &text, part, requests).map_err(below)?;
    log.first_line += format.skip_rows;
    for cell in &mut log.bad_cells {
        cell.line += format.skip_rows;
    }
    Ok(log)
}

/// The bytes of a log without its preamble, in UTF-8.
///
/// # Errors
/// The log is no text, or has no more lines than are to be skipped.
pub fn applied<'a>(
    file: &str,
    bytes: &'a [u8],
    format: TextFormat,
) -> Result<Cow<'a, [u8]>, Diagnostic> {
    if format == TextFormat::default() {
        return Ok(Cow::Borrowed(bytes));
    }
    let unpacked = gzip::unpacked(file, bytes)?;
    let other =
        |f: &&crate::table::LogFormat| f.name != csv::FORMAT.name && (f.recognises)(&unpacked);
    if let Some(other) = FORMATS.iter().find(other) {
        return Err(unreadable(
            file,
            format!("a log of the format {}", other.name),
            "text, for which alone [format] is",
            "remove [format] from session.toml",
        ));
    }
    let text = match format.encoding {
        Encoding::Utf8 => unpacked.into_owned(),
        Encoding::Latin1 => unpacked
            .iter()
            .map(|b| char::from(*b))
            .collect::<String>()
            .into_bytes(),
    };
    let skipped = match format.skip_rows {
        0 => Some(0),
        rows => memchr::memchr_iter(b'\n', &text)
            .nth(rows as usize - 1)
            .map(|end| end + 1),
    };
    match skipped {
        Some(start) => Ok(Cow::Owned(text[start..].to_vec())),
        None => Err(unreadable(
            file,
            format!("{} lines", text.split(|b| *b == b'\n').count()),
            format!("more than the {} of `skip_rows`", format.skip_rows),
            "correct `skip_rows` in [format]",
        )),
    }
}

/// Whether a log is text, but not in UTF-8: its encoding has to be given.
pub fn lacks_encoding(bytes: &[u8]) -> bool {
    let Ok(unpacked) = gzip::unpacked("", bytes) else {
        return false;
    };
    let is_other = FORMATS
        .iter()
        .any(|f| f.name != csv::FORMAT.name && (f.recognises)(&unpacked));
    !is_other
        && foreign::refuse("", &unpacked, "").is_ok()
        && std::str::from_utf8(&unpacked).is_err()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_base::session::{Cells, Position};

    fn force() -> Vec<Request> {
        vec![Request {
            name: "force".to_owned(),
            position: Position::Name("Kraft (N), \u{b1}".to_owned()),
            cells: Cells::Numbers,
            codes: Vec::new(),
        }]
    }

    #[test]
    fn a_preamble_in_latin_1_is_skipped_and_lines_keep_their_numbers() {
        let log = b"Pr\xfcfstand 2\nBediener: J\xe4ger\nKraft (N), \xb1;p\n1,5;2\nx;3\n";
        let format = TextFormat {
            skip_rows: 2,
            encoding: Encoding::Latin1,
        };
        let read_as = |format| read(("t", log), format, None, &force());
        let found = read_as(format).unwrap();
        assert_eq!(found.columns[0][0], 1.5);
        assert_eq!((found.first_line, found.bad_cells[0].line), (4, 5));
        let none = TextFormat::default();
        assert!(read_as(none).unwrap_err().found.contains("UTF-8"));
        let all = TextFormat {
            skip_rows: 9,
            ..format
        };
        assert!(read_as(all).unwrap_err().found.contains("lines"));
    }
}
