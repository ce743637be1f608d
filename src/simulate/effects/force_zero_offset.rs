//! Force zero offset: the force channel stands at z without any force, and no zero log shows it (the zero moved after that log).
//!
//! - `constant`: F + z.
//! - `wandering`: F + z (1 + 0.4 sin(2 pi n/N)), n the sessions measured before this one: a room that warms and cools.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const ZERO: Parameter = Parameter::size("zero_n", "N", -200.0, 200.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::force_zero_offset::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("constant", Link::ForceSensor, &[ZERO], constant),
        Form::new(
            "wandering",
            Link::ForceSensor,
            &[
                ZERO,
                Parameter::other("period_sessions", "1", (2.0, 1000.0), 12.0),
            ],
            wandering,
        ),
    ],
};

/// Part of the zero that wanders.
const WANDERING: f64 = 0.4;

fn constant(given: &Given, _: &Moment, force: f64) -> f64 {
    force + given.p[0]
}

fn wandering(given: &Given, at: &Moment, force: f64) -> f64 {
    let [zero, period, _] = given.p;
    let wave = libm::sin(std::f64::consts::TAU * at.place / period);
    force + zero * (1.0 + WANDERING * wave)
}
