//! Numbers in print.

use crate::report::answers::rounded;
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
