//! GitHub flavoured Markdown, which knows neither rules between rows nor headings over several columns: the latter precede
//! the column's own heading.

use super::Renderer;
use super::printed::{Printed, PrintedTable};
use crate::markup::{self, Piece, Script};
use crate::number::Rounded;
use crate::table::{Align, Table};

/// Markdown.
pub struct Markdown;

impl Renderer for Markdown {
    fn extension(&self) -> &'static str {
        "md"
    }

    fn render(&self, table: &Table) -> String {
        let printed = PrintedTable::new(table);
        let headings: Vec<String> = (0..printed.heads.len())
            .map(|i| heading(&printed, i))
            .collect();
        let sides: Vec<String> = printed.heads.iter().map(|h| side(h.align).into()).collect();
        let caption = rich(&markup::parse(&table.caption));
        let mut lines = vec![
            format!("**{caption}**"),
            String::new(),
            row(&headings),
            row(&sides),
        ];
        for cells in &printed.rows {
            lines.push(row(&cells.iter().map(cell).collect::<Vec<_>>()));
        }
        for note in &table.notes {
            lines.push(String::new());
            lines.push(rich(&markup::parse(note)));
        }
        lines.join("\n") + "\n"
    }
}

fn row(cells: &[String]) -> String {
    format!("| {} |", cells.join(" | "))
}

fn heading(printed: &PrintedTable, column: usize) -> String {
    let own = rich(&printed.heads[column].heading);
    match printed
        .groups
        .iter()
        .find(|g| (g.first..=g.last).contains(&column))
    {
        Some(group) => format!("{}: {own}", rich(&group.heading)),
        None => own,
    }
}

fn side(align: Align) -> &'static str {
    match align {
        Align::Left => ":---",
        Align::Center => ":---:",
        Align::Right => "---:",
    }
}

fn cell(cell: &Printed) -> String {
    match cell {
        Printed::Empty => String::new(),
        Printed::Undefined => "–".into(),
        Printed::Text(text) => escape(text),
        Printed::Rich(pieces) => rich(pieces),
        Printed::Number(n) => number(n),
        Printed::Interval(low, high) => format!("\\[{}, {}\\]", number(low), number(high)),
        Printed::Flag(true) => "yes".into(),
        Printed::Flag(false) => "no".into(),
    }
}

fn number(n: &Rounded) -> String {
    let percent = if n.percent { "%" } else { "" };
    let power = n.exponent.map(|e| format!(" × 10<sup>{e}</sup>"));
    format!("{}{}{percent}", n.typeset(), power.unwrap_or_default())
}

fn rich(pieces: &[Piece]) -> String {
    let piece = |p: &Piece| {
        let text = escape(&p.text);
        let text = if p.italic { format!("*{text}*") } else { text };
        match p.script {
            Script::Base => text,
            Script::Sub => format!("<sub>{text}</sub>"),
            Script::Super => format!("<sup>{text}</sup>"),
        }
    };
    pieces.iter().map(piece).collect()
}

/// Text that Markdown shows as it stands. The one place of escapes of this format.
fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '|' | '[' | ']' | '#' | '~' => out.extend(['\\', c]),
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::sample;

    #[test]
    fn golden() {
        let expected = r#"**Coefficients of *F*<sub>620</sub>, *R*<sup>2</sup> &amp; *ε*\***

| Model | Coefficient | Estimate: Value (N/m) | Estimate: 95 % CI (N/m) | *n* | Fitted |
| :--- | :--- | ---: | :---: | ---: | :---: |
| A&amp;B "x", \#1 | *b*<sub>1</sub> | −7.1 | \[−8.3, −5.9\] | 12 345 | yes |
| two lines \| a\_b | *F*<sub>620</sub> | 0.25 |  | 7 | no |

Sizes in µm\_; 5 % of all.
"#
        .replace("12 345", "12\u{202f}345");
        assert_eq!(Markdown.render(&sample()), expected);
    }
}
