//! Misalignment: the actuator pulls at an angle to the sensor's axis.
//!
//! - `constant`: F cos(phi). One angle for all rows hides in F_620; give it a place or draw it.
//! - `turning`: phi (1 + q eps*): the angle opens as the actuator shortens.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const ANGLE: Parameter = Parameter::size("angle_deg", "deg", -45.0, 45.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::misalignment::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("constant", Link::ForceSensor, &[ANGLE], constant),
        Form::new(
            "turning",
            Link::ForceSensor,
            &[ANGLE, Parameter::other("turn", "1", (-1.0, 2.0), 0.3)],
            turning,
        ),
    ],
};

fn constant(given: &Given, _: &Moment, force: f64) -> f64 {
    force * libm::cos(given.p[0].to_radians())
}

fn turning(given: &Given, at: &Moment, force: f64) -> f64 {
    let angle = given.p[0] * (1.0 + given.p[1] * at.contraction_rel);
    force * libm::cos(angle.to_radians())
}
