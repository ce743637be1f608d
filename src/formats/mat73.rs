//! MATLAB files of version 7.3, and other HDF5 files: numbers in datasets, structures as groups of them.
//!
//! MATLAB stores a matrix column after column and declares its dimensions the other way round; a plain HDF5 file holds it row after
//! row. Words (cell arrays) are kept behind references and not read.

use super::table::{LARGEST_LOG, LogFormat, Source, Table, unreadable};
use super::workspace::{self, Value, Variable};
use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, H5Type, Hdf5File, OpenOptions};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::PartKind;

/// MATLAB files of version 7.3.
pub const FORMAT: LogFormat = LogFormat {
    name: "MATLAB file (.mat, -v7.3) or HDF5",
    part: Some(PartKind::Variable),
    recognises: |bytes| bytes.starts_with(SIGNATURE) || is_matlab(bytes),
    open,
};

const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// MATLAB writes its own header of this size before that of HDF5.
const MATLAB_HEADER: usize = 512;

/// Deflate makes data no smaller than by this factor: a dataset that declares to be larger holds nothing but its declaration.
const MOST_COMPRESSED: usize = 1032;

fn is_matlab(bytes: &[u8]) -> bool {
    let after = bytes.get(MATLAB_HEADER..).unwrap_or_default();
    bytes.starts_with(b"MATLAB 7.3") || after.starts_with(SIGNATURE)
}

fn open<'a>(source: &Source<'a>) -> Result<Box<dyn Table + 'a>, Diagnostic> {
    let broken = |e: Error| {
        unreadable(
            source.file,
            format!("a file that cannot be read ({e})"),
            "a MATLAB file of version 7.3",
            "save it with -v7 instead",
        )
    };
    let most = (LARGEST_LOG as usize).min(source.bytes.len() * MOST_COMPRESSED);
    let limits = OpenOptions::default()
        .with_max_read_bytes(most)
        .with_max_chunk_bytes(most);
    let file = Hdf5File::from_bytes_with_options(source.bytes, limits).map_err(broken)?;
    let by_columns = is_matlab(source.bytes);
    let root = file.root_group().map_err(broken)?;
    let mut variables = datasets(&root, by_columns).map_err(broken)?;
    for group in root.groups().map_err(broken)? {
        // What stands behind `#` is MATLAB's own.
        if !group.name().starts_with('#') {
            variables.push(Variable {
                name: group.name().to_owned(),
                value: Value::Fields(datasets(&group, by_columns).map_err(broken)?),
            });
        }
    }
    workspace::boxed(source, variables)
}

fn datasets(group: &Group, by_columns: bool) -> Result<Vec<Variable>, Error> {
    let variable = |dataset: Dataset| {
        Ok(Variable {
            name: dataset.name().to_owned(),
            value: value(&dataset, by_columns)?,
        })
    };
    group.datasets()?.into_iter().map(variable).collect()
}

fn value(dataset: &Dataset, by_columns: bool) -> Result<Value, Error> {
    match matlab_class(dataset).as_deref() {
        Some("char") => return Ok(Value::Other("characters")),
        Some("cell") => return Ok(Value::Other("a cell array; save text with -v7")),
        _ => {}
    }
    let Some(numbers) = numbers(dataset)? else {
        return Ok(Value::Other("no numbers"));
    };
    let shape: Vec<usize> = dataset.shape().iter().map(|n| *n as usize).collect();
    Ok(match shape[..] {
        [] => Value::Matrix { rows: 1, numbers },
        [rows] => Value::Matrix { rows, numbers },
        [_, rows] if by_columns => Value::Matrix { rows, numbers },
        [rows, width] => Value::Matrix {
            rows,
            numbers: transposed(&numbers, width),
        },
        _ => Value::Other("an array of more than two dimensions"),
    })
}

fn matlab_class(dataset: &Dataset) -> Option<String> {
    dataset.attribute("MATLAB_class").ok()?.read_string().ok()
}

/// Numbers row after row, `width` a row, as numbers column after column.
fn transposed(numbers: &[f64], width: usize) -> Vec<f64> {
    // What is empty may be declared as wide as one likes.
    (0..width.min(numbers.len()))
        .flat_map(|column| numbers.iter().skip(column).step_by(width.max(1)).copied())
        .collect()
}

/// The numbers of a dataset; none where it holds something else.
fn numbers(dataset: &Dataset) -> Result<Option<Vec<f64>>, Error> {
    fn of<T: H5Type>(dataset: &Dataset, as_f64: fn(T) -> f64) -> Result<Option<Vec<f64>>, Error> {
        let values = dataset.read_array::<T>()?;
        Ok(Some(values.into_iter().map(as_f64).collect()))
    }
    match dataset.dtype() {
        Datatype::FloatingPoint { size: 8, .. } => of::<f64>(dataset, |x| x),
        Datatype::FloatingPoint { size: 4, .. } => of::<f32>(dataset, f64::from),
        Datatype::FixedPoint { size, signed, .. } => match (size, signed) {
            (1, true) => of::<i8>(dataset, f64::from),
            (1, false) => of::<u8>(dataset, f64::from),
            (2, true) => of::<i16>(dataset, f64::from),
            (2, false) => of::<u16>(dataset, f64::from),
            (4, true) => of::<i32>(dataset, f64::from),
            (4, false) => of::<u32>(dataset, f64::from),
            (8, true) => of::<i64>(dataset, |x| x as f64),
            (8, false) => of::<u64>(dataset, |x| x as f64),
            _ => Ok(None),
        },
        _ => Ok(None),
    }
}
