//! Sensor curvature, outside the library: a load cell that is not linear.
//!
//! - `quadratic`: F + q F^2/F_max.
//! - `cubic`: F + q F^3/F_max^2.
//!
//! F_max is the sensor's full scale.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};

const BEND: Parameter = Parameter::size("q", "1", -0.5, 0.5);
const FULL: Parameter = Parameter::other("full_scale_n", "N", (10.0, 1e5), 500.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: "sensor_curvature",
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("quadratic", Link::ForceSensor, &[BEND, FULL], quadratic),
        Form::new("cubic", Link::ForceSensor, &[BEND, FULL], cubic),
    ],
};

fn quadratic(given: &Given, _: &Moment, force: f64) -> f64 {
    force + given.p[0] * force * force / given.p[1]
}

fn cubic(given: &Given, _: &Moment, force: f64) -> f64 {
    let part = force / given.p[1];
    force + given.p[0] * force * part * part
}
