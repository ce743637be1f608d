//! The state of an actuator, as every force model sees it, and the dimensionless numbers made of it.
//!
//! The relative numbers are those of *Isometric Force Characterization of Braided Pneumatic Actuators* (the force paper):
//! contraction (Eq. 2), contraction of the free actuator at 620 kPa (Eq. 3), relative contraction (Eq. 4), relative pressure
//! (text before Eq. 8).

pub use pipeline_base::normalized::P_620_KPA;

/// Direction of the last movement before the force was read: braided actuators show hysteresis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// The actuator was getting shorter (S = +1 in Hunt's equation).
    Shortening,
    /// The actuator was getting longer (S = -1).
    Lengthening,
    /// Length was held (S = 0).
    Isometric,
}

impl Direction {
    /// Hunt's hysteresis factor S.
    pub fn sign(self) -> f64 {
        match self {
            Self::Shortening => 1.0,
            Self::Lengthening => -1.0,
            Self::Isometric => 0.0,
        }
    }
}

/// One static state of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Nominal (uninflated, inner) diameter, mm.
    pub diameter_mm: f64,
    /// Resting length l_rest between the clamps, uninflated, m.
    pub rest_length_m: f64,
    /// Free length l_620 at 620 kPa, m; NaN where it was not measured (models that need it then say so).
    pub contracted_length_m: f64,
    /// Present length l_m, m.
    pub length_m: f64,
    /// Gauge pressure P, kPa.
    pub pressure_kpa: f64,
    /// Direction of the last movement.
    pub direction: Direction,
}

impl State {
    /// An isometric state by its dimensionless numbers: eps_620 and eps* = eps/eps_620.
    pub fn relative(
        diameter_mm: u32,
        rest_length_m: f64,
        contraction_620: f64,
        contraction_rel: f64,
        pressure_kpa: f64,
    ) -> State {
        State {
            diameter_mm: f64::from(diameter_mm),
            rest_length_m,
            contracted_length_m: rest_length_m * (1.0 - contraction_620),
            length_m: rest_length_m * (1.0 - contraction_rel * contraction_620),
            pressure_kpa,
            direction: Direction::Isometric,
        }
    }

    /// eps = (l_rest - l_m)/l_rest, a fraction: positive when shorter than at rest.
    pub fn contraction(&self) -> f64 {
        (self.rest_length_m - self.length_m) / self.rest_length_m
    }

    /// eps_620 = (l_rest - l_620)/l_rest, a fraction.
    pub fn contraction_max(&self) -> f64 {
        (self.rest_length_m - self.contracted_length_m) / self.rest_length_m
    }

    /// eps* = eps/eps_620: 0 at rest, 1 at the free length at 620 kPa.
    pub fn contraction_rel(&self) -> f64 {
        self.contraction() / self.contraction_max()
    }

    /// P* = P/620 kPa.
    pub fn pressure_rel(&self) -> f64 {
        self.pressure_kpa / P_620_KPA
    }

    /// eps_620 where it is usable, that is, measured and between 0 and 1.
    pub fn free_contraction(&self) -> Option<f64> {
        let eps_620 = self.contraction_max();
        (eps_620 > 0.0 && eps_620 < 1.0).then_some(eps_620)
    }

    /// What makes this no state of an actuator, if anything: a length that is not positive, a negative pressure, a number
    /// that is not finite. `contracted_length_m` is left to [`State::free_contraction`].
    pub fn defect(&self) -> Option<&'static str> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.diameter_mm) {
            Some("the diameter must be positive")
        } else if !positive(self.rest_length_m) {
            Some("the resting length must be positive")
        } else if !positive(self.length_m) {
            Some("the length must be positive")
        } else if !(self.pressure_kpa.is_finite() && self.pressure_kpa >= 0.0) {
            Some("the gauge pressure must be zero or more")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATE: State = State {
        diameter_mm: 10.0,
        rest_length_m: 0.2,
        contracted_length_m: 0.16,
        length_m: 0.18,
        pressure_kpa: 310.0,
        direction: Direction::Isometric,
    };

    #[test]
    fn dimensionless_numbers_follow_their_definitions() {
        assert!((STATE.contraction() - 0.1).abs() < 1e-15);
        assert!((STATE.contraction_max() - 0.2).abs() < 1e-15);
        assert!((STATE.contraction_rel() - 0.5).abs() < 1e-15);
        assert_eq!(STATE.pressure_rel(), 0.5);
        assert_eq!(STATE.defect(), None);
    }

    #[test]
    fn unusable_numbers_are_named() {
        let state = |change: fn(&mut State)| {
            let mut state = STATE;
            change(&mut state);
            state
        };
        assert!(state(|s| s.pressure_kpa = -1.0).defect().is_some());
        assert!(state(|s| s.length_m = f64::NAN).defect().is_some());
        let unknown = state(|s| s.contracted_length_m = f64::NAN);
        assert_eq!(unknown.free_contraction(), None);
    }
}
