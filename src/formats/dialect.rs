//! How a text log writes its rows: comma, semicolon or tab between cells, point or comma in numbers.

use std::borrow::Cow;

/// How many lines are looked at for the separator.
const LINES_LOOKED_AT: usize = 20;

/// What may stand between cells. Where two give the same cells the first does: `1,5;2,5` are two numbers with a decimal comma.
const SEPARATORS: [char; 3] = [';', '\t', ','];

/// How a text log writes its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    /// Between cells.
    pub separator: char,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: bool,
}

impl Dialect {
    /// The dialect of a text: the separator that makes the most cells numbers of its first lines, or failing numbers the most cells.
    pub fn of(text: &str) -> Self {
        let lines = || text.lines().filter(|l| !l.trim().is_empty());
        let score = |separator: &char| {
            let cells = || {
                lines()
                    .take(LINES_LOOKED_AT)
                    .flat_map(|l| l.split(*separator))
            };
            let comma = *separator != ',';
            let numbers = cells().filter(|c| is_number(c.trim(), comma)).count();
            (numbers, cells().count())
        };
        let mut separator = SEPARATORS[0];
        for candidate in &SEPARATORS[1..] {
            if score(candidate) > score(&separator) {
                separator = *candidate;
            }
        }
        let is_decimal = |cell: &str| cell.contains(',') && is_number(cell.trim(), true);
        let decimal_comma = separator != ','
            && lines()
                .filter(|l| l.contains(','))
                .any(|l| l.split(separator).any(is_decimal));
        Self {
            separator,
            decimal_comma,
        }
    }

    /// The text without blanks beside separators and line ends, its numbers with decimal points.
    ///
    /// A quote without its partner in a line would swallow the lines below: the quotes of such a line are taken out.
    ///
    /// Where commas are decimal a point is not: `1.234` may be a thousand and more, so it becomes a cell that is no number and is
    /// reported.
    pub fn plain(self, text: &str) -> Cow<'_, str> {
        let is_plain = !has_blanks(text, self.separator) && !has_open_quotes(text);
        if is_plain && !self.decimal_comma {
            return Cow::Borrowed(text);
        }
        let mut plain = String::with_capacity(text.len());
        for line in text.lines() {
            let line = without_open_quote(line);
            for (k, field) in line.split(self.separator).enumerate() {
                if k > 0 {
                    plain.push(self.separator);
                }
                let field = field.trim();
                if self.decimal_comma && (is_number(field, true) || is_number(field, false)) {
                    plain.extend(field.chars().map(exchanged));
                } else {
                    plain.push_str(field);
                }
            }
            plain.push('\n');
        }
        Cow::Owned(plain)
    }
}

fn has_open_quotes(text: &str) -> bool {
    memchr::memchr(b'"', text.as_bytes()).is_some()
        && text.lines().any(|l| l.matches('"').count() % 2 == 1)
}

fn without_open_quote(line: &str) -> Cow<'_, str> {
    if line.matches('"').count() % 2 == 1 {
        return Cow::Owned(line.replace('"', ""));
    }
    Cow::Borrowed(line)
}

fn exchanged(c: char) -> char {
    match c {
        ',' => '.',
        '.' => ',',
        c => c,
    }
}

fn has_blanks(text: &str, separator: char) -> bool {
    let is_blank = |b: &u8| (*b == b' ' || *b == b'\t') && char::from(*b) != separator;
    // A block at a time without a way out of it, which the compiler makes many bytes at a time of.
    text.as_bytes()
        .chunks(4096)
        .any(|block| block.iter().fold(false, |found, b| found | is_blank(b)))
}

/// Whether a cell is written as a number, with a decimal comma if `comma` is set: digits and a sign, no word such as `inf`.
pub fn is_number(cell: &str, comma: bool) -> bool {
    let point = if comma { ',' } else { '.' };
    let mut digits = false;
    let mut allowed = true;
    for c in cell.chars() {
        digits |= c.is_ascii_digit();
        allowed &= c.is_ascii_digit() || c == point || "+-eE".contains(c);
    }
    let ends_well = cell.ends_with(|c: char| c.is_ascii_digit());
    digits && allowed && (!comma || ends_well) && parses(cell, comma)
}

fn parses(cell: &str, comma: bool) -> bool {
    if comma {
        cell.replacen(',', ".", 1).parse::<f64>().is_ok()
    } else {
        cell.parse::<f64>().is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_separator_is_what_makes_cells_numbers() {
        let of = |text: &str| {
            let d = Dialect::of(text);
            (d.separator, d.decimal_comma)
        };
        assert_eq!(of("1,2,3\n4,5,6\n"), (',', false));
        assert_eq!(of("1, 2,\t3\n"), (',', false));
        assert_eq!(of("1.5;2;3\n"), (';', false));
        assert_eq!(of("force;pressure\n1,5;2,5\n"), (';', true));
        assert_eq!(of("t;p (kPa, gauge)\n1;2\n3,5;4\n"), (';', true));
        assert_eq!(of("t;p (kPa, gauge)\n1;2\n"), (';', false));
        assert_eq!(of("1,5\t2\n"), ('\t', true));
        assert_eq!(of("force\tpressure\n1\t2\n"), ('\t', false));
        assert_eq!(of("7\n8\n"), (';', false));
    }

    #[test]
    fn a_quote_without_its_partner_swallows_no_lines() {
        let text = "1,\"a\n2,b\n3,\"c,d\"\n";
        let plain = Dialect::of(text).plain(text).into_owned();
        assert_eq!(plain, "1,a\n2,b\n3,\"c,d\"\n");
    }

    #[test]
    fn a_point_among_decimal_commas_is_no_number() {
        let text = "1,5; bench, A\n1.234;x\n-2,5e3;y\n";
        let plain = Dialect::of(text).plain(text).into_owned();
        assert_eq!(plain, "1.5;bench, A\n1,234;x\n-2.5e3;y\n");
    }
}
