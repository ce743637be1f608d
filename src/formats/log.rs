//! What a session wants of a log, taken from a table of any format.
//!
//! A cell that is not a number becomes NaN and is counted, with the first few quoted; what follows from it is for the clean stage to
//! decide. Only what makes the whole log unreadable is an error here.

use super::table::{Cells as Column, LogFormat, Source, Table, Wanted, unreadable};
use super::words::{are_words, number, words};
use super::{FORMATS, foreign, gzip, list_of_formats};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::{Cells, Part, Position};
use polars::prelude::StringChunked;
use std::collections::BTreeMap;

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

/// Reads the requested columns from the bytes of a log in any format; messages call it `file`.
///
/// # Errors
/// The bytes are no log, the log is empty, has a header and no rows, or lacks a column or the part that is asked for.
pub fn read(
    file: &str,
    bytes: &[u8],
    part: Option<&Part>,
    requests: &[Request],
) -> Result<RawLog, Diagnostic> {
    let has_header = requests
        .iter()
        .any(|r| matches!(r.position, Position::Name(_)));
    with_table(file, bytes, part, has_header, |table| {
        take(file, table, requests)
    })
}

/// Opens the table in some bytes, decompressed if need be, and does something with it.
///
/// # Errors
/// The bytes are no log, or the part does not fit; and those of `action`.
pub fn with_table<T>(
    file: &str,
    bytes: &[u8],
    part: Option<&Part>,
    has_header: bool,
    action: impl FnOnce(&dyn Table) -> Result<T, Diagnostic>,
) -> Result<T, Diagnostic> {
    let bytes = gzip::unpacked(file, bytes)?;
    let source = Source {
        file,
        bytes: &bytes,
        part,
        has_header,
    };
    let format = format_of(&source)?;
    let table = (format.open)(&source)?;
    action(table.as_ref())
}

fn format_of(source: &Source) -> Result<&'static LogFormat, Diagnostic> {
    foreign::refuse(source.file, source.bytes, &list_of_formats())?;
    let format = FORMATS
        .iter()
        .find(|f| (f.recognises)(source.bytes))
        .unwrap_or(&super::csv::FORMAT);
    match (source.part, format.part) {
        (Some(part), kind) if kind != Some(part.kind) => Err(unreadable(
            source.file,
            format!("`{} = \"{}\"`", part.kind.key(), part.name),
            match kind {
                Some(kind) => format!(
                    "`{}`, as the log is of the format {}",
                    kind.key(),
                    format.name
                ),
                None => format!("nothing of that kind, as the log is {}", format.name),
            },
            "correct the [[log]] in session.toml",
        )),
        _ => Ok(format),
    }
}

fn take(file: &str, table: &dyn Table, requests: &[Request]) -> Result<RawLog, Diagnostic> {
    let indices = locate(file, table.names(), requests)?;
    let wanted: Vec<Wanted> = indices
        .iter()
        .zip(requests)
        .map(|(index, request)| Wanted {
            index: *index,
            as_text: is_read_as_text(request),
        })
        .collect();
    let columns = table.read(&wanted)?;
    check_lengths(file, &columns, requests)?;
    let mut log = RawLog {
        first_line: table.first_line(),
        ..RawLog::default()
    };
    for (place, column) in columns.into_iter().enumerate() {
        let request = &requests[place];
        match decoded(column, request) {
            Decoded::Words(words) => {
                log.words.insert(place, words);
                log.columns.push(Vec::new());
            }
            Decoded::Numbers(values) => {
                quote_bad_cells(&values, table, indices[place], request, &mut log);
                log.columns.push(values);
            }
        }
    }
    log.bad_cells.sort_by_key(|c| c.line);
    log.bad_cells.truncate(QUOTED_CELLS);
    Ok(log)
}

/// The index of every requested column among the names of the table's columns.
fn locate(file: &str, names: &[String], requests: &[Request]) -> Result<Vec<usize>, Diagnostic> {
    let missing = |request: &Request, wanted: String, found: String| {
        unreadable(
            file,
            found,
            wanted,
            "correct [columns] in session.toml, or the log",
        )
        .at_row(1)
        .in_column(request.name.as_str())
    };
    requests
        .iter()
        .map(|request| match &request.position {
            Position::Index(index) if *index < names.len() => Ok(*index),
            Position::Index(index) => Err(missing(
                request,
                format!("a column with index {index} (counted from 0)"),
                format!("{} columns", names.len()),
            )),
            Position::Name(name) => {
                let mut named = (0..names.len()).filter(|k| names[*k] == *name);
                match (named.next(), named.next()) {
                    (Some(index), None) => Ok(index),
                    (Some(first), Some(second)) => Err(missing(
                        request,
                        format!("one column named \"{name}\""),
                        format!("columns {first} and {second} (counted from 0) of that name"),
                    )),
                    (None, _) => Err(missing(
                        request,
                        format!("a column named \"{name}\""),
                        format!("the header {}", names.join(", ")),
                    )),
                }
            }
        })
        .collect()
}

fn check_lengths(file: &str, columns: &[Column], requests: &[Request]) -> Result<(), Diagnostic> {
    let Some(first) = columns.first() else {
        return Ok(());
    };
    if first.is_empty() {
        return Err(unreadable(
            file,
            "a header and no rows",
            "rows of numbers below the header",
            "check whether the logger was stopped at once, or remove the [[log]]",
        ));
    }
    match columns.iter().position(|c| c.len() != first.len()) {
        None => Ok(()),
        Some(k) => Err(unreadable(
            file,
            format!("{} values", columns[k].len()),
            format!("{}, as {} has", first.len(), requests[0].name),
            "save variables of one length, or name the one that holds them all",
        )
        .in_column(requests[k].name.as_str())),
    }
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

enum Decoded {
    Numbers(Vec<f64>),
    Words(Vec<Option<String>>),
}

fn decoded(column: Column, request: &Request) -> Decoded {
    let mut values = match column {
        Column::Numbers(numbers) if request.cells == Cells::Words => {
            return Decoded::Words(numbers.into_iter().map(as_word).collect());
        }
        Column::Numbers(numbers) => numbers,
        Column::Texts(texts) => {
            if has_text_codes(request) {
                return Decoded::Numbers(coded(&texts, request));
            }
            let are_wanted = request.cells == Cells::Either && are_words(&texts);
            if request.cells == Cells::Words || are_wanted {
                return Decoded::Words(words(&texts));
            }
            texts.iter().map(|t| t.map_or(f64::NAN, number)).collect()
        }
    };
    if !request.codes.is_empty() {
        recode(&mut values, request);
    }
    Decoded::Numbers(values)
}

/// A number as the word that a text log would hold.
fn as_word(number: f64) -> Option<String> {
    (!number.is_nan()).then(|| number.to_string())
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

/// Counts what is not finite and quotes the first of it from the file.
fn quote_bad_cells(
    values: &[f64],
    table: &dyn Table,
    index: usize,
    request: &Request,
    log: &mut RawLog,
) {
    let bad = || values.iter().enumerate().filter(|(_, x)| !x.is_finite());
    let of = bad().count();
    log.bad_cell_count += of;
    let mut quoted: Vec<BadCell> = Vec::new();
    for (row, _) in bad().take(QUOTED_CELLS) {
        let found = table.quote(row, index);
        // A logger that writes one word for every missing value says no more the third time.
        if quoted.iter().all(|cell| cell.found != found) {
            quoted.push(BadCell {
                line: table.first_line() + row as u64,
                column: request.name.clone(),
                found,
                of,
            });
        }
    }
    log.bad_cells.append(&mut quoted);
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
        let log = read("t", b"1,2,3\r\n4,5,6\r\n", None, &by_index(&[2, 0, 2])).unwrap();
        assert_eq!(
            log.columns,
            [vec![3.0, 6.0], vec![1.0, 4.0], vec![3.0, 6.0]]
        );
        assert_eq!(log.bad_cell_count, 0);
    }

    #[test]
    fn cells_that_are_no_numbers_are_counted_and_quoted_with_their_line() {
        let text = b"1,2\nx,3\n5\n nan ,inf\n7, 8 \n";
        let log = read("t", text, None, &by_index(&[0, 1])).unwrap();
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
    fn a_cell_that_repeats_is_quoted_once_with_how_many_there_are() {
        let text = b"1,2\nOVR,3\nOVR,4\nOVR,5\nOVR,6\n";
        let log = read("t", text, None, &by_index(&[0, 1])).unwrap();
        let quoted: Vec<(u64, usize)> = log.bad_cells.iter().map(|c| (c.line, c.of)).collect();
        assert_eq!((quoted, log.bad_cell_count), (vec![(2, 4)], 4));
    }

    #[test]
    fn a_blank_line_is_a_row_without_numbers_and_lines_keep_their_count() {
        for text in ["1,2\n\nx,4\n", "1,2\r\n\r\nx,4\r\n", " 1, 2\n\nx, 4\n"] {
            let log = read("t", text.as_bytes(), None, &by_index(&[0])).unwrap();
            assert_eq!(log.columns[0].len(), 3, "{text:?} {:?}", log.columns);
            assert_eq!(log.bad_cells.last().unwrap().line, 3, "{text:?}");
        }
    }

    #[test]
    fn a_missing_column_names_what_there_is() {
        let error = read("t", b"a,b\n1,2\n", None, &by_name("force")).unwrap_err();
        assert!(error.found.contains("a, b") && error.expected.contains("force"));
        let error = read("t", b"1,2\n", None, &by_index(&[2])).unwrap_err();
        assert!(error.found.contains("2 columns") && error.expected.contains("index 2"));
    }

    #[test]
    fn a_name_that_two_columns_have_is_refused() {
        let error = read("t", b"force,p,force\n1,2,3\n", None, &by_name("force")).unwrap_err();
        assert!(error.found.contains("0 and 2"), "{error}");
        assert!(read("t", b"force,p,p\n1,2,3\n", None, &by_name("force")).is_ok());
    }

    #[test]
    fn empty_header_only_and_foreign_bytes_are_told_apart() {
        assert!(
            read("t", b"", None, &by_index(&[0]))
                .unwrap_err()
                .found
                .contains("empty")
        );
        assert!(
            read("t", b" \n\n", None, &by_index(&[0]))
                .unwrap_err()
                .found
                .contains("empty")
        );
        let only = read("t", b"force\n", None, &by_name("force")).unwrap_err();
        assert!(only.found.contains("header"));
        let foreign = read("t", b"1,2\n\xff\xfe,3\n", None, &by_index(&[0])).unwrap_err();
        assert_eq!(
            (foreign.found.contains("UTF-8"), foreign.row),
            (true, Some(2))
        );
    }

    #[test]
    fn states_are_coded_whether_written_as_numbers_or_words() {
        let mut request = by_index(&[1]);
        request[0].codes = vec![("1".into(), 10.0), ("2".into(), 20.0)];
        let log = read("t", b"0,1\n0,2\n0,7444\n", None, &request).unwrap();
        assert_eq!(log.columns[0][..2], [10.0, 20.0]);
        assert_eq!((log.bad_cell_count, log.bad_cells[0].line), (1, 3));
        request[0].codes = vec![("up".into(), 10.0), ("down".into(), 20.0)];
        let log = read("t", b"0,up\n0, down\n", None, &request).unwrap();
        assert_eq!(log.columns[0], [10.0, 20.0]);
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_first_column() {
        let log = read(
            "t",
            "\u{feff}force,p\n1,2\n".as_bytes(),
            None,
            &by_name("force"),
        )
        .unwrap();
        assert_eq!(log.columns[0], [1.0]);
    }
}
