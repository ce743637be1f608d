//! LaTeX with booktabs and siunitx: decimal columns are `S` columns, other numbers stand in `\num`.
//!
//! A table fits on a page of `article`: one that is wider than the text is set smaller (graphicx), a very wide one is turned (rotating) and its words
//! are broken in paragraphs (array), and a long one goes on in further tables.

use super::Renderer;
use super::printed::{Group, Head, Printed, PrintedTable};
use crate::markup::{self, Piece, Script};
use crate::number::Rounded;
use crate::table::{Align, Table};

/// LaTeX.
pub struct Latex;

/// A table with more letters in a line is turned.
const TURNED: usize = 120;
/// Begins what is as wide as it is, or as the line where it is wider.
const SCALED: &str = "\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{%";
/// Words longer than this are broken in a paragraph of that width.
const LONGEST_WORDS: usize = 34;
const PARAGRAPH: &str = ">{\\raggedright\\arraybackslash}p{48mm}";
/// Most lines of a table on a page, upright and turned.
const LINES: [usize; 2] = [40, 24];
/// Letters between two columns.
const GUTTER: usize = 2;
/// LaTeX holds no more tables in store.
const FLUSHED: usize = 8;

impl Renderer for Latex {
    fn extension(&self) -> &'static str {
        "tex"
    }

    fn render(&self, table: &Table) -> String {
        let sheet = Sheet::new(table);
        let parts = sheet.parts();
        let packages = "% needs \\usepackage{array,booktabs,graphicx,rotating,siunitx}\n";
        let mut text = packages.to_owned();
        for (k, part) in parts.iter().enumerate() {
            text.push_str(&sheet.part(part.clone(), k == 0));
            let is_last = k + 1 == parts.len();
            if (k + 1) % FLUSHED == 0 && !is_last {
                text.push_str("\\clearpage\n");
            }
        }
        text
    }
}

/// A table as it is laid out on pages.
struct Sheet<'a> {
    table: &'a Table,
    printed: PrintedTable,
    /// Letters of the widest cell of each column, and whether it has to be broken.
    widths: Vec<(usize, bool)>,
    turned: bool,
}

impl<'a> Sheet<'a> {
    fn new(table: &'a Table) -> Self {
        let printed = PrintedTable::new(table);
        let widest = |k: usize| {
            let cells = printed.rows.iter().map(|row| letters(&row[k]));
            let heading = letters_of(&printed.heads[k].heading);
            cells.max().unwrap_or(0).max(heading)
        };
        let breaks = |k: usize| printed.rows.iter().any(|row| breaks(&row[k]));
        let columns = 0..printed.heads.len();
        let widths: Vec<(usize, bool)> = columns.map(|k| (widest(k), breaks(k))).collect();
        let turned = letters_across(&widths) > TURNED;
        Self {
            table,
            printed,
            widths,
            turned,
        }
    }

    /// The rows of each part: as many as have room on a page.
    fn parts(&self) -> Vec<std::ops::Range<usize>> {
        let most = LINES[usize::from(self.turned)];
        let mut parts = Vec::new();
        let (mut from, mut lines) = (0, 0);
        for k in 0..self.printed.rows.len() {
            let own = self.lines(k);
            if lines + own > most && k > from {
                parts.push(from..k);
                (from, lines) = (k, 0);
            }
            lines += own;
        }
        parts.push(from..self.printed.rows.len());
        parts
    }

    /// Lines of a row.
    fn lines(&self, row: usize) -> usize {
        let cells = self.printed.rows[row].iter();
        let of_cell = |cell: &Printed| letters(cell).div_ceil(LONGEST_WORDS).max(1);
        cells.map(of_cell).max().unwrap_or(1)
    }

    fn part(&self, rows: std::ops::Range<usize>, is_first: bool) -> String {
        let environment = if self.turned {
            "sidewaystable"
        } else {
            "table"
        };
        let place = if self.turned { "" } else { "[tbp]" };
        let caption = rich(&markup::parse(&self.table.caption));
        let mut lines = vec![
            format!("\\begin{{{environment}}}{place}"),
            "\\centering".into(),
        ];
        if is_first {
            lines.push(format!("\\caption{{{caption}}}"));
            let label = self.table.id.replace('_', "-");
            lines.push(format!("\\label{{tab:{label}}}"));
        } else {
            lines.push("\\addtocounter{table}{-1}".into());
            lines.push(format!("\\caption{{{caption} (continued)}}"));
        }
        lines.push(SCALED.into());
        let end = rows.end;
        lines.extend(self.tabular(rows));
        lines.push("}".into());
        let is_last = end == self.printed.rows.len();
        for note in self.table.notes.iter().filter(|_| is_last) {
            let note = rich(&markup::parse(note));
            lines.push(format!(
                "\n\\smallskip\\parbox{{\\linewidth}}{{\\footnotesize {note}}}"
            ));
        }
        lines.push(format!("\\end{{{environment}}}\n"));
        lines.join("\n")
    }

    fn tabular(&self, rows: std::ops::Range<usize>) -> Vec<String> {
        let printed = &self.printed;
        let columns = printed.heads.iter().zip(&self.widths);
        let columns: String = columns
            .map(|(head, (_, breaks))| column(head, *breaks))
            .collect();
        let mut lines = vec![
            format!("\\begin{{tabular}}{{@{{}}{columns}@{{}}}}"),
            "\\toprule".into(),
        ];
        lines.extend(group_lines(printed));
        let headings: Vec<String> = printed.heads.iter().map(heading).collect();
        lines.push(row(&headings));
        lines.push("\\midrule".into());
        let first = rows.start;
        for i in rows {
            if self.table.rules.contains(&i) && i > first {
                lines.push("\\midrule".into());
            }
            let cells = printed.rows[i].iter().zip(&printed.heads);
            lines.push(row(&cells
                .map(|(c, head)| cell(c, head))
                .collect::<Vec<_>>()));
        }
        lines.push("\\bottomrule".into());
        lines.push("\\end{tabular}".into());
        lines
    }
}

/// Letters of a line across all columns.
fn letters_across(widths: &[(usize, bool)]) -> usize {
    let width = |(letters, breaks): &(usize, bool)| match breaks {
        true => LONGEST_WORDS,
        false => *letters,
    };
    widths.iter().map(|w| width(w) + GUTTER).sum()
}

/// Whether a cell is too long for a line and can be broken: a digest cannot.
fn breaks(cell: &Printed) -> bool {
    matches!(cell, Printed::Text(text) if letters(cell) > LONGEST_WORDS && text.contains(' '))
}

/// How many letters a cell has.
fn letters(cell: &Printed) -> usize {
    match cell {
        Printed::Empty => 0,
        Printed::Undefined => 1,
        Printed::Text(text) => text.chars().count(),
        Printed::Rich(pieces) => letters_of(pieces),
        Printed::Number(n) => n.ascii().len(),
        Printed::Interval(low, high) => n_letters(low) + n_letters(high) + 4,
        Printed::Flag(_) => 3,
    }
}

fn n_letters(n: &Rounded) -> usize {
    n.ascii().len()
}

fn letters_of(pieces: &[Piece]) -> usize {
    pieces.iter().map(|p| p.text.chars().count()).sum()
}

fn row(cells: &[String]) -> String {
    format!("{} \\\\", cells.join(" & "))
}

fn column(head: &Head, breaks: bool) -> String {
    match (head.decimal, head.align) {
        _ if breaks => PARAGRAPH.into(),
        (Some((whole, fraction)), _) => format!("S[table-format={whole}.{fraction}]"),
        (None, Align::Left) => "l".into(),
        (None, Align::Center) => "c".into(),
        (None, Align::Right) => "r".into(),
    }
}

/// Braces keep an `S` column from reading its heading as a number.
fn heading(head: &Head) -> String {
    let text = rich(&head.heading);
    match head.decimal {
        Some(_) => format!("{{{text}}}"),
        None => text,
    }
}

fn group_lines(printed: &PrintedTable) -> Vec<String> {
    if printed.groups.is_empty() {
        return Vec::new();
    }
    let mut cells = Vec::new();
    let mut at = 0;
    for Group {
        heading,
        first,
        last,
    } in &printed.groups
    {
        cells.resize(cells.len() + first - at, String::new());
        let span = last - first + 1;
        cells.push(format!("\\multicolumn{{{span}}}{{c}}{{{}}}", rich(heading)));
        at = last + 1;
    }
    cells.resize(cells.len() + printed.heads.len() - at, String::new());
    let rule = |g: &Group| format!("\\cmidrule(lr){{{}-{}}}", g.first + 1, g.last + 1);
    vec![row(&cells), printed.groups.iter().map(rule).collect()]
}

fn cell(cell: &Printed, head: &Head) -> String {
    match cell {
        Printed::Empty => String::new(),
        Printed::Undefined => "{--}".into(),
        Printed::Text(text) => escape(text),
        Printed::Rich(pieces) => rich(pieces),
        Printed::Number(n) if head.decimal.is_some() => n.ascii(),
        Printed::Number(n) => number(n),
        Printed::Interval(low, high) => format!("{{[}}{}, {}{{]}}", number(low), number(high)),
        Printed::Flag(true) => "yes".into(),
        Printed::Flag(false) => "no".into(),
    }
}

fn number(n: &Rounded) -> String {
    let percent = if n.percent { "\\%" } else { "" };
    format!("\\num{{{}}}{percent}", n.ascii())
}

/// Runs of variables and scripts become one formula each, so that a subscript sits at its letter.
fn rich(pieces: &[Piece]) -> String {
    let formula = |p: &Piece| p.italic || p.script != Script::Base;
    let mut text = String::new();
    for run in pieces.chunk_by(|a, b| formula(a) && formula(b)) {
        if formula(&run[0]) {
            let empty_base = if run[0].italic { "" } else { "{}" };
            let inner: String = run.iter().map(in_formula).collect();
            text.push_str(&format!("\\({empty_base}{inner}\\)"));
        } else {
            text.push_str(&escape(&run[0].text));
        }
    }
    text
}

fn in_formula(piece: &Piece) -> String {
    let symbols: String = piece.text.chars().map(formula_symbol).collect();
    let upright = piece.text.chars().any(|c| c.is_ascii_alphabetic());
    let inner = if upright && !piece.italic {
        format!("\\mathrm{{{symbols}}}")
    } else {
        symbols
    };
    match piece.script {
        Script::Base => inner,
        Script::Sub => format!("_{{{inner}}}"),
        Script::Super => format!("^{{{inner}}}"),
    }
}

fn formula_symbol(c: char) -> String {
    match c {
        '\u{2212}' => "-".into(),
        _ => greek(c).map_or_else(|| escape(&c.to_string()), |name| format!("{name} ")),
    }
}

/// Text that LaTeX prints as it stands. The one place of escapes of this format.
fn escape(text: &str) -> String {
    text.chars().map(escape_char).collect()
}

fn escape_char(c: char) -> String {
    let fixed = match c {
        '\\' => "\\textbackslash{}",
        '~' => "\\textasciitilde{}",
        '^' => "\\textasciicircum{}",
        '<' => "\\textless{}",
        '>' => "\\textgreater{}",
        '|' => "\\textbar{}",
        '"' => "''",
        '[' => "{[}",
        ']' => "{]}",
        '°' => "\\textdegree{}",
        'µ' | 'μ' => "\\textmu{}",
        '–' => "--",
        '—' => "---",
        '…' => "\\ldots{}",
        '\u{a0}' => "~",
        '\u{2009}' | '\u{202f}' => "\\,",
        '\u{2212}' => "\\(-\\)",
        '√' => "\\(\\surd\\)",
        'ϕ' | 'φ' => "\\(\\phi\\)",
        '×' => "\\(\\times\\)",
        '±' => "\\(\\pm\\)",
        '·' => "\\(\\cdot\\)",
        '≤' => "\\(\\leq\\)",
        '≥' => "\\(\\geq\\)",
        '≈' => "\\(\\approx\\)",
        '→' => "\\(\\rightarrow\\)",
        '∞' => "\\(\\infty\\)",
        '∅' | '⌀' => "\\(\\emptyset\\)",
        '{' | '}' | '$' | '&' | '#' | '_' | '%' => return format!("\\{c}"),
        _ if let Some(raised) = raised(c) => return format!("\\textsuperscript{{{raised}}}"),
        _ => return greek(c).map_or_else(|| c.to_string(), |name| format!("\\({name}\\)")),
    };
    fixed.to_string()
}

/// The sign of which a character is the superscript.
fn raised(c: char) -> Option<char> {
    const RAISED: [char; 11] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹', '⁻'];
    const SIGNS: [char; 11] = ['0', '1', '2', '3', '4', '5', '6', '7', '8', '9', '-'];
    RAISED.iter().position(|r| *r == c).map(|k| SIGNS[k])
}

/// The command of a Greek letter that the Latin alphabet does not have.
fn greek(c: char) -> Option<&'static str> {
    GREEK
        .iter()
        .find(|(letter, _)| *letter == c)
        .map(|(_, command)| *command)
}

#[rustfmt::skip]
const GREEK: [(char, &str); 34] = [
    ('α', "\\alpha"), ('β', "\\beta"), ('γ', "\\gamma"), ('δ', "\\delta"), ('ε', "\\varepsilon"), ('ζ', "\\zeta"),
    ('η', "\\eta"), ('θ', "\\theta"), ('ι', "\\iota"), ('κ', "\\kappa"), ('λ', "\\lambda"), ('μ', "\\mu"),
    ('ν', "\\nu"), ('ξ', "\\xi"), ('π', "\\pi"), ('ρ', "\\rho"), ('ς', "\\varsigma"), ('σ', "\\sigma"),
    ('τ', "\\tau"), ('υ', "\\upsilon"), ('φ', "\\varphi"), ('χ', "\\chi"), ('ψ', "\\psi"), ('ω', "\\omega"),
    ('Γ', "\\Gamma"), ('Δ', "\\Delta"), ('Θ', "\\Theta"), ('Λ', "\\Lambda"), ('Ξ', "\\Xi"), ('Π', "\\Pi"),
    ('Σ', "\\Sigma"), ('Φ', "\\Phi"), ('Ψ', "\\Psi"), ('Ω', "\\Omega"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::sample;

    #[test]
    fn golden() {
        let expected = r#"% needs \usepackage{array,booktabs,graphicx,rotating,siunitx}
\begin{table}[tbp]
\centering
\caption{Coefficients of \(F_{620}\), \(R^{2}\) \& \(\varepsilon \)*}
\label{tab:coefficients}
\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{%
\begin{tabular}{@{}llS[table-format=2.2]crc@{}}
\toprule
 &  & \multicolumn{2}{c}{Estimate} &  &  \\
\cmidrule(lr){3-4}
Model & Coefficient & {Value (N/m)} & 95 \% CI (N/m) & \(n\) & Fitted \\
\midrule
A\&B ''x'', \#1 & \(b_{1}\) & -7.1 & {[}\num{-8.3}, \num{-5.9}{]} & \num{12345} & yes \\
\midrule
two lines \textbar{} a\_b & \(F_{620}\) & 0.25 &  & \num{7} & no \\
\bottomrule
\end{tabular}
}

\smallskip\parbox{\linewidth}{\footnotesize Sizes in \textmu{}m\_; 5 \% of all.}
\end{table}
"#;
        assert_eq!(Latex.render(&sample()), expected);
    }

    /// A table of so many rows with so many columns of words.
    fn words(rows: usize, columns: usize, word: &str) -> String {
        use crate::described::Described;
        let column = |t: Described<'static, usize>, k: usize| {
            let word = word.to_owned();
            t.text(&format!("c{k}"), "Heading", move |_| word.clone())
        };
        let table = Described::<usize>::new("t", "T").note("N");
        Latex.render(&(0..columns).fold(table, column).rows(0..rows))
    }

    #[test]
    fn a_table_is_scaled_to_its_line_a_wide_one_turned_and_long_words_are_broken() {
        let narrow = words(3, 2, "word");
        assert!(narrow.contains(SCALED) && !narrow.contains("sidewaystable"));
        let very_wide = words(3, 20, "some words");
        assert!(very_wide.contains("\\begin{sidewaystable}"));
        assert!(words(1, 1, &"word ".repeat(20)).contains(PARAGRAPH));
    }

    #[test]
    fn a_long_table_goes_on_in_further_ones_and_loses_no_row() {
        let text = words(400, 2, "word");
        let tables = text.matches("\\begin{table}").count();
        assert_eq!(tables, 400 / LINES[0]);
        assert_eq!(text.matches("(continued)").count(), tables - 1);
        assert_eq!(text.matches("word & word").count(), 400);
        assert_eq!(text.matches("\\clearpage").count(), (tables - 1) / FLUSHED);
        assert_eq!(text.matches("\\label").count(), 1);
        assert_eq!(text.matches("footnotesize N").count(), 1);
    }

    #[test]
    fn words_below_the_line_stay_upright() {
        assert_eq!(rich(&markup::parse("l_rest")), r"\(l_{\mathrm{rest}}\)");
        assert_eq!(rich(&markup::parse("CO_2")), r"CO\({}_{2}\)");
        assert_eq!(
            rich(&markup::parse("ΔF, 10^{−3}")),
            r"\(\Delta\)F, 10\({}^{-3}\)"
        );
    }

    #[test]
    fn powers_of_ten_and_percentages_stand_in_num() {
        let small = crate::number::Rounding::Digits(2).round(1.5e-7).unwrap();
        assert_eq!(number(&small), r"\num{1.5e-7}");
        let share = crate::number::Rounding::Percent(1).round(0.984).unwrap();
        assert_eq!(number(&share), r"\num{98.4}\%");
    }
}
