//! A muscle and its contraction as somebody describes them.

use pipeline_base::error::{Error, Result};
use serde::Serialize;

/// How far the free muscle shortens at 620 kPa, as it is described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FreeLength {
    /// l_620, m.
    Length(f64),
    /// eps_620, a fraction.
    Contraction(f64),
    /// Nobody measured it.
    Unknown,
}

/// A muscle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Muscle {
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// eps_620; none where nobody measured it.
    pub contraction_620: Option<f64>,
}

impl Muscle {
    /// A muscle of a nominal diameter in mm and a resting length in m.
    ///
    /// # Errors
    /// Numbers that describe no muscle.
    pub fn new(diameter_mm: f64, rest_length_m: f64, free: FreeLength) -> Result<Self> {
        let whole = diameter_mm.round();
        if !((1.0..1000.0).contains(&whole) && (diameter_mm - whole).abs() < 0.5) {
            return usage(format!(
                "a diameter of {diameter_mm} mm is not a nominal diameter: give whole mm, such as 10, 20 or 40"
            ));
        }
        positive("the resting length", rest_length_m)?;
        let contraction_620 = match free {
            FreeLength::Unknown => None,
            FreeLength::Contraction(contraction) => Some(contraction),
            FreeLength::Length(length) => {
                positive("the contracted length", length)?;
                if length >= rest_length_m {
                    return usage(format!(
                        "the contracted length, {}, is not below the resting length, {}: it is the free length at 620 kPa, at which the \
                         muscle is shorter; are the two swapped?",
                        mm(length),
                        mm(rest_length_m)
                    ));
                }
                Some((rest_length_m - length) / rest_length_m)
            }
        };
        if let Some(contraction) = contraction_620.filter(|e| !(*e > 0.0 && *e < 1.0)) {
            return usage(format!(
                "a contraction of {contraction} at 620 kPa is not possible: give a fraction between 0 and 1, such as 0.165 or 16.5%"
            ));
        }
        Ok(Self {
            diameter_mm: whole as u32,
            rest_length_m,
            contraction_620,
        })
    }
}

/// How far the muscle is contracted, as it is described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contraction {
    /// eps, a fraction of the resting length.
    Fraction(f64),
    /// Present length l, m.
    Length(f64),
    /// eps*, a fraction of eps_620.
    Relative(f64),
}

impl Contraction {
    /// eps of a muscle; `None` for a relative contraction where eps_620 is unknown.
    pub fn fraction(self, rest_length_m: f64, contraction_620: Option<f64>) -> Option<f64> {
        match self {
            Contraction::Fraction(contraction) => Some(contraction),
            Contraction::Length(length) => Some((rest_length_m - length) / rest_length_m),
            Contraction::Relative(relative) => contraction_620.map(|e| relative * e),
        }
    }

    /// eps* of a muscle; `None` where it takes an eps_620 that is unknown.
    pub fn relative(self, rest_length_m: f64, contraction_620: Option<f64>) -> Option<f64> {
        match self {
            Contraction::Relative(relative) => Some(relative),
            _ => Some(self.fraction(rest_length_m, contraction_620)? / contraction_620?),
        }
    }
}

/// Stretched by more than this fraction of its resting length, a braid does not bear (makers allow 3 to 5%), and every law grows without bound.
pub const MOST_STRETCHED: f64 = 0.05;
/// Rounding of lengths that were typed in.
const ROUNDING: f64 = 1e-9;

/// Whether a state can be one of a muscle: eps and the gauge pressure in kPa.
///
/// # Errors
/// What is wrong with it, and what to do.
pub fn check_state(contraction: f64, pressure_kpa: f64, rest_length_m: f64) -> Result<()> {
    if !(pressure_kpa.is_finite() && pressure_kpa >= 0.0) {
        return usage(format!(
            "a pressure of {pressure_kpa} kPa is not possible: give the gauge pressure, which is zero in a vented muscle and never negative"
        ));
    }
    if !(contraction.is_finite() && contraction < 1.0) {
        return usage(format!(
            "a contraction of {contraction:.4} would leave no muscle: write five percent as 5% or 0.05"
        ));
    }
    if contraction < -MOST_STRETCHED - ROUNDING {
        let length = mm(rest_length_m * (1.0 - contraction));
        return usage(format!(
            "a length of {length} stretches a muscle of {} by {:.0}% of its resting length, and a braid bears no more than {:.0}%: check both lengths and their units",
            mm(rest_length_m),
            -100.0 * contraction,
            100.0 * MOST_STRETCHED
        ));
    }
    Ok(())
}

fn positive(what: &str, length_m: f64) -> Result<()> {
    if length_m.is_finite() && length_m > 0.0 {
        return Ok(());
    }
    usage(format!(
        "{what} is {}: give a length above zero",
        mm(length_m)
    ))
}

/// A length for a message.
pub fn mm(length_m: f64) -> String {
    let rounded = (1e4 * length_m).round() / 10.0;
    format!("{rounded} mm")
}

fn usage<T>(message: String) -> Result<T> {
    Err(Error::Usage(message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_contractions_of_one_state_agree() {
        let muscle = Muscle::new(10.0, 0.2, FreeLength::Length(0.16)).unwrap();
        assert!((muscle.contraction_620.unwrap() - 0.2).abs() < 1e-12);
        let all = [
            Contraction::Fraction(0.1),
            Contraction::Length(0.18),
            Contraction::Relative(0.5),
        ];
        for c in all {
            assert!((c.fraction(0.2, Some(0.2)).unwrap() - 0.1).abs() < 1e-12);
            assert!((c.relative(0.2, Some(0.2)).unwrap() - 0.5).abs() < 1e-12);
        }
        assert_eq!(Contraction::Relative(0.5).fraction(0.2, None), None);
        assert_eq!(Contraction::Fraction(0.1).relative(0.2, None), None);
    }

    #[test]
    fn senseless_muscles_say_what_to_do() {
        let says = |diameter, rest, free, text: &str| {
            let error = Muscle::new(diameter, rest, free).unwrap_err();
            assert!(error.to_string().contains(text), "{error}");
            assert_eq!(error.exit_code(), 2);
        };
        says(0.1, 0.2, FreeLength::Unknown, "10, 20 or 40");
        says(10.0, 0.0, FreeLength::Unknown, "above zero");
        says(10.0, 0.152, FreeLength::Length(0.182), "swapped");
        says(10.0, 0.182, FreeLength::Contraction(16.5), "16.5%");
        for (contraction, pressure, text) in [
            (0.1, -1.0, "never negative"),
            (5.0, 300.0, "5% or 0.05"),
            (-9.0, 300.0, "check both lengths"),
        ] {
            let error = check_state(contraction, pressure, 0.182).unwrap_err();
            assert!(error.to_string().contains(text), "{error}");
        }
        assert!(check_state(-0.02, 0.0, 0.182).is_ok());
    }
}
