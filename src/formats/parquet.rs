//! Parquet: the table of a data frame; the columns of numbers, truth values and words are read.

use super::columns::Columns;
use super::guard::guarded;
use super::table::{Cells, LogFormat, Source, Table, quoted, unreadable};
use crate::base::diagnostics::Diagnostic;
use polars::prelude::*;
use std::io::Cursor;

/// Parquet files.
pub const FORMAT: LogFormat = LogFormat {
    name: "Parquet",
    part: None,
    recognises: |bytes| bytes.starts_with(b"PAR1"),
    open,
};

fn open<'a>(source: &Source<'a>) -> Result<Box<dyn Table + 'a>, Diagnostic> {
    let frame = read(source.bytes).map_err(|why| {
        unreadable(
            source.file,
            format!("a file that cannot be read ({})", quoted(&why)),
            "a Parquet file",
            "write it again; a file that was cut off lacks its end",
        )
    })?;
    let mut columns = Columns::starting_at(1);
    for column in frame.columns() {
        let cells = cells(column).map_err(|e| {
            unreadable(
                source.file,
                format!("a column of type {} ({e})", column.dtype()),
                "numbers, truth values or words",
                "store it as numbers: a time as seconds",
            )
            .in_column(column.name().as_str())
        })?;
        columns.push(column.name().as_str(), cells);
    }
    Ok(Box::new(columns))
}

/// The table in some bytes, or why there is none: polars panics on damaged metadata.
fn read(bytes: &[u8]) -> Result<DataFrame, String> {
    let reader = ParquetReader::new(Cursor::new(bytes))
        .set_rechunk(true)
        .read_parallel(ParallelStrategy::None);
    guarded(|| reader.finish())?.map_err(|e| e.to_string())
}

fn cells(column: &Column) -> PolarsResult<Cells> {
    if column.dtype() == &DataType::String {
        return Ok(Cells::Texts(column.str()?.clone()));
    }
    let is_number = column.dtype().is_primitive_numeric() || column.dtype().is_bool();
    polars_ensure!(is_number, ComputeError: "no numbers");
    let numbers = column.cast(&DataType::Float64)?;
    let numbers = numbers.f64()?.iter().map(|x| x.unwrap_or(f64::NAN));
    Ok(Cells::Numbers(numbers.collect()))
}
