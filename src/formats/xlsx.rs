//! Excel workbooks (.xlsx): one sheet is one log, the one that `sheet` names or the first.

use super::columns::{Columns, texts};
use super::table::{Cells, LARGEST_LOG, LogFormat, Source, Table, unreadable};
use calamine::{DataRef, Reader, Xlsx, XlsxError};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::PartKind;
use std::io::Cursor;

/// Excel workbooks.
pub const FORMAT: LogFormat = LogFormat {
    name: "Excel workbook (.xlsx)",
    part: Some(PartKind::Sheet),
    recognises: |bytes| bytes.starts_with(b"PK\x03\x04"),
    open,
};

/// No sheet has more rows than this, and none more columns than the other.
const MOST_ROWS: usize = 1 << 20;
const MOST_COLUMNS: usize = 1 << 14;

/// A table has gaps, but a word in the last corner of a sheet does not make a table of billions of empty cells: beside so many cells
/// in any case, most of a table has to be filled.
const EMPTY_IN_ANY_CASE: usize = 4 << 20;
const EMPTY_FOR_EACH_FILLED: usize = 8;

/// What stands in a cell.
#[derive(Clone, Debug)]
enum Value {
    Number(f64),
    Text(String),
}

/// The cells of a sheet, column by column from its first row to the last cell in which something stands.
#[derive(Default)]
struct Sheet {
    columns: Vec<Vec<Option<Value>>>,
    first_row: Option<usize>,
    rows: usize,
    filled: usize,
}

impl Sheet {
    /// Puts a value into its cell; false where that would make the sheet no table.
    fn put(&mut self, row: usize, column: usize, value: Value) -> bool {
        if row >= MOST_ROWS || column >= MOST_COLUMNS {
            return false;
        }
        // Rows come in order; one that does not would stand above the table.
        let row = row.saturating_sub(*self.first_row.get_or_insert(row));
        let width = self.columns.len().max(column + 1);
        self.rows = self.rows.max(row + 1);
        self.filled += 1;
        if self.rows * width > EMPTY_IN_ANY_CASE + EMPTY_FOR_EACH_FILLED * self.filled {
            return false;
        }
        self.columns.resize_with(width, Vec::new);
        let cells = &mut self.columns[column];
        if cells.len() <= row {
            cells.resize(row + 1, None);
        }
        cells[row] = Some(value);
        true
    }
}

fn open<'a>(source: &Source<'a>) -> Result<Box<dyn Table + 'a>, Diagnostic> {
    let broken = |e: XlsxError| {
        unreadable(
            source.file,
            format!("a workbook that cannot be read ({e})"),
            "an Excel workbook (.xlsx)",
            "open it and save it again, or save the sheet as CSV",
        )
    };
    check_unpacked_size(source)?;
    let mut workbook = Xlsx::new(Cursor::new(source.bytes)).map_err(broken)?;
    let name = sheet_name(source, &workbook.sheet_names())?;
    let sheet = read_sheet(&mut workbook, &name).map_err(broken)?;
    let Some(sheet) = sheet else {
        return Err(unreadable(
            source.file,
            format!("cells far from any table in sheet \"{name}\""),
            format!("a table of at most {MOST_ROWS} rows, most of its cells filled"),
            "delete what is far from the table, or save it as CSV",
        ));
    };
    if sheet.columns.is_empty() {
        return Err(unreadable(
            source.file,
            format!("an empty sheet \"{name}\""),
            "rows of numbers",
            "name another with `sheet`, or remove the [[log]]",
        ));
    }
    Ok(Box::new(table(sheet, source.has_header)))
}

/// A few kilobytes may unpack to gigabytes; what the archive says of its size is checked before anything is unpacked.
fn check_unpacked_size(source: &Source) -> Result<(), Diagnostic> {
    let archive = zip::ZipArchive::new(Cursor::new(source.bytes)).map_err(|e| {
        unreadable(
            source.file,
            format!("a damaged archive ({e})"),
            "an Excel workbook (.xlsx)",
            "copy the file again; a workbook is a ZIP archive",
        )
    })?;
    match archive.decompressed_size() {
        Some(size) if size > u128::from(LARGEST_LOG) => Err(unreadable(
            source.file,
            format!("{size} bytes once unpacked"),
            format!("a log of at most {LARGEST_LOG} bytes"),
            "save the sheet that is the log as CSV",
        )),
        _ => Ok(()),
    }
}

fn sheet_name(source: &Source, names: &[String]) -> Result<String, Diagnostic> {
    let wanted = source.part.map(|part| part.name.as_str());
    let found = match wanted {
        Some(wanted) => names.iter().find(|n| *n == wanted),
        None => names.first(),
    };
    found.cloned().ok_or_else(|| {
        unreadable(
            source.file,
            format!("the sheets {}", names.join(", ")),
            match wanted {
                Some(wanted) => format!("a sheet named \"{wanted}\""),
                None => "at least one sheet".to_owned(),
            },
            "correct `sheet` in session.toml",
        )
    })
}

/// The cells of a sheet; nothing where there are more than a log can have.
fn read_sheet(workbook: &mut Xlsx<Cursor<&[u8]>>, name: &str) -> Result<Option<Sheet>, XlsxError> {
    let mut cells = workbook.worksheet_cells_reader(name)?;
    let mut sheet = Sheet::default();
    while let Some(cell) = cells.next_cell()? {
        let (row, column) = cell.get_position();
        let put = |value| sheet.put(row as usize, column as usize, value);
        if !value(cell.get_value()).is_none_or(put) {
            return Ok(None);
        }
    }
    Ok(Some(sheet))
}

/// A date is no number: as one it would be days since 1900, and a time of day a fraction of a day.
fn value(data: &DataRef) -> Option<Value> {
    match data {
        DataRef::Empty => None,
        DataRef::Int(i) => Some(Value::Number(*i as f64)),
        DataRef::Float(x) => Some(Value::Number(*x)),
        DataRef::Bool(b) => Some(Value::Number(f64::from(u8::from(*b)))),
        DataRef::String(s) => Some(Value::Text(s.clone())),
        DataRef::SharedString(s) => Some(Value::Text((*s).to_owned())),
        DataRef::DateTime(date) => Some(Value::Text(format!("date or time {date}"))),
        DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => Some(Value::Text(text.clone())),
        DataRef::Error(error) => Some(Value::Text(error.to_string())),
    }
}

fn table(sheet: Sheet, has_header: bool) -> Columns {
    let skip = usize::from(has_header);
    let first_row = sheet.first_row.unwrap_or(0) + skip;
    let mut columns = Columns::starting_at(first_row as u64 + 1);
    for mut cells in sheet.columns {
        cells.resize(sheet.rows, None);
        let name = cells
            .first()
            .cloned()
            .flatten()
            .map_or_else(String::new, as_text);
        columns.push(name.trim(), column(cells.into_iter().skip(skip)));
    }
    columns
}

fn as_text(value: Value) -> String {
    match value {
        Value::Number(x) => x.to_string(),
        Value::Text(text) => text,
    }
}

fn column(values: impl Iterator<Item = Option<Value>> + Clone) -> Cells {
    let is_text = |v: Option<Value>| matches!(v, Some(Value::Text(_)));
    if values.clone().any(is_text) {
        return texts(values.map(|v| v.map(as_text)));
    }
    let number = |v| match v {
        Some(Value::Number(x)) => x,
        _ => f64::NAN,
    };
    Cells::Numbers(values.map(number).collect())
}
