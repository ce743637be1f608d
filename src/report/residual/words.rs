//! Numbers and names in print.

use crate::effects;
use crate::report::answers::{rounded, title};
use crate::report::number::Rounding;

/// A force in print, N.
pub(super) fn newtons(value: f64) -> String {
    rounded(
        value,
        Rounding::Decimals(if value.abs() < 1.0 { 2 } else { 1 }),
    )
}

pub(super) fn perhaps(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), newtons)
}

pub(super) fn percent(share: f64) -> String {
    rounded(share, Rounding::Percent(0)) + "%"
}

/// The title of an effect; anything else (a column, a reading of the data) as it stands.
pub(super) fn named(id: &str) -> String {
    effects::index(id).map_or_else(|| id.to_owned(), |_| title(id))
}

/// A text in which every effect's id has given way to its title.
pub(super) fn with_titles(text: &str) -> String {
    text.split(' ')
        .map(|word| {
            let id = word.trim_end_matches([',', ';', '.']);
            named(id) + &word[id.len()..]
        })
        .collect::<Vec<String>>()
        .join(" ")
}
