//! What is said of an answer wherever it stands: words and cells.

use crate::report::table::{Cell, Rounding};
use crate::stages::diagnose::findings::Verdict;

/// A verdict as data files name it.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::EffectFound => "effect_found",
        Verdict::None => "none",
        Verdict::Unexplained => "unexplained",
    }
}

/// A number; empty where it is not finite.
pub fn finite(value: f64, rounding: Rounding) -> Cell {
    Cell::number(value.is_finite().then_some(value), rounding)
}
