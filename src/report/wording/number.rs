//! Numbers and units as people read them.

use crate::described::finite;
use crate::number::Rounding;
use crate::table::Cell;
use pipeline_findings::Parameter;

/// What stands where there is no number.
pub const NONE: &str = "–";

/// A number as people read it; a dash where there is none.
pub fn rounded(value: f64, rounding: Rounding) -> String {
    let Some(rounded) = rounding.round(value) else {
        return NONE.to_owned();
    };
    rounded.typeset() + &rounded.power()
}

/// How an error is rounded, everywhere alike: a tenth of a newton, a hundredth of a newton metre, two decimals below 1 N.
pub fn error_rounding(value: f64, unit: &str) -> Rounding {
    let fine = unit == "N.m" || value.abs() < 0.995;
    Rounding::Decimals(if fine { 2 } else { 1 })
}

/// An error without its unit.
pub fn error(value: f64, unit: &str) -> String {
    rounded(value, error_rounding(value, unit))
}

/// An error without its unit; a dash where there is none.
pub fn error_or_none(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(|| NONE.to_owned(), |value| error(value, unit))
}

/// An error with its unit.
pub fn error_with_unit(value: f64, unit: &str) -> String {
    with_unit(&error(value, unit), unit)
}

/// A number that is already text, with its unit.
pub fn with_unit(number: &str, of: &str) -> String {
    match unit(of) {
        "" => number.to_owned(),
        unit => format!("{number}\u{a0}{unit}"),
    }
}

/// A unit as people read it; empty for a pure number.
pub fn unit(unit: &str) -> &str {
    match unit {
        "1" => "",
        "N.m" => "N\u{a0}m",
        "um/N" => "µm/N",
        "N s/kPa" => "N\u{a0}s/\u{2060}kPa",
        "degC" => "°C",
        "deg" => "°",
        other => other,
    }
}

/// A share as a whole percentage.
pub fn percent(share: f64) -> String {
    match Rounding::Percent(0).round(share) {
        Some(rounded) => rounded.typeset() + "%",
        None => NONE.to_owned(),
    }
}

/// A share as a whole percentage; a dash where there is none.
pub fn percent_or_none(share: Option<f64>) -> String {
    share.map_or_else(|| NONE.to_owned(), percent)
}

/// A probability without a sign of equality where it has a value: `0.012`, `< 0.0001`.
pub fn probability(p: f64) -> String {
    if p < 1e-4 {
        return "< 0.0001".to_owned();
    }
    let coarse = Rounding::Decimals(2);
    let rounding = if p < 0.095 {
        Rounding::Digits(2)
    } else {
        coarse
    };
    rounded(p, rounding)
}

/// A probability with its sign of equality: `= 0.012`, `< 0.0001`.
pub fn equals_probability(p: f64) -> String {
    if p < 1e-4 {
        probability(p)
    } else {
        format!("= {}", probability(p))
    }
}

/// A gain in log-likelihood.
pub fn gain(log_likelihood: f64) -> String {
    rounded(log_likelihood, Rounding::Decimals(1))
}

/// A gain in log-likelihood; a dash where there is none.
pub fn gain_or_none(log_likelihood: Option<f64>) -> String {
    log_likelihood.map_or_else(|| NONE.to_owned(), gain)
}

/// A size that has no interval: two digits.
pub fn plain(value: f64, unit: &str) -> String {
    with_unit(&rounded(value, Rounding::Digits(2)), unit)
}

/// An interval whose ends have one sign and are further apart than the first factor, though not than the second, is one on a scale of ratios: a time
/// between 12 and 1,000 s, which the half width would round to 0.
const RATIOS: [f64; 2] = [20.0, 1e4];

/// How a value with an interval is rounded: by the interval where it is bounded, else to three digits; to two digits where the interval is one of
/// ratios.
fn by_interval(low: Option<f64>, high: Option<f64>) -> Rounding {
    match (low, high) {
        (Some(low), Some(high)) if low > 0.0 && in_ratios(high / low) => Rounding::Digits(2),
        (Some(low), Some(high)) if low < high => Rounding::ByInterval { low, high },
        _ => Rounding::Digits(3),
    }
}

fn in_ratios(ratio: f64) -> bool {
    let [least, most] = RATIOS;
    least < ratio && ratio < most
}

/// A value as its interval allows, and the interval: `60` and `[57, 63]`. An end that the readings do not bound says so.
pub fn with_interval(value: f64, low: Option<f64>, high: Option<f64>) -> (String, String) {
    let rounding = by_interval(low, high);
    let end =
        |end: Option<f64>| end.map_or_else(|| "unbounded".to_owned(), |x| rounded(x, rounding));
    let interval = match (low, high) {
        (None, None) => String::new(),
        _ => format!("[{}, {}]", end(low), end(high)),
    };
    (rounded(value, rounding), interval)
}

/// The same as cells of a table; data files leave the place of an unbounded end empty.
pub fn cells(value: f64, low: Option<f64>, high: Option<f64>) -> [Cell; 2] {
    let rounding = by_interval(low, high);
    let end = |end: Option<f64>| end.unwrap_or(f64::NAN);
    let interval = match (low, high) {
        (None, None) => Cell::Empty,
        _ => Cell::Interval {
            low: end(low),
            high: end(high),
            rounding,
        },
    };
    [Cell::number(finite(value), rounding), interval]
}

/// A parameter without its interval: `60 kPa`.
pub fn amount(p: &Parameter) -> String {
    let (value, _) = with_interval(p.value, p.ci_low, p.ci_high);
    with_unit(&value, &p.unit)
}

/// The amplitudes of an effect without their intervals: `60 kPa`, or, of a shift along two axes, `(-15.5, -8.2) mm`. What has another unit is a
/// shape; of values of levels all, each with its level.
pub fn amounts(parameters: &[Parameter]) -> Option<String> {
    let first = parameters.first()?;
    if first.of_level.is_some() {
        let of_levels = parameters
            .iter()
            .filter_map(|p| Some(format!("{} for {}", amount(p), p.of_level.as_ref()?)));
        return Some(of_levels.collect::<Vec<String>>().join(", "));
    }
    let is_shift = parameters.iter().map(|p| p.name.as_str()).eq(["x", "y"]);
    if !is_shift {
        return Some(amount(first));
    }
    let values: Vec<String> = parameters
        .iter()
        .map(|p| with_interval(p.value, p.ci_low, p.ci_high).0)
        .collect();
    Some(with_unit(&format!("({})", values.join(", ")), &first.unit))
}

/// A parameter with its interval and unit: `P_th = 60 [57, 63] kPa`.
pub fn size(p: &Parameter) -> String {
    let (value, interval) = with_interval(p.value, p.ci_low, p.ci_high);
    let gap = if interval.is_empty() { "" } else { " " };
    let of = p.of_level.iter().map(|level| format!(" of {level}"));
    let of: String = of.collect();
    with_unit(&format!("{}{of} = {value}{gap}{interval}", p.name), &p.unit)
}

/// A small count in words, as a sentence has it.
pub fn count(n: usize) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
        "eleven", "twelve",
    ];
    WORDS
        .get(n)
        .map_or_else(|| n.to_string(), |word| (*word).to_owned())
}
