//! What is wrong with a line that is no TOML, said by what stands in the line: the parser knows its grammar, and not what somebody meant.

use crate::diagnostics::Diagnostic;
use toml::de::DeTable;

/// The first defect of a text that is no TOML; none where it is.
pub fn defect(file: &str, text: &str) -> Option<Diagnostic> {
    let error = DeTable::parse(text).err()?;
    let offset = error.span().map_or(0, |s| s.start);
    let row = line_of(text, offset);
    let line = text.lines().nth(row as usize - 1).unwrap_or_default();
    let before = text.lines().take(row as usize - 1);
    let (expected, hint) = reason(line, before);
    let found = format!("`{}`", line.trim().chars().take(80).collect::<String>());
    Some(Diagnostic::error(file, found, expected, hint).at_row(row))
}

/// The line of a byte of a text, counted from 1.
pub fn line_of(text: &str, offset: usize) -> u64 {
    let end = offset.min(text.len());
    let before = &text.as_bytes()[..end];
    1 + before.iter().filter(|b| **b == b'\n').count() as u64
}

/// What the line should be, and what to do.
fn reason<'a>(line: &str, before: impl Iterator<Item = &'a str>) -> (&'static str, String) {
    let line = line.trim();
    let general = "a line `key = value`, with text in double quotes and no quotes around numbers";
    let correct = || "correct the line".to_owned();
    if line.starts_with('[') {
        return match line.contains(']') {
            true => (
                "a table that is begun once: `[name]` or `[[name]]`",
                correct(),
            ),
            false => ("a closing bracket", format!("write `{line}]`")),
        };
    }
    let Some((key, value)) = line.split_once('=') else {
        return (general, correct());
    };
    let (key, value) = (key.trim(), without_comment(value).trim());
    if value.is_empty() {
        return (
            "a value behind the =",
            format!("write it, or remove `{key}`"),
        );
    }
    if value.matches('"').count() % 2 == 1 {
        return ("a closing quote", "close the text with \"".to_owned());
    }
    if is_given_before(key, before) {
        return (
            "every key once",
            format!("remove one of the two lines `{key} = ...`"),
        );
    }
    if has_decimal_comma(value) {
        let value = value.replacen(',', ".", 1);
        return ("a decimal point", format!("write `{key} = {value}`"));
    }
    if value.starts_with(|c: char| c.is_alphabetic()) {
        return (
            "text in double quotes",
            format!("write `{key} = \"{value}\"`"),
        );
    }
    if value.contains('-') && value.starts_with(|c: char| c.is_ascii_digit()) {
        return (
            "a date that exists, in double quotes",
            "write it as \"2022-11-30\"".to_owned(),
        );
    }
    if value.starts_with(|c: char| c.is_ascii_digit()) && !value.contains('"') {
        let expected =
            "a number without its unit, which stands in the key, or text in double quotes";
        return (expected, correct());
    }
    (general, correct())
}

fn without_comment(value: &str) -> &str {
    match value.split_once('#') {
        Some((value, _)) if value.matches('"').count() % 2 == 0 => value,
        _ => value,
    }
}

/// Whether a key stands above in the same table.
fn is_given_before<'a>(key: &str, before: impl Iterator<Item = &'a str>) -> bool {
    let mut given = false;
    for line in before.map(str::trim) {
        if line.starts_with('[') {
            given = false;
        }
        given |= line
            .split_once('=')
            .is_some_and(|(other, _)| other.trim() == key);
    }
    given
}

fn has_decimal_comma(value: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let value = value.trim_start_matches(['-', '+']);
    value
        .split_once(',')
        .is_some_and(|(whole, rest)| digits(whole) && digits(rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_slips_are_named_with_their_remedy() {
        for (text, row, expected, hint) in [
            (
                "a = 1\nkind = isometric\n",
                2,
                "double quotes",
                "`kind = \"isometric\"`",
            ),
            ("kind = \"isometric\nb = 2\n", 1, "closing quote", "\""),
            ("kind isometric\n", 1, "key = value", "correct"),
            ("x = 182,5\n", 1, "decimal point", "`x = 182.5`"),
            ("x = 182 mm\n", 1, "without its unit", "correct"),
            ("[a]\nx = 1\ny = 2\nx = 3\n", 4, "every key once", "x = ..."),
            ("[specimen\nx = 1\n", 1, "closing bracket", "`[specimen]`"),
            ("x =\ny = 1\n", 1, "a value", "remove `x`"),
            ("date = 2022-13-30 # day\n", 1, "a date", "2022-11-30"),
        ] {
            let defect = defect("t", text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!(defect.row, Some(row), "{text}");
            assert!(defect.expected.contains(expected), "{text}: {defect}");
            assert!(defect.hint.contains(hint), "{text}: {defect}");
        }
        assert_eq!(defect("t", "x = 1 # fine\n"), None);
    }
}
