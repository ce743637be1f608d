//! Humidity, outside the library: a strain gauge or a textile braid that takes up water. Needs a column `humidity`, in percent.
//!
//! - `gain`: F (1 + k (H - H_ref)).
//! - `offset`: F + z (H - H_ref).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};

const REFERENCE: Parameter = Parameter::other("reference_percent", "%", (0.0, 100.0), 40.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: "humidity",
    column: Column::Named("humidity"),
    per: Per::Session,
    forms: &[
        Form::new(
            "gain",
            Link::Actuator,
            &[
                Parameter::size("k_per_percent", "1/%", -0.05, 0.05),
                REFERENCE,
            ],
            gain,
        ),
        Form::new(
            "offset",
            Link::ForceSensor,
            &[
                Parameter::size("n_per_percent", "N/%", -10.0, 10.0),
                REFERENCE,
            ],
            offset,
        ),
    ],
};

fn gain(given: &Given, _: &Moment, force: f64) -> f64 {
    force * (1.0 + given.p[0] * (given.column - given.p[1]))
}

fn offset(given: &Given, _: &Moment, force: f64) -> f64 {
    force + given.p[0] * (given.column - given.p[1])
}
