//! Numbers as summaries, notes and tables say them.

/// A number to three significant digits with its unit; a pure number has none.
pub(crate) fn with_unit(value: f64, unit: &str) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        2 - libm::floor(libm::log10(value.abs())) as i32
    };
    let number = format!("{value:.*}", digits.clamp(0, 6) as usize);
    if unit == "1" {
        number
    } else {
        format!("{number} {unit}")
    }
}
