//! The words of captions and legends.

use crate::number::Rounding;
use std::collections::{BTreeMap, BTreeSet};

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

/// The names of specimens, given by id and resting length in m, in the markup of figures: their lengths, with the id where several have the
/// same.
pub fn specimen_names(specimens: &[(&str, f64)]) -> Vec<String> {
    let lengths: Vec<String> = specimens.iter().map(|s| millimetres(s.1)).collect();
    let mut of_length: BTreeMap<&String, usize> = BTreeMap::new();
    for length in &lengths {
        *of_length.entry(length).or_default() += 1;
    }
    let is_single = |l: &String| of_length.get(l) == Some(&1);
    let name = |(length, (id, _)): (&String, &(&str, f64))| {
        if is_single(length) {
            length.clone()
        } else {
            format!("{length} ({})", plain(id))
        }
    };
    lengths.iter().zip(specimens).map(name).collect()
}

/// The places of the `most` largest values, rising; of equal ones the first.
pub fn largest(values: &[f64], most: usize) -> BTreeSet<usize> {
    let mut places: Vec<usize> = (0..values.len()).collect();
    places.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
    places.into_iter().take(most).collect()
}

/// A user's text in the markup of figures, taken as it stands.
pub fn plain(text: &str) -> String {
    let escaped = |c: char| match c {
        '\\' | '_' | '^' | '{' | '}' => format!("\\{c}"),
        other => other.to_string(),
    };
    text.chars().map(escaped).collect()
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
    fn specimens_of_one_length_are_told_apart() {
        let names = specimen_names(&[("a_1", 0.2), ("b", 0.2), ("c", 0.3)]);
        assert_eq!(names, ["200 mm (a\\_1)", "200 mm (b)", "300 mm"]);
    }

    #[test]
    fn a_users_text_is_no_markup() {
        assert_eq!(
            crate::markup::plain(&plain(r"a_b^{2}\v{x}")),
            r"a_b^{2}\v{x}"
        );
        assert_eq!(verbatim(r"a*_#\"), "#\"a*_#/\"");
    }
}
