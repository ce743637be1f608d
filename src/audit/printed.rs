//! A number as it is printed: its value, and how far the true one may lie from it.

use serde::Deserialize;

/// A printed number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Printed {
    /// As it stands in the paper (a power of ten written as `8.6e-4`).
    pub text: String,
    /// Its value.
    pub value: f64,
    /// Half a unit of its last digit.
    pub half_unit: f64,
}

impl TryFrom<String> for Printed {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let value: f64 = text
            .parse()
            .map_err(|_| format!("\"{text}\" is no number"))?;
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((&text, "0"));
        let decimals = mantissa.split_once('.').map_or(0, |(_, f)| f.len());
        let last_digit = format!(
            "1e{}",
            exponent.parse::<i32>().unwrap_or(0) - decimals as i32
        );
        let unit: f64 = last_digit.parse().map_err(|_| last_digit)?;
        Ok(Self {
            text,
            value,
            half_unit: 0.5 * unit,
        })
    }
}

impl Printed {
    /// The smallest and largest value that are printed like this.
    pub fn ends(&self) -> (f64, f64) {
        (self.value - self.half_unit, self.value + self.half_unit)
    }

    /// Whether another printed number may stand for the same value.
    pub fn may_equal(&self, other: &Printed) -> bool {
        is_within(
            self.value - other.value,
            self.half_unit.max(other.half_unit),
            self.value,
        )
    }
}

/// Whether a difference lies within a bound, the rounding of binary numbers of the size `scale` aside.
pub fn is_within(difference: f64, bound: f64, scale: f64) -> bool {
    difference.abs() <= bound + 1e-12 * scale.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(text: &str) -> Printed {
        Printed::try_from(text.to_owned()).unwrap()
    }

    #[test]
    fn the_last_printed_digit_sets_the_half_unit() {
        for (text, value, half_unit) in [
            ("230", 230.0, 0.5),
            ("0.0245409", 0.0245409, 5e-8),
            ("8.614e-4", 8.614e-4, 5e-8),
            ("-0.1518", -0.1518, 5e-5),
        ] {
            let p = printed(text);
            assert_eq!(p.value, value);
            assert!((p.half_unit - half_unit).abs() < 1e-18, "{text}");
        }
        assert!(Printed::try_from("about 5".to_owned()).is_err());
    }

    #[test]
    fn a_shorter_print_of_the_same_value_is_the_same() {
        assert!(printed("14.7").may_equal(&printed("14.72")));
        assert!(!printed("14.7").may_equal(&printed("14.78")));
        assert!(printed("0.48").may_equal(&printed("0.485")));
    }
}
