//! The variables of a MATLAB file as a table: vectors of one length, a matrix, or a structure of vectors.

use super::columns::{Columns, texts};
use super::table::{Cells, Source, Table, unreadable};
use pipeline_base::diagnostics::Diagnostic;

/// A variable of a workspace, or a field of a structure.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub value: Value,
}

/// What a variable holds.
#[derive(Clone, Debug)]
pub enum Value {
    /// Numbers, column after column.
    Matrix {
        /// How many numbers a column has.
        rows: usize,
        /// The numbers, a multiple of `rows` of them.
        numbers: Vec<f64>,
    },
    /// Words, one each row.
    Words(Vec<Option<String>>),
    /// A structure.
    Fields(Vec<Variable>),
    /// What cannot be read, by its name.
    Other(&'static str),
}

impl Value {
    /// The length of a vector, of numbers or of words.
    fn vector_length(&self) -> Option<usize> {
        match self {
            Value::Matrix { rows, numbers } => {
                (*rows == 1 || *rows == numbers.len()).then_some(numbers.len())
            }
            Value::Words(words) => Some(words.len()),
            Value::Fields(_) | Value::Other(_) => None,
        }
    }

    fn describe(&self) -> String {
        match (self, self.vector_length()) {
            (Value::Matrix { .. } | Value::Words(_), Some(n)) => format!("{n} values"),
            (Value::Matrix { rows, numbers }, None) => {
                format!("a matrix of {rows} by {}", numbers.len() / (*rows).max(1))
            }
            (Value::Fields(_), _) => "a structure".to_owned(),
            (Value::Other(what), _) => (*what).to_owned(),
            (Value::Words(_), None) => "words".to_owned(),
        }
    }
}

/// The table that a session means: the variable that it names; or the vectors, where there are some; or the only matrix or structure.
///
/// # Errors
/// No such variable, or no single one.
pub fn table(source: &Source, variables: Vec<Variable>) -> Result<Columns, Diagnostic> {
    let found = listed(&variables);
    let refused =
        |expected: String, hint: &str| Err(unreadable(source.file, found.clone(), expected, hint));
    if let Some(part) = source.part {
        let Some(variable) = variables.into_iter().find(|v| v.name == part.name) else {
            let expected = format!("a variable named \"{}\"", part.name);
            return refused(expected, "correct `variable` in session.toml");
        };
        return match columns(variable) {
            Some(columns) => Ok(columns),
            None => refused(
                format!("numbers or a structure of vectors in \"{}\"", part.name),
                "save a table with table2struct(T, 'ToScalar', true)",
            ),
        };
    }
    let (vectors, others): (Vec<Variable>, Vec<Variable>) = variables
        .into_iter()
        .partition(|v| v.value.vector_length().is_some());
    if vectors.iter().any(|v| v.value.vector_length() > Some(1)) {
        return Ok(of_vectors(vectors));
    }
    let mut tables = others.into_iter().filter_map(columns);
    match (tables.next(), tables.next()) {
        (Some(table), None) => Ok(table),
        (Some(_), Some(_)) => refused(
            "one matrix or structure, or vectors".to_owned(),
            "name the one that is the log with `variable` in its [[log]]",
        ),
        (None, _) => refused(
            "vectors of numbers, a matrix, or a structure of vectors".to_owned(),
            "save a table with table2struct(T, 'ToScalar', true)",
        ),
    }
}

fn listed(variables: &[Variable]) -> String {
    const LISTED: usize = 12;
    if variables.is_empty() {
        return "no variables".to_owned();
    }
    let mut parts: Vec<String> = variables
        .iter()
        .take(LISTED)
        .map(|v| format!("{} ({})", v.name, v.value.describe()))
        .collect();
    if variables.len() > LISTED {
        parts.push(format!("{} more", variables.len() - LISTED));
    }
    format!("the variables {}", parts.join(", "))
}

/// A variable as a table; nothing where it holds neither numbers nor words.
fn columns(variable: Variable) -> Option<Columns> {
    if variable.value.vector_length().is_some() {
        return Some(of_vectors(vec![variable]));
    }
    match variable.value {
        Value::Matrix { rows, numbers } if rows > 0 => {
            let mut columns = Columns::starting_at(1);
            for column in numbers.chunks(rows) {
                columns.push("", Cells::Numbers(column.to_vec()));
            }
            Some(columns)
        }
        Value::Fields(fields) => Some(of_vectors(fields)),
        _ => None,
    }
}

/// The vectors among some variables, a column each.
fn of_vectors(variables: Vec<Variable>) -> Columns {
    let mut columns = Columns::starting_at(1);
    for variable in variables {
        let is_vector = variable.value.vector_length().is_some();
        match variable.value {
            Value::Matrix { numbers, .. } if is_vector => {
                columns.push(variable.name, Cells::Numbers(numbers));
            }
            Value::Words(words) => columns.push(variable.name, texts(words)),
            _ => {}
        }
    }
    columns
}

/// A boxed table, as a format gives it.
pub fn boxed<'a>(
    source: &Source<'a>,
    variables: Vec<Variable>,
) -> Result<Box<dyn Table + 'a>, Diagnostic> {
    Ok(Box::new(table(source, variables)?))
}
