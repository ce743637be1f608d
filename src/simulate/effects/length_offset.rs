//! Length offset: end fittings, or a tape measure that begins at 1 mm: the actuator is longer than the length that is written down.
//!
//! - `constant`: l = l_nominal + d.
//! - `growing`: l = l_nominal + d (1 + q (l_rest - 0.2 m)), a part of it from a tape that is stretched.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const OFFSET: Parameter = Parameter::size("offset_mm", "mm", -50.0, 50.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::length_offset::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("constant", Link::Length, &[OFFSET], constant),
        Form::new(
            "growing",
            Link::Length,
            &[
                OFFSET,
                Parameter::other("growth_per_m", "1/m", (-3.0, 3.0), 1.0),
            ],
            growing,
        ),
    ],
};

/// Resting length at which both forms agree, m.
const REFERENCE_M: f64 = 0.2;

fn constant(given: &Given, _: &Moment, length: f64) -> f64 {
    length + 1e-3 * given.p[0]
}

fn growing(given: &Given, at: &Moment, length: f64) -> f64 {
    let [offset, growth, _] = given.p;
    length + 1e-3 * offset * (1.0 + growth * (at.rest_length_m - REFERENCE_M))
}
