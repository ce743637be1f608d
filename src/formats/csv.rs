//! Comma-separated logs: bytes in, columns of numbers or words out.
//!
//! Parsing is polars'. Blanks around a number, as `printf("%f, %f")` leaves them, are taken off before; a blank line is a row without
//! numbers, so that the rows of a table and the lines of its file keep in step. A cell that is not a number becomes NaN and is counted, with the first few quoted; what follows from it is for
//! the clean stage to decide. Only what makes the whole file unreadable is an error here.

use super::words::{are_words, number, words};
use crate::base::diagnostics::{Diagnostic, Severity};
use crate::base::session::{Cells, Position};
use polars::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;

/// A line longer than this is no line of a log, bytes.
pub const LONGEST_LINE: usize = 64 * 1024;

/// How many bad cells of a log are quoted; the others are counted.
const QUOTED_CELLS: usize = 3;

/// What is wanted of a log: one entry a column, in the order in which the values come back.
#[derive(Clone, Debug)]
pub struct Request {
    /// The name for messages.
    pub name: String,
    /// Where it stands.
    pub position: Position,
    /// Whether numbers or words stand there.
    pub cells: Cells,
    /// Texts and the numbers that stand for them, where the column holds states and not numbers.
    pub codes: Vec<(String, f64)>,
}

/// A cell that is not a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadCell {
    /// Line in the file, counted from 1.
    pub line: u64,
    /// Name of the column.
    pub column: String,
    /// What stands there.
    pub found: String,
    /// How many such cells the column has in this log.
    pub of: usize,
}

/// A log as read: one vector a requested column, all of one length.
#[derive(Clone, Debug, Default)]
pub struct RawLog {
    /// Values in the order of the requests; NaN where the cell is no number. A column of words has none.
    pub columns: Vec<Vec<f64>>,
    /// The columns of words, by the place of their request; none where the cell is empty.
    pub words: BTreeMap<usize, Vec<Option<String>>>,
    /// The first bad cells.
    pub bad_cells: Vec<BadCell>,
    /// All bad cells.
    pub bad_cell_count: usize,
    /// Line in the file of the first row of data, counted from 1.
    pub first_line: u64,
}

/// Checks, without holding the file in memory, that no line is longer than [`LONGEST_LINE`].
///
/// # Errors
/// The line that is too long. System errors are passed on.
pub fn check_line_lengths(
    file: &str,
    mut read: impl std::io::Read,
) -> std::io::Result<Result<(), Diagnostic>> {
    let mut chunk = vec![0_u8; LONGEST_LINE];
    let (mut line, mut length) = (1_u64, 0_usize);
    loop {
        let n = read.read(&mut chunk)?;
        if n == 0 {
            return Ok(Ok(()));
        }
        let mut rest = &chunk[..n];
        while let Some(end) = rest.iter().position(|b| *b == b'\n') {
            if length + end > LONGEST_LINE {
                return Ok(Err(too_long(file, line)));
            }
            length = 0;
            line += 1;
            rest = &rest[end + 1..];
        }
        length += rest.len();
        if length > LONGEST_LINE {
            return Ok(Err(too_long(file, line)));
        }
    }
}

fn too_long(file: &str, line: u64) -> Diagnostic {
    fatal(
        file,
        format!("a line of more than {LONGEST_LINE} bytes"),
        "lines of a few numbers",
        "check that the file is a log and has line ends",
    )
    .at_row(line)
}

fn fatal(file: &str, found: String, expected: &str, hint: &str) -> Diagnostic {
    Diagnostic::error(file, found, expected, hint).with_severity(Severity::Warning)
}

/// Reads the requested columns; messages call the log `file`.
///
/// # Errors
/// The file is empty, has a header and no rows, is not UTF-8, or lacks a column.
pub fn read(file: &str, bytes: &[u8], requests: &[Request]) -> Result<RawLog, Diagnostic> {
    let text = without_blanks(utf8(file, bytes)?);
    let text = text.as_ref();
    let has_header = requests
        .iter()
        .any(|r| matches!(r.position, Position::Name(_)));
    let Some(first) = text.lines().find(|l| !l.trim().is_empty()) else {
        return Err(fatal(
            file,
            "an empty file".to_owned(),
            "rows of numbers",
            "check whether the logger wrote it, or remove the [[log]]",
        ));
    };
    let fields: Vec<&str> = first
        .split(',')
        .map(|f| f.trim().trim_matches('"'))
        .collect();
    let indices = locate(file, &fields, requests)?;
    let lines = DataLines::new(text, has_header);
    if lines.iter().next().is_none() {
        return Err(fatal(
            file,
            "a header and no rows".to_owned(),
            "rows of numbers below the header",
            "check whether the logger was stopped at once, or remove the [[log]]",
        ));
    }
    let frame = parse(text, fields.len(), has_header, &indices, requests).map_err(|e| {
        fatal(
            file,
            format!("\"{e}\""),
            "a comma-separated table",
            "open the file and look",
        )
    })?;
    collect(&frame, &lines, &indices, requests).map_err(|e| {
        fatal(
            file,
            format!("\"{e}\""),
            "numbers",
            "open the file and look",
        )
    })
}

fn utf8<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, Diagnostic> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let row = 1 + bytes[..e.valid_up_to()]
            .iter()
            .filter(|b| **b == b'\n')
            .count();
        fatal(
            file,
            "bytes that are not UTF-8".to_owned(),
            "plain text",
            "export the log as CSV in UTF-8; a spreadsheet or binary file is not one",
        )
        .at_row(row as u64)
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The text without blanks beside separators and line ends.
fn without_blanks(text: &str) -> Cow<'_, str> {
    if !text.contains([' ', '\t']) {
        return Cow::Borrowed(text);
    }
    let mut clean = String::with_capacity(text.len());
    for line in text.lines() {
        for (k, field) in line.split(',').enumerate() {
            if k > 0 {
                clean.push(',');
            }
            clean.push_str(field.trim());
        }
        clean.push('\n');
    }
    Cow::Owned(clean)
}

/// The index of every requested column among the fields of the first line.
fn locate(file: &str, fields: &[&str], requests: &[Request]) -> Result<Vec<usize>, Diagnostic> {
    let missing = |request: &Request, wanted: String, list: String| {
        fatal(
            file,
            list,
            &wanted,
            "correct [columns] in session.toml, or the log",
        )
        .at_row(1)
        .in_column(request.name.as_str())
    };
    requests
        .iter()
        .map(|request| match &request.position {
            Position::Index(index) if *index < fields.len() => Ok(*index),
            Position::Index(index) => Err(missing(
                request,
                format!("a column with index {index} (counted from 0)"),
                format!("{} columns", fields.len()),
            )),
            Position::Name(name) => fields.iter().position(|f| f == name).ok_or_else(|| {
                missing(
                    request,
                    format!("a column named \"{name}\""),
                    format!("the header {}", fields.join(", ")),
                )
            }),
        })
        .collect()
}

/// Where the rows of data stand in the text.
struct DataLines<'a> {
    text: &'a str,
    skip: usize,
}

impl<'a> DataLines<'a> {
    fn new(text: &'a str, has_header: bool) -> Self {
        Self {
            text,
            skip: usize::from(has_header),
        }
    }

    /// Line numbers counted from 1 with their text, rows of data only.
    fn iter(&self) -> impl Iterator<Item = (u64, &'a str)> {
        self.text
            .lines()
            .enumerate()
            .map(|(k, line)| (k as u64 + 1, line))
            .skip(self.skip)
    }
}

fn parse(
    text: &str,
    width: usize,
    has_header: bool,
    indices: &[usize],
    requests: &[Request],
) -> PolarsResult<DataFrame> {
    let is_text = |k: usize| {
        indices
            .iter()
            .zip(requests)
            .any(|(i, r)| *i == k && is_read_as_text(r))
    };
    let wanted = |k: usize| indices.contains(&k);
    let schema: Schema = (0..width)
        .map(|k| {
            let numeric = wanted(k) && !is_text(k);
            let dtype = if numeric {
                DataType::Float64
            } else {
                DataType::String
            };
            Field::new(PlSmallStr::from(k.to_string()), dtype)
        })
        .collect();
    let mut projection: Vec<usize> = indices.to_vec();
    projection.sort_unstable();
    projection.dedup();
    CsvReadOptions::default()
        .with_has_header(has_header)
        .with_schema(Some(Arc::new(schema)))
        .with_projection(Some(Arc::new(projection)))
        .with_ignore_errors(true)
        .with_n_threads(Some(1))
        .with_rechunk(true)
        .map_parse_options(|o| {
            o.with_truncate_ragged_lines(true)
                .with_missing_is_null(true)
        })
        .into_reader_with_file_handle(Cursor::new(text.as_bytes()))
        .finish()
}

fn is_read_as_text(request: &Request) -> bool {
    has_text_codes(request) || request.cells != Cells::Numbers
}

/// Whether a column of states holds words; where every state is written as a number it is read as one.
fn has_text_codes(request: &Request) -> bool {
    request
        .codes
        .iter()
        .any(|(text, _)| text.parse::<f64>().is_err())
}

fn collect(
    frame: &DataFrame,
    lines: &DataLines,
    indices: &[usize],
    requests: &[Request],
) -> PolarsResult<RawLog> {
    let mut log = RawLog {
        first_line: lines.iter().next().map_or(1, |(line, _)| line),
        ..RawLog::default()
    };
    for (place, (index, request)) in indices.iter().zip(requests).enumerate() {
        let column = frame.column(&index.to_string())?;
        let mut values = if has_text_codes(request) {
            coded(column.str()?, request)
        } else if request.cells != Cells::Numbers {
            let texts = column.str()?;
            if request.cells == Cells::Words || are_words(texts) {
                log.words.insert(place, words(texts));
                log.columns.push(Vec::new());
                continue;
            }
            texts.iter().map(|t| t.map_or(f64::NAN, number)).collect()
        } else {
            let numbers = column.f64()?;
            numbers.iter().map(|x| x.unwrap_or(f64::NAN)).collect()
        };
        if !request.codes.is_empty() && !has_text_codes(request) {
            recode(&mut values, request);
        }
        quote_bad_cells(&values, lines, *index, request, &mut log);
        log.columns.push(values);
    }
    log.bad_cells.sort_by_key(|c| c.line);
    log.bad_cells.truncate(QUOTED_CELLS);
    Ok(log)
}

fn coded(texts: &StringChunked, request: &Request) -> Vec<f64> {
    let code = |text: &str| {
        request
            .codes
            .iter()
            .find(|(raw, _)| raw == text.trim())
            .map_or(f64::NAN, |(_, code)| *code)
    };
    texts.iter().map(|t| t.map_or(f64::NAN, code)).collect()
}

fn recode(values: &mut [f64], request: &Request) {
    let table: Vec<(f64, f64)> = request
        .codes
        .iter()
        .filter_map(|(text, code)| Some((text.parse().ok()?, *code)))
        .collect();
    for value in values {
        *value = table
            .iter()
            .find(|(raw, _)| raw == value)
            .map_or(f64::NAN, |(_, code)| *code);
    }
}

/// Counts what is not finite and quotes the first of it from the text.
fn quote_bad_cells(
    values: &[f64],
    lines: &DataLines,
    index: usize,
    request: &Request,
    log: &mut RawLog,
) {
    let bad = values.iter().filter(|x| !x.is_finite()).count();
    if bad == 0 {
        return;
    }
    log.bad_cell_count += bad;
    let quoted = lines
        .iter()
        .zip(values)
        .filter(|(_, x)| !x.is_finite())
        .take(QUOTED_CELLS)
        .map(|((line, text), _)| BadCell {
            line,
            column: request.name.clone(),
            found: match text.split(',').nth(index).map(str::trim) {
                None => "no such field".to_owned(),
                Some("") => "an empty field".to_owned(),
                Some(cell) => format!("\"{}\"", cell.chars().take(40).collect::<String>()),
            },
            of: bad,
        });
    log.bad_cells.extend(quoted);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_index(indices: &[usize]) -> Vec<Request> {
        indices
            .iter()
            .map(|i| Request {
                name: format!("c{i}"),
                position: Position::Index(*i),
                cells: Cells::Numbers,
                codes: Vec::new(),
            })
            .collect()
    }

    fn by_name(name: &str) -> Vec<Request> {
        vec![Request {
            name: name.to_owned(),
            position: Position::Name(name.to_owned()),
            cells: Cells::Numbers,
            codes: Vec::new(),
        }]
    }

    #[test]
    fn columns_come_in_the_order_of_the_requests_and_may_repeat() {
        let log = read("t", b"1,2,3\r\n4,5,6\r\n", &by_index(&[2, 0, 2])).unwrap();
        assert_eq!(
            log.columns,
            [vec![3.0, 6.0], vec![1.0, 4.0], vec![3.0, 6.0]]
        );
        assert_eq!(log.bad_cell_count, 0);
    }

    #[test]
    fn cells_that_are_no_numbers_are_counted_and_quoted_with_their_line() {
        let text = b"1,2\nx,3\n5\n nan ,inf\n7, 8 \n";
        let log = read("t", text, &by_index(&[0, 1])).unwrap();
        assert_eq!(log.columns[0].len(), 5, "{:?}", log.columns);
        assert_eq!((log.columns[0][4], log.columns[1][4]), (7.0, 8.0));
        assert_eq!(log.bad_cell_count, 4);
        let quoted: Vec<(u64, &str)> = log
            .bad_cells
            .iter()
            .map(|c| (c.line, c.found.as_str()))
            .collect();
        assert_eq!(quoted, [(2, "\"x\""), (3, "no such field"), (4, "\"nan\"")]);
    }

    #[test]
    fn a_blank_line_is_a_row_without_numbers_and_lines_keep_their_count() {
        for text in ["1,2\n\nx,4\n", "1,2\r\n\r\nx,4\r\n", " 1, 2\n\nx, 4\n"] {
            let log = read("t", text.as_bytes(), &by_index(&[0])).unwrap();
            assert_eq!(log.columns[0].len(), 3, "{text:?} {:?}", log.columns);
            assert_eq!(log.bad_cells.last().unwrap().line, 3, "{text:?}");
        }
    }

    #[test]
    fn a_missing_column_names_what_there_is() {
        let error = read("t", b"a,b\n1,2\n", &by_name("force")).unwrap_err();
        assert!(error.found.contains("a, b") && error.expected.contains("force"));
        let error = read("t", b"1,2\n", &by_index(&[2])).unwrap_err();
        assert!(error.found.contains("2 columns") && error.expected.contains("index 2"));
    }

    #[test]
    fn empty_header_only_and_foreign_bytes_are_told_apart() {
        assert!(
            read("t", b"", &by_index(&[0]))
                .unwrap_err()
                .found
                .contains("empty")
        );
        assert!(
            read("t", b" \n\n", &by_index(&[0]))
                .unwrap_err()
                .found
                .contains("empty")
        );
        let only = read("t", b"force\n", &by_name("force")).unwrap_err();
        assert!(only.found.contains("header"));
        let foreign = read("t", b"1,2\n\xff\xfe,3\n", &by_index(&[0])).unwrap_err();
        assert_eq!(
            (foreign.found.contains("UTF-8"), foreign.row),
            (true, Some(2))
        );
    }

    #[test]
    fn states_are_coded_whether_written_as_numbers_or_words() {
        let mut request = by_index(&[1]);
        request[0].codes = vec![("1".into(), 10.0), ("2".into(), 20.0)];
        let log = read("t", b"0,1\n0,2\n0,7444\n", &request).unwrap();
        assert_eq!(log.columns[0][..2], [10.0, 20.0]);
        assert_eq!((log.bad_cell_count, log.bad_cells[0].line), (1, 3));
        request[0].codes = vec![("up".into(), 10.0), ("down".into(), 20.0)];
        let log = read("t", b"0,up\n0, down\n", &request).unwrap();
        assert_eq!(log.columns[0], [10.0, 20.0]);
    }

    #[test]
    fn a_line_without_end_is_refused_before_it_is_read() {
        let endless = std::io::repeat(b'1');
        let refused = check_line_lengths("t", endless).unwrap();
        assert!(refused.unwrap_err().found.contains("more than"));
        assert!(check_line_lengths("t", &b"1,2\n3,4"[..]).unwrap().is_ok());
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_first_column() {
        let log = read("t", "\u{feff}force,p\n1,2\n".as_bytes(), &by_name("force")).unwrap();
        assert_eq!(log.columns[0], [1.0]);
    }
}
