//! CSV after RFC 4180 with LF: full precision, one header line of keys, nothing rounded and nothing left out.

use super::Renderer;
use crate::markup;
use crate::table::{Audience, Cell, Column, Table};

/// Comma separated values.
pub struct Csv;

impl Renderer for Csv {
    fn extension(&self) -> &'static str {
        "csv"
    }

    fn is_data(&self) -> bool {
        true
    }

    fn render(&self, table: &Table) -> String {
        let visible = |c: &&Column| c.audience != Audience::People;
        let header: Vec<String> = table
            .columns
            .iter()
            .filter(visible)
            .flat_map(keys)
            .collect();
        let mut text = line(&header);
        for row in &table.rows {
            let cells = table.columns.iter().zip(row);
            let fields: Vec<String> = cells
                .filter(|(column, _)| visible(column))
                .flat_map(|(column, cell)| fields(column, cell))
                .collect();
            text.push_str(&line(&fields));
        }
        text
    }
}

fn keys(column: &Column) -> Vec<String> {
    if column.interval {
        vec![
            format!("{}_low", column.key),
            format!("{}_high", column.key),
        ]
    } else {
        vec![column.key.clone()]
    }
}

/// The fields of a cell: two in an interval column, else one.
fn fields(column: &Column, cell: &Cell) -> Vec<String> {
    match cell {
        Cell::Interval { low, high, .. } => vec![number(*low), number(*high)],
        _ if column.interval => vec![String::new(), String::new()],
        Cell::Empty => vec![String::new()],
        Cell::Text(text) => vec![text.clone()],
        Cell::Symbol(symbol) => vec![markup::plain(symbol)],
        Cell::Integer(value) => vec![value.to_string()],
        Cell::Number { value, .. } => vec![number(*value)],
        Cell::Flag(flag) => vec![flag.to_string()],
    }
}

/// The shortest text that reads back as the same number; empty for what is no number.
fn number(value: f64) -> String {
    if value.is_nan() {
        return String::new();
    }
    let size = value.abs();
    if size == 0.0 {
        "0".to_string()
    } else if (1e-5..1e16).contains(&size) || size.is_infinite() {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn line(fields: &[String]) -> String {
    let fields: Vec<String> = fields.iter().map(|f| escape(f)).collect();
    fields.join(",") + "\n"
}

/// Quotes a field that holds a separator, a quote or an end of line.
fn escape(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::sample;

    #[test]
    fn golden() {
        assert_eq!(
            Csv.render(&sample()),
            "model,campaign,coefficient,value,ci_low,ci_high,n,fitted_here\n\
             \"A&B \"\"x\"\", #1\",c_1,b_1,-7.1234,-8.3,-5.9,12345,true\n\
             \"two\nlines | a_b\",c2,F_620,0.25,,,7,false\n"
        );
    }

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        for value in [
            0.1,
            1.0 / 3.0,
            1e-6,
            -2.5e300,
            5e-324,
            123456789.125,
            1e16,
            f64::MAX,
        ] {
            assert_eq!(
                number(value).parse::<f64>().unwrap().to_bits(),
                value.to_bits()
            );
        }
        assert_eq!(number(1e-6), "1e-6");
        assert_eq!(number(-0.0), "0");
        assert_eq!(number(f64::NAN), "");
    }
}
