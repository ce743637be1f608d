//! The words of captions and legends.

use crate::report::number::Rounding;

/// A coefficient's symbol in Typst markup, `b#sub[2]`.
pub fn symbol(name: &str) -> String {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    match &name[letters.len()..] {
        "" => name.to_owned(),
        digits => format!("_{letters}_#sub[{digits}]"),
    }
}

/// A number with so many decimals, as captions print it.
pub fn number(value: f64, decimals: usize) -> String {
    Rounding::Decimals(decimals)
        .round(value)
        .map_or_else(|| "--".to_owned(), |n| n.typeset())
}

/// Words as a sentence lists them: `a, b and c`.
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

/// A user's text inside Typst markup, as a string that is not markup.
pub fn verbatim(text: &str) -> String {
    format!("#{:?}", text.replace('\\', "/").replace('"', "'"))
}

/// A resting length in whole millimetres.
pub fn millimetres(rest_length_m: f64) -> String {
    format!("{:.0} mm", 1e3 * rest_length_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_joined_and_symbols_get_their_subscript() {
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
        assert_eq!(listed::<&str>(&[]), "");
        assert_eq!(symbol("b2"), "_b_#sub[2]");
        assert_eq!(symbol("slope"), "slope");
    }

    #[test]
    fn a_users_text_is_no_markup() {
        assert_eq!(verbatim(r"a*_#\"), "#\"a*_#/\"");
    }
}
