//! What is said of an answer wherever it stands: words and cells.

use crate::effects;
use crate::report::number::Rounding;
use crate::report::table::Cell;
use crate::stages::diagnose::findings::{ParameterFinding, Verdict};

/// Corrected p of a question below which the residual depends on the column.
pub const SIGNIFICANT: f64 = 0.05;

/// A verdict as data files name it.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::EffectFound => "effect_found",
        Verdict::None => "none",
        Verdict::Unexplained => "unexplained",
    }
}

/// A verdict for people.
pub fn verdict_words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::EffectFound => "effect found",
        Verdict::None => "nothing found",
        Verdict::Unexplained => "unexplained",
    }
}

/// A number; empty where it is not finite.
pub fn finite(value: f64, rounding: Rounding) -> Cell {
    Cell::number(value.is_finite().then_some(value), rounding)
}

/// A probability with its sign of equality: `= 0.012`, `< 0.0001`.
pub fn p_words(p: f64) -> String {
    if p < 1e-4 {
        return "< 0.0001".to_owned();
    }
    let rounding = if p >= 0.095 {
        Rounding::Decimals(2)
    } else {
        Rounding::Digits(2)
    };
    format!("= {}", rounded(p, rounding))
}

/// A number as people read it; a dash where there is none.
pub fn rounded(value: f64, rounding: Rounding) -> String {
    let Some(rounded) = rounding.round(value) else {
        return "–".to_owned();
    };
    let power = rounded.exponent.map(|e| format!("e{e}"));
    rounded.typeset() + &power.unwrap_or_default()
}

/// A unit as people read it; empty for a pure number.
pub fn unit_words(unit: &str) -> String {
    match unit {
        "1" => String::new(),
        other => other.replace("um", "µm").replace("degC", "°C"),
    }
}

/// A parameter with its interval and unit.
pub fn size(p: &ParameterFinding) -> String {
    let rounding = Rounding::ByInterval {
        low: p.ci_low,
        high: p.ci_high,
    };
    let unit = unit_words(&p.unit);
    let value = rounded(p.value, rounding);
    let interval = if p.ci_low.is_finite() && p.ci_high.is_finite() {
        format!(
            " [{}, {}]",
            rounded(p.ci_low, rounding),
            rounded(p.ci_high, rounding)
        )
    } else {
        String::new()
    };
    let gap = if unit.is_empty() { "" } else { " " };
    format!("{} = {value}{interval}{gap}{unit}", p.name)
}

/// What an effect is called, or a column of an empirical dependence as it is.
pub fn title(id: &str) -> String {
    effects::index(id).map_or_else(
        || format!("dependence on {id}, empirical"),
        |k| effects::all()[k].title().to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_and_sizes_are_short() {
        assert_eq!(p_words(3e-9), "< 0.0001");
        assert_eq!(p_words(0.0045), "= 0.0045");
        assert_eq!(p_words(1.0), "= 1.00");
        let c = ParameterFinding {
            name: "C".into(),
            value: 7.123,
            ci_low: 5.91,
            ci_high: 8.33,
            unit: "um/N".into(),
        };
        assert_eq!(size(&c), "C = 7.1 [5.9, 8.3] µm/N");
        let open = ParameterFinding {
            ci_low: f64::NAN,
            unit: "1".into(),
            ..c
        };
        assert_eq!(size(&open), "C = 7.123");
    }

    #[test]
    fn an_id_that_is_no_effect_is_a_column() {
        assert_eq!(title("creep"), "creep after a step");
        assert_eq!(title("humidity"), "dependence on humidity, empirical");
    }
}
