//! MATLAB files of level 5 (`save -v6`, `-v7`, and `scipy.io.savemat`): numbers, cell arrays of words, structures.
//!
//! The layout is that of "MAT-File Format" (The MathWorks, R2023b), chapter 1: elements of a type, a length and contents, padded to 8
//! bytes; an array is an element of elements. The crates for it do not do: `matrw` 0.1.4 refuses the header that SciPy writes, and
//! `matfile` 0.5.0 leaves out structures without a word and prints to standard output.

use super::table::{LARGEST_LOG, LogFormat, Source, Table, unreadable};
use super::workspace::{self, Value, Variable};
use flate2::read::ZlibDecoder;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::PartKind;
use std::io::Read;

/// MATLAB files of level 5.
pub const FORMAT: LogFormat = LogFormat {
    name: "MATLAB file (.mat, -v6 or -v7)",
    part: Some(PartKind::Variable),
    recognises: |bytes| byte_order(bytes).is_some(),
    open,
};

const HEADER: usize = 128;

/// A structure in a structure, and so on, no deeper than this.
const DEEPEST: usize = 8;

/// Types of elements.
mod element {
    pub const INT8: u32 = 1;
    pub const UINT8: u32 = 2;
    pub const INT16: u32 = 3;
    pub const UINT16: u32 = 4;
    pub const INT32: u32 = 5;
    pub const UINT32: u32 = 6;
    pub const SINGLE: u32 = 7;
    pub const DOUBLE: u32 = 9;
    pub const INT64: u32 = 12;
    pub const UINT64: u32 = 13;
    pub const MATRIX: u32 = 14;
    pub const COMPRESSED: u32 = 15;
    pub const UTF8: u32 = 16;
    pub const UTF16: u32 = 17;
}

/// Classes of arrays.
mod class {
    pub const CELL: u32 = 1;
    pub const STRUCTURE: u32 = 2;
    pub const OBJECT: u32 = 3;
    pub const CHAR: u32 = 4;
    pub const SPARSE: u32 = 5;
    pub const FIRST_NUMERIC: u32 = 6;
    pub const LAST_NUMERIC: u32 = 15;
    pub const OPAQUE: u32 = 17;
}

/// Why the rest of a file cannot be read.
type Broken = &'static str;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

fn byte_order(bytes: &[u8]) -> Option<ByteOrder> {
    match bytes.get(HEADER - 4..HEADER)? {
        [0, 1, b'I', b'M'] => Some(ByteOrder::Little),
        [1, 0, b'M', b'I'] => Some(ByteOrder::Big),
        _ => None,
    }
}

fn open<'a>(source: &Source<'a>) -> Result<Box<dyn Table + 'a>, Diagnostic> {
    let variables = variables(source.bytes).map_err(|why| {
        unreadable(
            source.file,
            format!("a file that cannot be read ({why})"),
            "a MATLAB file of level 5",
            "save it again with -v7: the file may be truncated",
        )
    })?;
    workspace::boxed(source, variables)
}

fn variables(bytes: &[u8]) -> Result<Vec<Variable>, Broken> {
    let order = byte_order(bytes).ok_or("no header")?;
    let mut elements = Elements::new(&bytes[HEADER..], order);
    let mut variables = Vec::new();
    let mut unpacked = 0;
    while let Some((kind, contents)) = elements.next()? {
        let variable = match kind {
            element::MATRIX => array(contents, order, DEEPEST)?,
            element::COMPRESSED => {
                let inflated = inflate(contents, LARGEST_LOG - unpacked)?;
                unpacked += inflated.len() as u64;
                match Elements::new(&inflated, order).next()? {
                    Some((element::MATRIX, contents)) => array(contents, order, DEEPEST)?,
                    _ => continue,
                }
            }
            _ => continue,
        };
        variables.push(variable);
    }
    Ok(variables)
}

fn inflate(contents: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    let mut inflated = Vec::new();
    ZlibDecoder::new(contents)
        .take(most)
        .read_to_end(&mut inflated)
        .map_err(|_| "a damaged compressed variable")?;
    if inflated.len() as u64 == most {
        return Err("more than a log can contain once decompressed");
    }
    Ok(inflated)
}

/// The elements in some bytes, one after the other.
struct Elements<'a> {
    rest: &'a [u8],
    order: ByteOrder,
}

impl<'a> Elements<'a> {
    fn new(rest: &'a [u8], order: ByteOrder) -> Self {
        Self { rest, order }
    }

    /// Type and contents of the next element; none at the end.
    fn next(&mut self) -> Result<Option<(u32, &'a [u8])>, Broken> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let tag = u32_at(self.rest, 0, self.order)?;
        // Four bytes and less stand in the tag itself, the length in its upper half.
        let (kind, length, start, padded) = if tag >> 16 != 0 {
            (tag & 0xffff, (tag >> 16) as usize, 4, 8)
        } else {
            let length = u32_at(self.rest, 4, self.order)? as usize;
            let padding = if tag == element::COMPRESSED { 1 } else { 8 };
            (tag, length, 8, 8 + length.next_multiple_of(padding))
        };
        let contents = self
            .rest
            .get(start..start + length)
            .ok_or("an element longer than the file")?;
        self.rest = self.rest.get(padded..).unwrap_or_default();
        Ok(Some((kind, contents)))
    }

    fn expect(&mut self, missing: Broken) -> Result<(u32, &'a [u8]), Broken> {
        self.next()?.ok_or(missing)
    }
}

fn u32_at(bytes: &[u8], at: usize, order: ByteOrder) -> Result<u32, Broken> {
    let four: [u8; 4] = bytes
        .get(at..at + 4)
        .and_then(|b| b.try_into().ok())
        .ok_or("the end in the middle of an element")?;
    Ok(match order {
        ByteOrder::Little => u32::from_le_bytes(four),
        ByteOrder::Big => u32::from_be_bytes(four),
    })
}

/// An array: flags, dimensions, name, and what its class says; arrays in it no deeper than `depth`.
fn array(contents: &[u8], order: ByteOrder, depth: usize) -> Result<Variable, Broken> {
    let mut elements = Elements::new(contents, order);
    if contents.is_empty() {
        return Ok(Variable {
            name: String::new(),
            value: Value::Other("nothing"),
        });
    }
    let (_, flags) = elements.expect("an array without flags")?;
    let flags = u32_at(flags, 0, order)?;
    let (array_class, is_complex) = (flags & 0xff, flags & 0x0800 != 0);
    if array_class == class::OPAQUE {
        let (_, name) = elements.expect("an object without a name")?;
        return Ok(Variable {
            name: text(name),
            value: Value::Other("an object, such as a table"),
        });
    }
    let (kind, dimensions) = elements.expect("an array without dimensions")?;
    let dimensions = numbers(kind, dimensions, order)?;
    let (_, name) = elements.expect("an array without a name")?;
    let value = match array_class {
        class::FIRST_NUMERIC..=class::LAST_NUMERIC if is_complex => Value::Other("complex numbers"),
        class::FIRST_NUMERIC..=class::LAST_NUMERIC => matrix(&mut elements, &dimensions)?,
        class::CHAR => Value::Words(characters(&mut elements, &dimensions)?),
        _ if depth == 0 => Value::Other("arrays within arrays"),
        class::CELL => cell_array(&mut elements, depth)?,
        class::STRUCTURE => structure(&mut elements, &dimensions, depth)?,
        class::SPARSE => Value::Other("a sparse matrix"),
        class::OBJECT => Value::Other("an object"),
        _ => Value::Other("an array of an unknown class"),
    };
    Ok(Variable {
        name: text(name),
        value,
    })
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The numbers of an element: MATLAB stores them in the smallest type that holds them.
fn numbers(kind: u32, bytes: &[u8], order: ByteOrder) -> Result<Vec<f64>, Broken> {
    macro_rules! of {
        ($type:ty) => {
            bytes
                .chunks_exact(size_of::<$type>())
                .map(|b| {
                    let b = b.try_into().expect("chunks have this size");
                    match order {
                        ByteOrder::Little => <$type>::from_le_bytes(b) as f64,
                        ByteOrder::Big => <$type>::from_be_bytes(b) as f64,
                    }
                })
                .collect()
        };
    }
    Ok(match kind {
        element::INT8 => of!(i8),
        element::UINT8 => of!(u8),
        element::INT16 => of!(i16),
        element::UINT16 => of!(u16),
        element::INT32 => of!(i32),
        element::UINT32 => of!(u32),
        element::SINGLE => of!(f32),
        element::DOUBLE => of!(f64),
        element::INT64 => of!(i64),
        element::UINT64 => of!(u64),
        _ => return Err("numbers of a type that is not known"),
    })
}

fn matrix(elements: &mut Elements, dimensions: &[f64]) -> Result<Value, Broken> {
    let (kind, contents) = elements.expect("a matrix without numbers")?;
    let numbers = numbers(kind, contents, elements.order)?;
    let cells: f64 = dimensions.iter().product();
    match dimensions {
        [rows, _] if cells == numbers.len() as f64 => Ok(Value::Matrix {
            rows: *rows as usize,
            numbers,
        }),
        [_, _] => Err("a matrix whose number of cells contradicts its dimensions"),
        _ => Ok(Value::Other("an array of more than two dimensions")),
    }
}

/// The rows of an array of characters, which are stored column after column.
fn characters(elements: &mut Elements, dimensions: &[f64]) -> Result<Vec<Option<String>>, Broken> {
    let (kind, contents) = elements.expect("an array without characters")?;
    let characters: Vec<char> = match kind {
        element::UTF8 => text(contents).chars().collect(),
        element::UTF16 | element::UINT16 => {
            let units = numbers(element::UINT16, contents, elements.order)?;
            char::decode_utf16(units.into_iter().map(|u| u as u16))
                .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
                .collect()
        }
        kind => numbers(kind, contents, elements.order)?
            .into_iter()
            .map(|c| char::from(c as u8))
            .collect(),
    };
    let rows = dimensions.first().map_or(0, |rows| *rows as usize);
    if rows > characters.len() {
        return Ok(Vec::new());
    }
    let row = |k| {
        characters
            .iter()
            .skip(k)
            .step_by(rows.max(1))
            .collect::<String>()
    };
    Ok((0..rows).map(|k| Some(row(k).trim().to_owned())).collect())
}

fn cell_array(elements: &mut Elements, depth: usize) -> Result<Value, Broken> {
    let mut words = Vec::new();
    while let Some((_, contents)) = elements.next()? {
        match array(contents, elements.order, depth - 1)?.value {
            Value::Words(mut rows) if rows.len() <= 1 => words.push(rows.pop().flatten()),
            _ => return Ok(Value::Other("a cell array of something other than text")),
        }
    }
    Ok(Value::Words(words))
}

fn structure(elements: &mut Elements, dimensions: &[f64], depth: usize) -> Result<Value, Broken> {
    if dimensions.iter().product::<f64>() != 1.0 {
        return Ok(Value::Other("an array of structures"));
    }
    let order = elements.order;
    let (_, length) = elements.expect("a structure without field names")?;
    let length = u32_at(length, 0, order)? as usize;
    let (_, names) = elements.expect("a structure without field names")?;
    let mut fields = Vec::new();
    for name in names.chunks(length.max(1)) {
        let (_, contents) = elements.expect("a structure with fewer fields than names")?;
        let end = name.iter().position(|b| *b == 0).unwrap_or(name.len());
        fields.push(Variable {
            name: text(&name[..end]),
            value: array(contents, order, depth - 1)?.value,
        });
    }
    Ok(Value::Fields(fields))
}
