//! How a number is rounded for people: digits, decimals, or as many as its interval deserves.

/// How a value is rounded wherever people read it; data files keep full precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rounding {
    /// So many significant digits.
    Digits(usize),
    /// So many digits after the point.
    Decimals(usize),
    /// To two significant digits of the half width of the value's interval; four digits where the interval is empty or unknown.
    ByInterval {
        /// Lower end of the interval.
        low: f64,
        /// Upper end of the interval.
        high: f64,
    },
    /// A share of one, as a percentage with so many decimals.
    Percent(usize),
}

/// A rounded number, free of any output format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rounded {
    /// Below zero, and not rounded to zero.
    pub negative: bool,
    /// Digits before the point.
    pub whole: String,
    /// Digits after the point; empty where there are none.
    pub fraction: String,
    /// Power of ten, for numbers too large or too small to be written out.
    pub exponent: Option<i32>,
    /// Followed by a percent sign.
    pub percent: bool,
}

impl Rounding {
    /// Rounds `value`; `None` where it is not finite.
    pub fn round(self, value: f64) -> Option<Rounded> {
        if !value.is_finite() {
            return None;
        }
        let text = match self {
            Rounding::Digits(n) => to_digits(value, n.max(1)),
            Rounding::Decimals(n) => format!("{value:.n$}"),
            Rounding::ByInterval { low, high } => by_interval(value, low, high),
            Rounding::Percent(n) => format!("{:.n$}", 100.0 * value),
        };
        Some(Rounded::parse(&text, matches!(self, Rounding::Percent(_))))
    }
}

impl Rounded {
    /// Takes what the standard library's `{}` or `{:e}` writes.
    fn parse(text: &str, percent: bool) -> Rounded {
        let (mantissa, exponent) = match text.split_once('e') {
            Some((mantissa, exponent)) => (mantissa, exponent.parse().ok()),
            None => (text, None),
        };
        let digits = mantissa.trim_start_matches('-');
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let zero = digits.chars().all(|c| c == '0' || c == '.');
        Rounded {
            negative: mantissa.starts_with('-') && !zero,
            whole: whole.to_string(),
            fraction: fraction.to_string(),
            exponent: exponent.filter(|e| *e != 0),
            percent,
        }
    }

    /// Its power of ten as people read it, ` × 10⁻⁵`; empty where there is none.
    pub fn power(&self) -> String {
        let raised = |c: char| match c {
            '-' => '⁻',
            digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹']
                [digit.to_digit(10).unwrap_or(0) as usize],
        };
        self.exponent.map_or_else(String::new, |exponent| {
            let exponent: String = exponent.to_string().chars().map(raised).collect();
            format!("\u{2009}×\u{2009}10{exponent}")
        })
    }

    /// A whole number, written out.
    pub fn integer(value: i64) -> Rounded {
        Rounded::parse(&value.to_string(), false)
    }

    /// Neither a power of ten nor a percent sign: can be aligned at its decimal point.
    pub fn is_plain(&self) -> bool {
        self.exponent.is_none() && !self.percent
    }

    /// The form that machines read, `-12.3e-5`.
    pub fn ascii(&self) -> String {
        let sign = if self.negative { "-" } else { "" };
        let exponent = self.exponent.map(|e| format!("e{e}")).unwrap_or_default();
        format!("{sign}{}{exponent}", self.joined(&self.whole))
    }

    /// The form that people read, `−12 345.6` with a true minus sign and thin spaces from five digits on; no power, no percent sign.
    pub fn typeset(&self) -> String {
        let sign = if self.negative { "\u{2212}" } else { "" };
        format!("{sign}{}", self.joined(&grouped(&self.whole)))
    }

    fn joined(&self, whole: &str) -> String {
        if self.fraction.is_empty() {
            whole.to_string()
        } else {
            format!("{whole}.{}", self.fraction)
        }
    }
}

/// Thousands set apart by narrow spaces in numbers of five digits or more.
fn grouped(digits: &str) -> String {
    if digits.len() < 5 {
        return digits.to_string();
    }
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(c);
    }
    text
}

/// Decimal exponent of `value` once it is rounded to `digits` significant digits.
fn exponent_of(value: f64, digits: usize) -> i32 {
    let text = format!("{value:.*e}", digits - 1);
    text.split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0)
}

/// Significant digits, written out between 0.0001 and a million, else with a power of ten.
fn to_digits(value: f64, digits: usize) -> String {
    let exponent = exponent_of(value, digits);
    if value != 0.0 && !(-4..6).contains(&exponent) {
        return format!("{value:.*e}", digits - 1);
    }
    to_decimals(value, digits as i32 - 1 - exponent)
}

/// Rounded so that its interval keeps two digits: 4.1234 in 3.9 to 4.3 becomes 4.12.
fn by_interval(value: f64, low: f64, high: f64) -> String {
    let half_width = (high - low).abs() / 2.0;
    if half_width == 0.0 || !half_width.is_finite() {
        return to_digits(value, 4);
    }
    let decimals = 1 - exponent_of(half_width, 2);
    let largest = value.abs().max(low.abs()).max(high.abs());
    let exponent = exponent_of(largest, 1);
    if (-4..6).contains(&exponent) || value == 0.0 {
        return to_decimals(value, decimals);
    }
    let own = exponent_of(value, 1);
    format!("{value:.*e}", (own + decimals).clamp(0, 15) as usize)
}

/// Rounds to a number of decimals that may be negative: -1 rounds to tens.
fn to_decimals(value: f64, decimals: i32) -> String {
    if decimals >= 0 {
        return format!("{value:.*}", decimals.min(20) as usize);
    }
    let unit = (decimals..0).fold(1.0, |unit, _| unit * 10.0);
    format!("{:.0}", (value / unit).round_ties_even() * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(value: f64, rounding: Rounding) -> String {
        rounding.round(value).map_or("none".into(), |r| r.ascii())
    }

    #[test]
    fn digits_count_from_the_first_that_is_not_zero() {
        assert_eq!(shown(1234.5678, Rounding::Digits(6)), "1234.57");
        assert_eq!(shown(0.012345, Rounding::Digits(3)), "0.0123");
        assert_eq!(shown(9.996, Rounding::Digits(3)), "10.0");
        assert_eq!(shown(123456.0, Rounding::Digits(2)), "120000");
        assert_eq!(shown(1.5e-7, Rounding::Digits(2)), "1.5e-7");
        assert_eq!(shown(0.0, Rounding::Digits(3)), "0.00");
    }

    #[test]
    fn value_and_ends_share_the_decimals_of_the_half_width() {
        let (low, high) = (3.91, 4.338);
        let rounding = Rounding::ByInterval { low, high };
        assert_eq!(shown(4.1234, rounding), "4.12");
        assert_eq!(shown(low, rounding), "3.91");
        assert_eq!(shown(high, rounding), "4.34");
        let wide = Rounding::ByInterval {
            low: 9000.0,
            high: 15000.0,
        };
        assert_eq!(shown(12345.6, wide), "12300");
    }

    #[test]
    fn a_half_width_that_rounds_up_keeps_two_digits() {
        let rounding = Rounding::ByInterval {
            low: -0.0996,
            high: 0.0996,
        };
        assert_eq!(shown(1.23456, rounding), "1.23");
    }

    #[test]
    fn small_values_get_a_power_of_ten_with_the_digits_of_the_interval() {
        let rounding = Rounding::ByInterval {
            low: 5.9e-6,
            high: 8.3e-6,
        };
        assert_eq!(shown(7.123e-6, rounding), "7.1e-6");
    }

    #[test]
    fn an_empty_interval_falls_back_to_four_digits() {
        let rounding = Rounding::ByInterval {
            low: 2.0,
            high: 2.0,
        };
        assert_eq!(shown(2.0, rounding), "2.000");
        let unknown = Rounding::ByInterval {
            low: f64::NAN,
            high: 1.0,
        };
        assert_eq!(shown(std::f64::consts::PI, unknown), "3.142");
    }

    #[test]
    fn no_negative_zero_no_infinities() {
        assert_eq!(shown(-0.04, Rounding::Decimals(1)), "0.0");
        assert_eq!(shown(f64::INFINITY, Rounding::Decimals(1)), "none");
    }

    #[test]
    fn people_see_a_minus_sign_and_grouped_thousands() {
        let number = Rounding::Decimals(1).round(-12345.67).unwrap();
        assert_eq!(number.typeset(), "\u{2212}12\u{202f}345.7");
        assert_eq!(Rounded::integer(1234).typeset(), "1234");
        assert_eq!(shown(0.984, Rounding::Percent(0)), "98");
    }
}
