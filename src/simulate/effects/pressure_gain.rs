//! Pressure gain: a wrong calibration of the pressure sensor; the true pressure is g times what it shows.
//!
//! - `constant`: P_shown = P/g.
//! - `curved`: P_shown = P/(1 + (g - 1)(1 + q (P/620 kPa - 1/2))).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;
use pipeline_mechanics::models::P_620_KPA;

const GAIN: Parameter = Parameter::gain("gain");

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::pressure_gain::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("constant", Link::PressureSensor, &[GAIN], constant),
        Form::new(
            "curved",
            Link::PressureSensor,
            &[GAIN, Parameter::other("curvature", "1", (-1.0, 1.0), 0.4)],
            curved,
        ),
    ],
};

fn constant(given: &Given, _: &Moment, pressure: f64) -> f64 {
    pressure / given.p[0]
}

fn curved(given: &Given, _: &Moment, pressure: f64) -> f64 {
    let [gain, curvature, _] = given.p;
    let bent = 1.0 + curvature * (pressure / P_620_KPA - 0.5);
    pressure / (1.0 + (gain - 1.0) * bent)
}
