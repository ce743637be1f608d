//! What needs no session: the shipped knees looked at by themselves.
//!
//! | file | idea |
//! |---|---|
//! | [`arms`] | both methods for the moment arm along every shipped route: where they part, and why; the switches |
//! | [`centres`] | the instantaneous centre of the biomimetic knee three ways |
//! | [`human`] | the human muscles beside OpenSim's exports |
//! | [`design`] | the full-size actuators beside the human muscles (the knee paper's Fig. 15) |
//! | [`walls`] | axial stress in the wall (Eqs. 13 and 14) |

pub mod arms;
pub mod centres;
pub mod design;
pub mod human;
pub mod walls;

use serde::{Deserialize, Serialize};

/// Everything that needs no session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Moment arms along the shipped routes.
    pub arms: Vec<arms::Arms>,
    /// The instantaneous centre.
    pub centres: Vec<centres::Centres>,
    /// The human muscles.
    pub human: Vec<human::Compared>,
    /// Actuators beside the human muscles.
    pub design: Vec<design::Design>,
    /// Stress in the wall.
    pub walls: Vec<walls::Wall>,
}

/// Looks at the shipped knees.
pub fn reference() -> Reference {
    Reference {
        arms: arms::arms(),
        centres: centres::centres(),
        human: human::compared(),
        design: design::designs(),
        walls: walls::walls(),
    }
}

/// The largest size and the angle in degrees at which it stands; zeros of nothing.
fn largest(values: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    values.fold((0.0, 0.0), |worst: (f64, f64), (angle, value)| {
        if value.abs() > worst.0 {
            (value.abs(), angle.to_degrees())
        } else {
            worst
        }
    })
}

/// Root mean square.
fn rms(values: &[f64]) -> f64 {
    (pipeline_numerics::statistics::sum_of_squares(values) / values.len() as f64).sqrt()
}
