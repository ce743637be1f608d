//! Typst: a `figure` of kind table in the manner of booktabs. The file needs no template and can be included anywhere.

use super::Renderer;
use super::printed::{Group, Printed, PrintedTable};
use crate::markup::{self, Piece, Script};
use crate::number::Rounded;
use crate::table::{Align, Table};

/// Typst.
pub struct Typst;

/// Words up to this length are kept in one piece.
const LONGEST_WORD: usize = 40;
const HEAVY: &str = "0.8pt";
const LIGHT: &str = "0.5pt";
const THIN: &str = "0.3pt";
/// Width of the text in the table's letters, em; of a letter on average; between columns.
const TEXT_EM: f64 = 55.0;
const LETTER_EM: f64 = 0.44;
const GUTTER_EM: f64 = 1.1;
/// The same where a table would not fit otherwise.
const NARROW_GUTTER_EM: f64 = 0.75;
/// How much smaller than others a wide table may be set: 8 points in place of 9.
const SMALLEST: f64 = 0.89;
/// Rows from which on a table breaks across pages instead of floating.
pub const LONG: usize = 30;

impl Renderer for Typst {
    fn extension(&self) -> &'static str {
        "typ"
    }

    fn render(&self, table: &Table) -> String {
        let printed = PrintedTable::new(table);
        let aligns: Vec<&str> = printed.heads.iter().map(|h| side(h.align)).collect();
        let long = table.rows.len() > LONG;
        let mut lines = Vec::new();
        if long {
            lines.push("#show figure.where(kind: table): set block(breakable: true)".to_string());
        }
        lines.extend([
            "#figure(".to_string(),
            format!(
                "  kind: table,{}",
                if long { " placement: none," } else { "" }
            ),
            format!("  caption: {},", rich(&markup::parse(&table.caption))),
            "  {".into(),
            "    set text(number-type: \"lining\", number-width: \"tabular\")".into(),
            "    set block(above: 0.7em, below: 0.7em)".into(),
        ]);
        let widely = fits(&printed, GUTTER_EM);
        let (gutter, fits) = if widely < SMALLEST {
            (NARROW_GUTTER_EM, fits(&printed, NARROW_GUTTER_EM))
        } else {
            (GUTTER_EM, widely)
        };
        let size = fits.clamp(SMALLEST, 1.0);
        if size < 1.0 {
            lines.push(format!("    show table: set text(size: {size:.2}em)"));
        }
        lines.extend([
            "    table(".into(),
            format!("      columns: {},", printed.heads.len()),
            format!("      align: ({},),", aligns.join(", ")),
            format!("      stroke: none, inset: (x: 0pt, y: 0.34em), column-gutter: {gutter}em,"),
            format!("      table.hline(stroke: {HEAVY}),"),
        ]);
        lines.extend(header(&printed));
        lines.extend(body(&printed, &table.rules, fits >= SMALLEST));
        lines.push(format!("      table.hline(stroke: {HEAVY}),"));
        lines.push("    )".into());
        for note in &table.notes {
            let note = rich(&markup::parse(note));
            lines.push(format!("    block(align(left, text(size: 0.9em, {note})))"));
        }
        lines.push("  },".into());
        lines.push(format!(") <tab-{}>\n", label(&table.id)));
        lines.join("\n")
    }
}

/// The size of the letters at which the table keeps its cells on one line. An estimate from the number of letters, since
/// Typst's own measure would lay out every table twice.
fn fits(printed: &PrintedTable, gutter: f64) -> f64 {
    let widest = |k: usize| {
        let cells = printed.rows.iter().map(|row| letters(&row[k]));
        let heading = rich_letters(&printed.heads[k].heading);
        cells.fold(heading, f64::max).min(LONGEST_WORD as f64)
    };
    let columns = printed.heads.len();
    let letters: f64 = (0..columns).map(widest).sum();
    let width = LETTER_EM * letters + gutter * columns.saturating_sub(1) as f64;
    TEXT_EM / width
}

/// About how many letters wide a cell is.
fn letters(cell: &Printed) -> f64 {
    match cell {
        Printed::Rich(pieces) => rich_letters(pieces),
        Printed::Empty => 0.0,
        Printed::Undefined => 1.0,
        Printed::Text(text) => wide(text),
        Printed::Number(n) => wide(&number(n)),
        Printed::Interval(a, b) => 4.0 + wide(&number(a)) + wide(&number(b)),
        Printed::Flag(_) => 3.0,
    }
}

/// About how many average letters wide a text is: capitals and digits are wider than small letters.
fn wide(text: &str) -> f64 {
    let width = |c: char| match c {
        c if c.is_uppercase() => 1.4,
        c if c.is_ascii_digit() => 1.1,
        _ => 1.0,
    };
    text.chars().map(width).sum()
}

/// Sub- and superscripts are about two thirds as wide.
fn rich_letters(pieces: &[Piece]) -> f64 {
    let width = |p: &Piece| match p.script {
        Script::Base => wide(&p.text),
        _ => 0.65 * wide(&p.text),
    };
    pieces.iter().map(width).sum()
}

fn header(printed: &PrintedTable) -> Vec<String> {
    let mut lines = vec!["      table.header(".to_string()];
    let mut at = 0;
    for group in &printed.groups {
        lines.extend((at..group.first).map(|_| "        [],".to_string()));
        at = group.last + 1;
        let (span, heading) = (at - group.first, rich(&group.heading));
        lines.push(format!(
            "        table.cell(colspan: {span}, align: center, {heading}),"
        ));
    }
    if at > 0 {
        lines.extend((at..printed.heads.len()).map(|_| "        [],".to_string()));
    }
    for Group { first, last, .. } in &printed.groups {
        let end = last + 1;
        lines.push(format!(
            "        table.hline(start: {first}, end: {end}, stroke: {THIN}),"
        ));
    }
    let headings: Vec<String> = printed.heads.iter().map(|h| rich(&h.heading)).collect();
    lines.push(format!("        {},", headings.join(", ")));
    lines.push(format!("        table.hline(stroke: {LIGHT}),"));
    lines.push("      ),".into());
    lines
}

fn body(printed: &PrintedTable, rules: &[usize], whole_words: bool) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, row) in printed.rows.iter().enumerate() {
        if rules.contains(&i) {
            lines.push(format!("      table.hline(stroke: {THIN}),"));
        }
        let cells = row.iter().zip(&printed.heads);
        let cells: Vec<String> = cells
            .map(|(c, head)| cell(c, head.decimal.map(|(_, fraction)| fraction), whole_words))
            .collect();
        lines.push(format!("      {},", cells.join(", ")));
    }
    lines
}

fn side(align: Align) -> &'static str {
    match align {
        Align::Left => "left",
        Align::Center => "center",
        Align::Right => "right",
    }
}

/// An id as a Typst label: letters, digits, hyphens and points.
fn label(id: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || c == '.' {
            c
        } else {
            '-'
        }
    };
    id.chars().map(plain).collect()
}

/// A cell; in a decimal column padded to `fraction` digits after the point. Words break at their hyphens where a table is too wide to keep them whole:
/// else they would run over the next column.
fn cell(cell: &Printed, fraction: Option<usize>, whole_words: bool) -> String {
    match cell {
        Printed::Empty => "[]".into(),
        Printed::Undefined => quoted("–"),
        // One word, such as an id with hyphens, is not broken over lines.
        Printed::Text(word) if whole_words && !word.contains(' ') && word.len() <= LONGEST_WORD => {
            quoted(&word.replace('-', "\u{2011}"))
        }
        Printed::Text(text) => quoted(text),
        Printed::Rich(pieces) => rich(pieces),
        Printed::Number(n) => match fraction {
            Some(digits) => quoted(&padded(n, digits)),
            None => quoted(&number(n)),
        },
        Printed::Interval(low, high) => {
            quoted(&format!("[{},\u{a0}{}]", number(low), number(high)))
        }
        Printed::Flag(true) => quoted("yes"),
        Printed::Flag(false) => quoted("no"),
    }
}

/// Spaces as wide as a point and as a digit stand for those that are missing, so that right alignment aligns the points.
fn padded(n: &Rounded, digits: usize) -> String {
    let mut text = n.typeset();
    if n.fraction.is_empty() && digits > 0 {
        text.push('\u{2008}');
    }
    text.extend(std::iter::repeat_n('\u{2007}', digits - n.fraction.len()));
    text
}

fn number(n: &Rounded) -> String {
    let percent = if n.percent { "%" } else { "" };
    format!("{}{}{percent}", n.typeset(), n.power())
}

fn rich(pieces: &[Piece]) -> String {
    let piece = |p: &Piece| {
        let text = quoted(&p.text);
        let text = if p.italic {
            format!("emph({text})")
        } else {
            text
        };
        match p.script {
            Script::Base => format!("#{text}"),
            Script::Sub => format!("#sub({text})"),
            Script::Super => format!("#super({text})"),
        }
    };
    // A semicolon ends each expression, so that a bracket or a point after it is text.
    let inner: String = pieces.iter().map(|p| piece(p) + ";").collect();
    format!("[{inner}]")
}

/// A string literal, which Typst prints as it stands. The one place of escapes of this format.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::sample;
    use crate::typeset::Document;

    #[test]
    fn golden() {
        let expected = r##"#figure(
  kind: table,
  caption: [#"Coefficients of ";#emph("F");#sub("620");#", ";#emph("R");#super("2");#" & ";#emph("ε");#"*";],
  {
    set text(number-type: "lining", number-width: "tabular")
    set block(above: 0.7em, below: 0.7em)
    table(
      columns: 6,
      align: (left, left, right, center, right, center,),
      stroke: none, inset: (x: 0pt, y: 0.34em), column-gutter: 1.1em,
      table.hline(stroke: 0.8pt),
      table.header(
        [],
        [],
        table.cell(colspan: 2, align: center, [#"Estimate";]),
        [],
        [],
        table.hline(start: 2, end: 4, stroke: 0.3pt),
        [#"Model";], [#"Coefficient";], [#"Value (N/m)";], [#"95 % CI (N/m)";], [#emph("n");], [#"Fitted";],
        table.hline(stroke: 0.5pt),
      ),
      "A&B \"x\", #1", [#emph("b");#sub("1");], "−7.1 ", "[−8.3,~−5.9]", "12 345", "yes",
      table.hline(stroke: 0.3pt),
      "two lines | a_b", [#emph("F");#sub("620");], "0.25", [], "7", "no",
      table.hline(stroke: 0.8pt),
    )
    block(align(left, text(size: 0.9em, [#"Sizes in µm_; 5 % of all.";])))
  },
) <tab-coefficients>
"##;
        let expected = expected
            .replace("−7.1 ", "−7.1\u{2007}")
            .replace("12 345", "12\u{202f}345")
            .replace(",~", ",\u{a0}");
        assert_eq!(Typst.render(&sample()), expected);
    }

    #[test]
    fn long_tables_break_across_pages() {
        let mut table = sample();
        let rows = table.rows.clone();
        (0..30).for_each(|_| table.rows.extend(rows.clone()));
        let main = "#import \"/style.typ\": *\n#show: report\n#include \"t.typ\"";
        let document = |t: &Table| Document::new(main).file("t.typ", Typst.render(t));
        let long = document(&table).compile().unwrap();
        assert_eq!((long.sheets.len(), long.warnings), (2, vec![]));
        assert_eq!(document(&sample()).compile().unwrap().sheets.len(), 1);
    }

    #[test]
    fn ids_break_at_hyphens_where_a_table_is_too_wide_for_them() {
        let id = || Printed::Text("knee-flxpin10-48-t5-rejected".into());
        assert!(cell(&id(), None, true).contains('\u{2011}'));
        assert_eq!(cell(&id(), None, false), "\"knee-flxpin10-48-t5-rejected\"");
    }

    #[test]
    fn missing_decimals_are_padded_and_powers_raised() {
        assert_eq!(padded(&Rounded::integer(7), 2), "7\u{2008}\u{2007}\u{2007}");
        let small = crate::number::Rounding::Digits(2).round(1.5e-7).unwrap();
        assert_eq!(number(&small), "1.5\u{2009}×\u{2009}10⁻⁷");
    }
}
