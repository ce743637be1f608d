//! Force gain: a wrong calibration of the load cell. One gain for all rows hides in F_620; give it a place (`specimen`, `session`,
//! `from_session`) or draw it.
//!
//! - `constant`: g F.
//! - `curved`: F + (g - 1) F (1 + q (F/F_620 - 1/2)).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const GAIN: Parameter = Parameter::gain("gain");

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::force_gain::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("constant", Link::ForceSensor, &[GAIN], constant),
        Form::new(
            "curved",
            Link::ForceSensor,
            &[GAIN, Parameter::other("curvature", "1", (-1.0, 1.0), 0.4)],
            curved,
        ),
    ],
};

fn constant(given: &Given, _: &Moment, force: f64) -> f64 {
    given.p[0] * force
}

fn curved(given: &Given, at: &Moment, force: f64) -> f64 {
    let [gain, curvature, _] = given.p;
    let bent = 1.0 + curvature * (force / at.f620_n - 0.5);
    force + (gain - 1.0) * force * bent
}
