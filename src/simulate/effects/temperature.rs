//! Temperature: rubber and load cell change with the temperature T. Needs a column `temperature_c`.
//!
//! - `linear`: F (1 + k (T - T_ref)).
//! - `quadratic`: F (1 + k (T - T_ref) (1 + q (T - T_ref))).
//!
//! An Arrhenius law is left out: between 10 and 30 degrees it lies within a hundredth of the straight line.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const SLOPE: Parameter = Parameter::size("k_per_c", "1/K", -0.05, 0.05);
const REFERENCE: Parameter = Parameter::other("reference_c", "C", (-50.0, 100.0), 20.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::temperature::ID,
    column: Column::Named("temperature_c"),
    per: Per::Session,
    forms: &[
        Form::new("linear", Link::Actuator, &[SLOPE, REFERENCE], linear),
        Form::new(
            "quadratic",
            Link::Actuator,
            &[
                SLOPE,
                REFERENCE,
                Parameter::other("bend_per_c", "1/K", (-0.2, 0.2), 0.05),
            ],
            quadratic,
        ),
    ],
};

fn linear(given: &Given, _: &Moment, force: f64) -> f64 {
    force * (1.0 + given.p[0] * (given.column - given.p[1]))
}

fn quadratic(given: &Given, _: &Moment, force: f64) -> f64 {
    let [k, reference, bend] = given.p;
    let warmer = given.column - reference;
    force * (1.0 + k * warmer * (1.0 + bend * warmer))
}
