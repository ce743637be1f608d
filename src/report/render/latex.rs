//! LaTeX with booktabs and siunitx: decimal columns are `S` columns, other numbers stand in `\num`.

use super::Renderer;
use super::printed::{Group, Head, Printed, PrintedTable};
use crate::markup::{self, Piece, Script};
use crate::number::Rounded;
use crate::table::{Align, Table};

/// LaTeX.
pub struct Latex;

impl Renderer for Latex {
    fn extension(&self) -> &'static str {
        "tex"
    }

    fn render(&self, table: &Table) -> String {
        let printed = PrintedTable::new(table);
        let columns: String = printed.heads.iter().map(column).collect();
        let mut lines = vec![
            "% needs \\usepackage{booktabs} and \\usepackage{siunitx}".to_string(),
            "\\begin{table}[tbp]".into(),
            "\\centering".into(),
            format!("\\caption{{{}}}", rich(&markup::parse(&table.caption))),
            format!("\\label{{tab:{}}}", table.id.replace('_', "-")),
            format!("\\begin{{tabular}}{{@{{}}{columns}@{{}}}}"),
            "\\toprule".into(),
        ];
        lines.extend(group_lines(&printed));
        let headings: Vec<String> = printed.heads.iter().map(heading).collect();
        lines.push(row(&headings));
        lines.push("\\midrule".into());
        for (i, cells) in printed.rows.iter().enumerate() {
            if table.rules.contains(&i) {
                lines.push("\\midrule".into());
            }
            let cells = cells.iter().zip(&printed.heads);
            lines.push(row(&cells
                .map(|(c, head)| cell(c, head))
                .collect::<Vec<_>>()));
        }
        lines.push("\\bottomrule".into());
        lines.push("\\end{tabular}".into());
        for note in &table.notes {
            let note = rich(&markup::parse(note));
            lines.push(format!("\n\\smallskip{{\\footnotesize {note}\\par}}"));
        }
        lines.push("\\end{table}\n".into());
        lines.join("\n")
    }
}

fn row(cells: &[String]) -> String {
    format!("{} \\\\", cells.join(" & "))
}

fn column(head: &Head) -> String {
    match (head.decimal, head.align) {
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
        '²' => "\\textsuperscript{2}",
        '³' => "\\textsuperscript{3}",
        '°' => "\\textdegree{}",
        'µ' | 'μ' => "\\textmu{}",
        '–' => "--",
        '—' => "---",
        '…' => "\\ldots{}",
        '\u{a0}' => "~",
        '\u{2009}' | '\u{202f}' => "\\,",
        '\u{2212}' => "\\(-\\)",
        '√' => "\\(\\surd\\)",
        '⁻' => "\\textsuperscript{-}",
        '⁶' => "\\textsuperscript{6}",
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
        _ => return greek(c).map_or_else(|| c.to_string(), |name| format!("\\({name}\\)")),
    };
    fixed.to_string()
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
        let expected = r#"% needs \usepackage{booktabs} and \usepackage{siunitx}
\begin{table}[tbp]
\centering
\caption{Coefficients of \(F_{620}\), \(R^{2}\) \& \(\varepsilon \)*}
\label{tab:coefficients}
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

\smallskip{\footnotesize Sizes in \textmu{}m\_; 5 \% of all.\par}
\end{table}
"#;
        assert_eq!(Latex.render(&sample()), expected);
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
