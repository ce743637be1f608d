//! Parquet: the table of a data frame; the columns of numbers, truth values and words are read.

use super::columns::Columns;
use super::guard::guarded;
use super::table::{Cells, LARGEST_LOG, LogFormat, Source, Table, quoted, unreadable};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::frame;
use polars::prelude::*;
use polars_buffer::Buffer;
use polars_parquet::parquet::page::CompressedPage;
use polars_parquet::parquet::read::{get_page_iterator, read_metadata};
use std::io::Cursor;

/// Most values of a column: as numbers they are as large as the largest log.
const MOST_VALUES: usize = LARGEST_LOG as usize / size_of::<f64>();
/// Largest page, bytes: no page is larger than the file may be.
const LARGEST_PAGE: usize = LARGEST_LOG as usize;

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
            "write it again: the file may be truncated",
        )
    })?;
    let mut columns = Columns::starting_at(1);
    for column in frame.columns() {
        let cells = cells(column).map_err(|e| {
            unreadable(
                source.file,
                format!("a column of type {} ({e})", column.dtype()),
                "numbers, truth values or text",
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
    guarded(|| check_counts(bytes))??;
    let reader = ParquetReader::new(Cursor::new(bytes))
        .set_rechunk(true)
        .read_parallel(ParallelStrategy::None);
    guarded(|| reader.finish())?.map_err(|e| e.to_string())
}

/// Whether every page has as many values as its column has left: polars takes room for what a page's header says (a negative count
/// for 2^64), and a program that asks for too much memory is ended, which no guard can catch.
fn check_counts(bytes: &[u8]) -> Result<(), String> {
    let all = Buffer::from(bytes.to_vec());
    let metadata = read_metadata(&mut Cursor::new(bytes)).map_err(|e| e.to_string())?;
    let columns = metadata.row_groups.iter().flat_map(|g| g.parquet_columns());
    for column in columns {
        let mut left = usize::try_from(column.num_values())
            .ok()
            .filter(|n| *n <= MOST_VALUES)
            .ok_or("a column with an impossible number of values")?;
        let reader = Cursor::new(all.clone());
        let mut pages = get_page_iterator(column, reader, Vec::new(), LARGEST_PAGE)
            .map_err(|e| e.to_string())?;
        pages.read_dict().map_err(|e| e.to_string())?;
        for page in pages {
            let values = match page.map_err(|e| e.to_string())? {
                CompressedPage::Data(page) => page.num_values(),
                CompressedPage::Dict(_) => continue,
            };
            left = left
                .checked_sub(values)
                .ok_or("a page with more values than its column")?;
        }
    }
    Ok(())
}

fn cells(column: &Column) -> PolarsResult<Cells> {
    if column.dtype() == &DataType::String {
        return Ok(Cells::Texts(column.str()?.clone()));
    }
    let is_number = column.dtype().is_primitive_numeric() || column.dtype().is_bool();
    polars_ensure!(is_number, ComputeError: "no numbers");
    let numbers = column.cast(&DataType::Float64)?;
    Ok(Cells::Numbers(frame::numbers(numbers.f64()?)))
}

#[cfg(test)]
mod unit {
    use super::read;

    /// With a value that is missing, so that pages say which are there.
    const LOG: &[u8] = include_bytes!("../../tests/data/formats/frame.parquet");

    #[test]
    fn a_flipped_bit_gives_a_table_or_a_reason_and_never_ends_the_program() {
        assert!(read(LOG).is_ok());
        let mut refused = 0;
        for bit in 0..8 * LOG.len() {
            let mut damaged = LOG.to_vec();
            damaged[bit / 8] ^= 1 << (bit % 8);
            refused += usize::from(read(&damaged).is_err());
        }
        assert!(refused > 100, "{refused}");
    }
}
