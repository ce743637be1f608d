//! What a force model answers: a force, a force beyond the data it was fitted to, or nothing, and in the last two cases why.
//!
//! The distinction keeps comparisons fair: a model is judged where it claims to hold, and every state that it was not made for is
//! counted and named instead of being dropped.

use std::fmt;

use super::P_620_KPA;

/// Half width of a pressure class, kPa: the force paper's Fig. 4 counts a point within 10 kPa as taken at the stated pressure.
pub const PRESSURE_SLACK_KPA: f64 = 10.0;

/// The quantity in which a state lies beyond a model's limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Contraction eps, fraction of the resting length.
    Contraction,
    /// Relative contraction eps*.
    RelativeContraction,
    /// Gauge pressure, kPa.
    GaugePressure,
    /// Resting length, m.
    RestLength,
    /// Force, N.
    Force,
}

impl Quantity {
    fn name(self) -> &'static str {
        match self {
            Self::Contraction => "contraction",
            Self::RelativeContraction => "relative contraction",
            Self::GaugePressure => "gauge pressure",
            Self::RestLength => "resting length",
            Self::Force => "force",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Contraction | Self::RelativeContraction => "",
            Self::GaugePressure => " kPa",
            Self::RestLength => " m",
            Self::Force => " N",
        }
    }
}

/// Why a prediction is an extrapolation, or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// The numbers describe no state of an actuator.
    NotAState(&'static str),
    /// The model has no coefficients for this diameter.
    DiameterNotCovered {
        /// Diameter asked for, mm.
        diameter_mm: f64,
        /// Diameters that the model covers, mm.
        covered: &'static [u32],
    },
    /// The model needs eps_620, and the state has none between 0 and 1.
    FreeContractionUnknown,
    /// A quantity lies outside the range that the model was fitted or tabulated in.
    Beyond {
        /// Which quantity.
        quantity: Quantity,
        /// Its value here.
        value: f64,
        /// Lower end of the range.
        low: f64,
        /// Upper end of the range.
        high: f64,
    },
}

impl Reason {
    /// `Beyond`, where `value` lies outside `[low - slack, high + slack]`. The slack is the resolution of the reading; the
    /// range in the message is the bare one.
    pub fn outside(
        quantity: Quantity,
        value: f64,
        (low, high): (f64, f64),
        slack: f64,
    ) -> Option<Self> {
        let inside = value >= low - slack && value <= high + slack;
        (!inside).then_some(Self::Beyond {
            quantity,
            value,
            low,
            high,
        })
    }

    /// `Beyond`, where a gauge pressure in kPa lies above the 620 kPa that the rigs were supplied with.
    pub fn above_supply(pressure_kpa: f64) -> Option<Self> {
        let range = (0.0, P_620_KPA);
        Self::outside(
            Quantity::GaugePressure,
            pressure_kpa,
            range,
            PRESSURE_SLACK_KPA,
        )
    }
}

impl Reason {
    /// The reason without the value of the single state: what alike reasons share.
    pub fn kind(&self) -> String {
        match self {
            Self::Beyond {
                quantity,
                value,
                low,
                high: _,
            } if value < low => format!("{} below the model's range", quantity.name()),
            Self::Beyond { quantity, .. } => format!("{} above the model's range", quantity.name()),
            other => other.to_string(),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAState(defect) => write!(f, "not a state of an actuator: {defect}"),
            Self::DiameterNotCovered {
                diameter_mm,
                covered,
            } => write!(
                f,
                "no coefficients for {diameter_mm} mm (covered: {covered:?} mm)"
            ),
            Self::FreeContractionUnknown => {
                write!(
                    f,
                    "needs the free length at 620 kPa, below the resting length"
                )
            }
            Self::Beyond {
                quantity,
                value,
                low,
                high,
            } => {
                let (name, unit) = (quantity.name(), quantity.unit());
                write!(
                    f,
                    "{name} {value:.4}{unit} outside {low:.4} to {high:.4}{unit}"
                )
            }
        }
    }
}

/// A model's answer. Forces are tensions in N, never negative: an actuator does not push.
#[derive(Clone, Debug, PartialEq)]
pub enum Prediction {
    /// The force where the model claims to hold, N.
    Force(f64),
    /// The equations give a force, but beyond the data that they were fitted to.
    Extrapolated {
        /// The force, N.
        force_n: f64,
        /// In what the state lies beyond the data.
        why: Reason,
    },
    /// The model gives nothing.
    OutsideDomain {
        /// Why not.
        why: Reason,
    },
}

impl Prediction {
    /// A force, extrapolated when there is a reason to call it so. A value that is not finite becomes no prediction.
    pub fn new(force_n: f64, why: Option<Reason>) -> Self {
        match why {
            _ if !force_n.is_finite() => Self::outside(Reason::NotAState("no finite force")),
            Some(why) => Self::Extrapolated { force_n, why },
            None => Self::Force(force_n),
        }
    }

    /// No prediction, and why.
    pub fn outside(why: Reason) -> Self {
        Self::OutsideDomain { why }
    }

    /// The force in N, extrapolated or not; `None` where the model gives nothing.
    pub fn force_n(&self) -> Option<f64> {
        match self {
            Self::Force(force_n) | Self::Extrapolated { force_n, .. } => Some(*force_n),
            Self::OutsideDomain { .. } => None,
        }
    }

    /// Why the prediction is extrapolated or absent; `None` for a plain force.
    pub fn reason(&self) -> Option<&Reason> {
        match self {
            Self::Force(_) => None,
            Self::Extrapolated { why, .. } | Self::OutsideDomain { why } => Some(why),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_read_as_sentences() {
        let why = Reason::above_supply(700.0).unwrap();
        let text = "gauge pressure 700.0000 kPa outside 0.0000 to 620.0000 kPa";
        assert_eq!(why.to_string(), text);
        assert_eq!(Reason::above_supply(629.0), None);
        let diameter = Reason::DiameterNotCovered {
            diameter_mm: 40.0,
            covered: &[10, 20],
        };
        assert!(diameter.to_string().contains("[10, 20] mm"));
    }

    #[test]
    fn a_number_that_is_not_one_is_no_force() {
        assert_eq!(Prediction::new(f64::NAN, None).force_n(), None);
        assert_eq!(Prediction::new(3.0, None).reason(), None);
    }
}
