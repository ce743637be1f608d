//! Columns of numbers, whole numbers and texts, and their Parquet form.
//!
//! The pipeline's tables are small and typed; polars carries them to and from Parquet, so that pandas, polars and DuckDB read
//! `derived/` as it is. A missing number is NaN here and null there. The units stand in the file too, under the key `units`, as a JSON object
//! from column to unit.

use crate::columns;
use crate::error::{Error, Result};
use polars::prelude::*;
use std::collections::BTreeMap;
use std::io::Cursor;

/// The values of one column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; NaN where there is none.
    Number(Vec<f64>),
    /// Whole numbers.
    Integer(Vec<Option<i64>>),
    /// Texts.
    Text(Vec<Option<String>>),
}

/// A table: columns of one length, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Name and values.
    pub columns: Vec<(String, Values)>,
    /// Units by column, beside those that are known from the pipeline's own names; they are written and not read.
    pub units: BTreeMap<String, String>,
}

/// Key of the units in the metadata of a Parquet file.
const UNITS: &str = "units";

impl Frame {
    /// The same table with one more column.
    pub fn with(mut self, name: &str, values: Values) -> Self {
        self.columns.push((name.to_owned(), values));
        self
    }

    /// The same table with units of columns.
    pub fn with_units(mut self, units: impl IntoIterator<Item = (String, String)>) -> Self {
        self.units.extend(units);
        self
    }

    /// Units by column, as far as they are known.
    fn all_units(&self) -> BTreeMap<&str, &str> {
        let unit = |name: &'_ str| {
            let own = columns::is_reserved(name).then(|| columns::unit_in(name));
            let given = self.units.get(name).map(String::as_str);
            given.or(own.flatten())
        };
        let columns = self.columns.iter();
        columns
            .filter_map(|(name, _)| Some((name.as_str(), unit(name)?)))
            .collect()
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.columns.first().map_or(0, |(_, v)| match v {
            Values::Number(x) => x.len(),
            Values::Integer(x) => x.len(),
            Values::Text(x) => x.len(),
        })
    }

    /// The numbers of a column, if there is one of that name.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.get(name)? {
            Values::Number(x) => Some(x),
            _ => None,
        }
    }

    /// The whole numbers of a column, if there is one of that name.
    pub fn integers(&self, name: &str) -> Option<&[Option<i64>]> {
        match self.get(name)? {
            Values::Integer(x) => Some(x),
            _ => None,
        }
    }

    /// The texts of a column, if there is one of that name.
    pub fn texts(&self, name: &str) -> Option<&[Option<String>]> {
        match self.get(name)? {
            Values::Text(x) => Some(x),
            _ => None,
        }
    }

    fn get(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|(n, _)| n == name).map(|(_, v)| v)
    }

    /// The table as Parquet. The bytes depend on the values alone.
    ///
    /// # Errors
    /// Columns of unequal length or equal name.
    pub fn to_parquet(&self) -> Result<Vec<u8>> {
        let columns = self.columns.iter().map(|(name, values)| {
            let name = PlSmallStr::from(name.as_str());
            match values {
                Values::Number(x) => number_column(name, x),
                Values::Integer(x) => Column::new(name, x),
                Values::Text(x) => Column::new(name, x),
            }
        });
        let mut frame =
            DataFrame::new(self.height(), columns.collect()).map_err(Error::internal)?;
        let units = serde_json::to_string(&self.all_units()).map_err(Error::internal)?;
        let units = vec![(UNITS.to_owned(), units)];
        let mut bytes = Vec::new();
        ParquetWriter::new(&mut bytes)
            .with_key_value_metadata(Some(KeyValueMetadata::from_static(units)))
            .with_compression(ParquetCompression::Lz4Raw)
            .with_statistics(StatisticsOptions::empty())
            .set_parallel(false)
            .finish(&mut frame)
            .map_err(Error::internal)?;
        Ok(bytes)
    }

    /// The table in some Parquet bytes.
    ///
    /// # Errors
    /// Bytes that are no Parquet, or a column of another type.
    pub fn from_parquet(bytes: &[u8]) -> Result<Self> {
        let frame = ParquetReader::new(Cursor::new(bytes))
            .set_rechunk(true)
            .read_parallel(ParallelStrategy::None)
            .finish()
            .map_err(Error::internal)?;
        let mut table = Frame::default();
        for column in frame.columns() {
            let values = match column.dtype() {
                DataType::Float64 => {
                    Values::Number(numbers(column.f64().map_err(Error::internal)?))
                }
                DataType::Int64 => {
                    Values::Integer(column.i64().map_err(Error::internal)?.iter().collect())
                }
                DataType::String => Values::Text(
                    column
                        .str()
                        .map_err(Error::internal)?
                        .iter()
                        .map(|x| x.map(ToOwned::to_owned))
                        .collect(),
                ),
                other => return Err(Error::Internal(format!("column of type {other}"))),
            };
            table.columns.push((column.name().to_string(), values));
        }
        Ok(table)
    }
}

/// The numbers of a polars column, NaN where there is none.
pub fn numbers(column: &Float64Chunked) -> Vec<f64> {
    match column.cont_slice() {
        Ok(numbers) => numbers.to_vec(),
        // In several pieces, or some are missing.
        Err(_) => column.iter().map(|x| x.unwrap_or(f64::NAN)).collect(),
    }
}

fn number_column(name: PlSmallStr, values: &[f64]) -> Column {
    if values.iter().any(|x| x.is_nan()) {
        let some = values.iter().map(|x| (!x.is_nan()).then_some(*x));
        Float64Chunked::from_iter_options(name, some).into_column()
    } else {
        Column::new(name, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_survives_parquet_and_its_bytes_are_always_the_same() {
        let table = Frame::default()
            .with("force_n", Values::Number(vec![1.5, f64::INFINITY, -0.25]))
            .with("run", Values::Integer(vec![Some(8), None, Some(10)]))
            .with(
                "log",
                Values::Text(vec![Some("a".into()), None, Some(String::new())]),
            );
        let bytes = table.to_parquet().unwrap();
        assert_eq!(bytes, table.to_parquet().unwrap());
        assert_eq!(Frame::from_parquet(&bytes).unwrap(), table);
        let missing = Frame::default().with("x", Values::Number(vec![f64::NAN, 1.0]));
        let back = Frame::from_parquet(&missing.to_parquet().unwrap()).unwrap();
        assert!(back.numbers("x").unwrap()[0].is_nan());
        let empty = Frame::default().with("x", Values::Number(vec![]));
        assert_eq!(
            Frame::from_parquet(&empty.to_parquet().unwrap())
                .unwrap()
                .height(),
            0
        );
    }
}
