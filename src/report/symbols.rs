//! The symbols of equations and coefficients as people read them, in the report's markup.

use pipeline_fit::equations::{
    CONTRACTION, FORCE_AT_REST, FORCE_AT_REST_CAPS, JOINT, MAXIMUM_FORCE, SURFACE,
};

/// An equation by its id; an unknown id stands for itself.
pub fn equation(id: &str) -> String {
    match id {
        MAXIMUM_FORCE => "F_{620}(l_{rest})",
        FORCE_AT_REST => "F_{max}(l_{rest}, \\v{P})",
        FORCE_AT_REST_CAPS => "F_{max}(l_{rest}, \\v{P}), l_0 of F_{620}",
        SURFACE => "\\v{F}*(ε*, \\v{P}*)",
        JOINT => "\\v{F}(ε*, \\v{P}*, l_{rest})",
        CONTRACTION => "ε_{620}(l_{rest})",
        other => other,
    }
    .to_owned()
}

/// A coefficient by its name: the digit of `b1` becomes a subscript.
pub fn coefficient(name: &str) -> String {
    match name.as_bytes() {
        [letter, digit] if letter.is_ascii_lowercase() && digit.is_ascii_digit() => {
            format!("{}_{}", *letter as char, *digit as char)
        }
        _ => name.replace('_', "\\_"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_of_coefficients_become_subscripts() {
        assert_eq!(coefficient("b1"), "b_1");
        assert_eq!(coefficient("slope"), "slope");
        assert_eq!(equation(JOINT), "\\v{F}(ε*, \\v{P}*, l_{rest})");
    }
}
