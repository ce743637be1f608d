//! Lines of cells in columns, aligned with spaces.

/// Where the cells of a column stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Texts.
    Left,
    /// Numbers.
    Right,
}

/// Blanks between columns.
const GAP: &str = "  ";

/// A text without the marks that keep a page from breaking it: a terminal shows some of them as boxes.
pub fn plain(text: &str) -> String {
    text.replace('\u{a0}', " ").replace('\u{2060}', "")
}

/// The rows as lines; every row has as many cells as there are columns.
pub fn aligned(rows: &[Vec<String>], columns: &[Align]) -> Vec<String> {
    let of = |row: &Vec<String>| row.iter().map(|cell| plain(cell)).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(of).collect();
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let cell = |((text, align), width): ((&String, &Align), &usize)| match align {
        Align::Left => format!("{text:<width$}"),
        Align::Right => format!("{text:>width$}"),
    };
    rows.iter()
        .map(|row| {
            let cells: Vec<String> = row.iter().zip(columns).zip(&widths).map(cell).collect();
            cells.join(GAP).trim_end().to_owned()
        })
        .collect()
}

/// A text of at most so many characters, the rest replaced by an ellipsis; line ends become blanks.
pub fn shortened(text: &str, most: usize) -> String {
    let one_line: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if one_line.chars().count() <= most {
        return one_line;
    }
    let kept: String = one_line.chars().take(most - 1).collect();
    format!("{kept}…")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let row = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
        let lines = aligned(
            &[row("name", "N"), row("ε", "12.5")],
            &[Align::Left, Align::Right],
        );
        assert_eq!(lines, ["name     N", "ε     12.5"]);
        assert_eq!(shortened("abc\ndef", 6), "abc d…");
    }
}
