//! An unknown cause, outside the library: the force follows any declared column x, named by the key `column`.
//!
//! - `gain`: F (1 + k (x - x_ref)).
//! - `offset`: F + z (x - x_ref).
//! - `quadratic`: F + z (x - x_ref)^2.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};

const REFERENCE: Parameter = Parameter::other("reference", "unit of the column", (-1e6, 1e6), 0.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: "unknown_column",
    column: Column::Chosen,
    per: Per::Session,
    forms: &[
        Form::new(
            "gain",
            Link::Actuator,
            &[
                Parameter::size("k_per_unit", "1/unit", -10.0, 10.0),
                REFERENCE,
            ],
            gain,
        ),
        Form::new(
            "offset",
            Link::ForceSensor,
            &[
                Parameter::size("n_per_unit", "N/unit", -1e4, 1e4),
                REFERENCE,
            ],
            offset,
        ),
        Form::new(
            "quadratic",
            Link::ForceSensor,
            &[
                Parameter::size("n_per_unit2", "N/unit^2", -1e4, 1e4),
                REFERENCE,
            ],
            quadratic,
        ),
    ],
};

fn gain(given: &Given, _: &Moment, force: f64) -> f64 {
    force * (1.0 + given.p[0] * (given.column - given.p[1]))
}

fn offset(given: &Given, _: &Moment, force: f64) -> f64 {
    force + given.p[0] * (given.column - given.p[1])
}

fn quadratic(given: &Given, _: &Moment, force: f64) -> f64 {
    let away = given.column - given.p[1];
    force + given.p[0] * away * away
}
