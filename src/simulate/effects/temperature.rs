//! Temperature: rubber and load cell change with the temperature T. Needs a column `temperature_c`.
//!
//! - `linear`: F (1 + k (T - T_ref)).
//! - `quadratic`: F (1 + k (T - T_ref) (1 + q (T - T_ref))).
//! - `arrhenius`: F exp(k T_r^2 (1/T_r - 1/T)) with T and T_r = T_ref in K, whose slope at T_ref is k.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};

const SLOPE: Parameter = Parameter::size("k_per_c", "1/K", -0.05, 0.05);
const REFERENCE: Parameter = Parameter::other("reference_c", "C", (-50.0, 100.0), 20.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: "temperature",
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
                Parameter::other("bend_per_c", "1/K", (-0.2, 0.2), 0.03),
            ],
            quadratic,
        ),
        Form::new("arrhenius", Link::Actuator, &[SLOPE, REFERENCE], arrhenius),
    ],
};

/// 0 degrees Celsius, K.
const ICE_K: f64 = 273.15;

fn linear(given: &Given, _: &Moment, force: f64) -> f64 {
    force * (1.0 + given.p[0] * (given.column - given.p[1]))
}

fn quadratic(given: &Given, _: &Moment, force: f64) -> f64 {
    let [k, reference, bend] = given.p;
    let warmer = given.column - reference;
    force * (1.0 + k * warmer * (1.0 + bend * warmer))
}

fn arrhenius(given: &Given, _: &Moment, force: f64) -> f64 {
    let [k, reference, _] = given.p;
    let (hot, cold) = (given.column + ICE_K, reference + ICE_K);
    force * libm::exp(k * cold * cold * (1.0 / cold - 1.0 / hot))
}
