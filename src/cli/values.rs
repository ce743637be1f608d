//! Numbers with units, as people type them.

use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_base::units::Quantity;

/// A quantity in the unit used inside; `option` names it in messages.
///
/// # Errors
/// No number, no unit, or none of this quantity.
pub fn quantity(option: &str, text: &str, quantity: Quantity) -> Result<f64> {
    let (number, symbol) = split(option, text)?;
    let units = quantity.list_of_units();
    if symbol.is_empty() {
        return usage(format!(
            "{option} {text} has no unit: write one of {units} after it, as in {option} {}{}",
            text.trim(),
            quantity.usual()
        ));
    }
    match quantity.unit(symbol) {
        Some(unit) => Ok(unit.to_inside(number)),
        None => {
            let symbols = quantity.units().map(|u| u.symbol);
            let hint = nearest(symbol, symbols)
                .map_or_else(String::new, |n| format!("; did you mean {n}?"));
            usage(format!(
                "{option} {text}: the unit {symbol} is not one of {units}{hint}"
            ))
        }
    }
}

/// A fraction, given as such or in percent.
///
/// # Errors
/// No number, or a unit.
pub fn fraction(option: &str, text: &str) -> Result<f64> {
    match split(option, text)? {
        (number, "%") => Ok(number / 100.0),
        (number, "") => Ok(number),
        (_, unit) => usage(format!(
            "{option} {text}: a fraction has no unit {unit}; write a percentage (5%) or a plain fraction (0.05)"
        )),
    }
}

/// A nominal diameter in mm, with or without unit.
///
/// # Errors
/// No number, or no unit of length.
pub fn diameter_mm(text: &str) -> Result<f64> {
    match split("--diameter", text)? {
        (number, "") => Ok(number),
        _ => Ok(1e3 * quantity("--diameter", text, Quantity::Length)?),
    }
}

/// The number and what stands behind it.
fn split<'a>(option: &str, text: &'a str) -> Result<(f64, &'a str)> {
    let text = text.trim();
    let end = text
        .rfind(|c: char| c.is_ascii_digit() || c == '.')
        .map_or(0, |k| k + 1);
    let number = text[..end].parse::<f64>().ok().filter(|x| x.is_finite());
    match number {
        Some(number) => Ok((number, text[end..].trim())),
        None => usage(format!(
            "{option} {text} is not a number; write one such as 182mm, 300kPa or 5%"
        )),
    }
}

fn usage<T>(message: String) -> Result<T> {
    Err(Error::Usage(message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: Result<f64>, expected: f64) {
        let found = found.unwrap();
        assert!(
            (found - expected).abs() <= 1e-12 * expected.abs(),
            "{found} {expected}"
        );
    }

    #[test]
    fn every_unit_is_converted() {
        let length = |text| quantity("--length", text, Quantity::Length);
        for text in ["0.182m", "18.2 cm", "182mm", " 182. mm", "1.82e2mm"] {
            near(length(text), 0.182);
        }
        near(length("10in"), 0.254);
        let pressure = |text| quantity("--pressure", text, Quantity::Pressure);
        for text in ["620kPa", "6.2bar", "0.62MPa", "620000Pa"] {
            near(pressure(text), 620.0);
        }
        near(pressure("90psi"), 620.528_156_385_185);
        near(fraction("--contraction", "5%"), 0.05);
        near(fraction("--contraction", "0.05"), 0.05);
        near(fraction("--contraction", "-1 %"), -0.01);
        near(diameter_mm("10"), 10.0);
        near(diameter_mm("1cm"), 10.0);
    }

    #[test]
    fn what_is_missing_or_wrong_is_named() {
        let says = |found: Result<f64>, text: &str| {
            let error = found.unwrap_err();
            assert!(error.to_string().contains(text), "{error}");
            assert_eq!(error.exit_code(), 2);
        };
        let pressure = |text| quantity("--pressure", text, Quantity::Pressure);
        says(pressure("300"), "kPa, Pa, MPa, bar, psi");
        says(pressure("300"), "--pressure 300kPa");
        says(pressure("300kpa"), "did you mean kPa?");
        says(pressure("300mm"), "is not one of");
        says(pressure("kPa"), "is not a number");
        says(fraction("--contraction", "5mm"), "plain fraction (0.05)");
    }
}
