//! Errors: of the campaign, of every held-out unit, of the readings of the base model; and the base model's coefficients.

use super::words::{newtons, perhaps, with_titles};
use crate::effects;
use crate::report::answers::{rounded, unit_words};
use crate::report::number::Rounding;
use crate::stages::diagnose::findings::{CoefficientChange, Errors, FoldErrors, Reading};

pub(super) fn errors(e: &Errors) -> [String; 4] {
    let all = [
        e.rmse_train,
        e.rmse_heldout,
        e.rmse_heldout_own_strength,
        e.max_abs_error_heldout,
    ];
    all.map(newtons)
}

pub(super) fn unit(f: &FoldErrors) -> [String; 6] {
    [
        f.unit.clone(),
        f.readings.to_string(),
        newtons(f.before),
        newtons(f.after),
        perhaps(f.black_box),
        if f.chosen.is_empty() {
            "nothing".to_owned()
        } else {
            let chosen: Vec<String> = f.chosen.iter().map(|c| chosen_word(c)).collect();
            chosen.join(", ")
        },
    ]
}

/// An effect that a fold chose, or an empirical dependence, which is no part of the error after.
fn chosen_word(chosen: &str) -> String {
    let id = chosen.split(' ').next().unwrap_or_default();
    if effects::index(id).is_some() {
        with_titles(chosen)
    } else {
        format!("{chosen} (empirical, not in After)")
    }
}

pub(super) fn reading(r: &Reading) -> [String; 5] {
    [
        with_titles(&r.model),
        r.parameters.to_string(),
        newtons(r.errors.rmse_train),
        newtons(r.errors.rmse_heldout),
        r.numbers.join("; ").replace("um", "µm"),
    ]
}

pub(super) fn coefficient(c: &CoefficientChange) -> [String; 6] {
    let rounding = Rounding::ByInterval {
        low: c.ci_low,
        high: c.ci_high,
    };
    let unit = unit_words(&c.unit);
    let name = if unit.is_empty() {
        c.name.clone()
    } else {
        format!("{} ({unit})", c.name)
    };
    [
        name,
        c.published
            .map_or_else(|| "–".to_owned(), |p| rounded(p, Rounding::Digits(4))),
        rounded(c.before, Rounding::Digits(4)),
        rounded(c.after, rounding),
        if c.ci_low < c.ci_high {
            let ends = [c.ci_low, c.ci_high].map(|x| rounded(x, rounding));
            format!("[{}, {}]", ends[0], ends[1])
        } else {
            "–".to_owned()
        },
        match c.remark.as_str() {
            "held" => "held at the published value".to_owned(),
            other => other.to_owned(),
        },
    ]
}
