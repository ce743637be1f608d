//! Pressure zero offset: the sensor shows p without pressure; the true pressure is P_shown - p.
//!
//! - `constant`: P_shown = P + p.
//! - `gained`: P_shown = P + p (1 + q (P/620 kPa - 1/2)): a zero with a small error of the gain.
//!
//! Unlike an offset of the force, it also stands in the zero log, from which nobody takes it off.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;
use pipeline_mechanics::models::P_620_KPA;

const ZERO: Parameter = Parameter::size("zero_kpa", "kPa", -50.0, 50.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::pressure_zero_offset::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("constant", Link::PressureSensor, &[ZERO], constant),
        Form::new(
            "gained",
            Link::PressureSensor,
            &[ZERO, Parameter::other("gain_share", "1", (-1.0, 1.0), 0.4)],
            gained,
        ),
    ],
};

fn constant(given: &Given, _: &Moment, pressure: f64) -> f64 {
    pressure + given.p[0]
}

fn gained(given: &Given, _: &Moment, pressure: f64) -> f64 {
    let [zero, share, _] = given.p;
    pressure + zero * (1.0 + share * (pressure / P_620_KPA - 0.5))
}
