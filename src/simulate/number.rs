//! Numbers as the rig writes them: few digits, no zeros at the end.

/// Five significant digits without trailing zeros, the rig's "%.5g" (for magnitudes from 1e-4 to 99,999): `8.18`, `-8.7354`.
pub fn five_digits(x: f64) -> String {
    const LEADING: [f64; 9] = [1e4, 1e3, 1e2, 1e1, 1e0, 1e-1, 1e-2, 1e-3, 1e-4];
    let decimals = LEADING
        .iter()
        .position(|power| x.abs() >= *power)
        .unwrap_or(LEADING.len());
    fixed(x, decimals)
}

/// At most `decimals` digits after the point, without trailing zeros and without a negative zero.
pub fn fixed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let short = if decimals == 0 {
        &text
    } else {
        text.trim_end_matches('0').trim_end_matches('.')
    };
    if short == "-0" { "0" } else { short }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_look_like_those_of_the_real_logs() {
        for (x, text) in [
            (-8.7354, "-8.7354"),
            (8.1804, "8.1804"),
            (8.18, "8.18"),
            (372.4189, "372.42"),
            (620.0, "620"),
            (0.14486, "0.14486"),
            (1447.03, "1447"),
            (0.0, "0"),
        ] {
            assert_eq!(five_digits(x), text);
        }
        assert_eq!(fixed(12.340, 3), "12.34");
        assert_eq!(fixed(1400.0, 0), "1400");
        assert_eq!(fixed(-0.0001, 3), "0");
    }
}
