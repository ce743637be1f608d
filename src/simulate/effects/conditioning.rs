//! Conditioning: a new actuator loses force over its first pressure cycles (Mullins effect of the rubber, setting of the braid).
//! N is the column `cycle` where one is declared, else the number of runs that the specimen has been through in this campaign.
//!
//! - `exponential`: F (1 - k (1 - exp(-N/N_0))).
//! - `power`: F (1 - k (1 - (1 + N/N_0)^-b)).
//! - `first_filling`: F - h (1 - exp(-(eps*/0.1)^2)) exp(-2 n) while filling, n the cycles since the length was set: the braid of a shortened
//!   actuator has yet to find its place.
//!
//! Source: J. Diani, B. Fayolle and P. Gilormini, A review on the Mullins effect, Eur. Polym. J. 45 (2009) 601.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_base::session::Phase;
use pipeline_effects as library;

const K: Parameter = Parameter::size("k", "1", -0.5, 0.5);
const SCALE: Parameter = Parameter::other("cycles", "1", (0.1, 1e4), 5.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::conditioning::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("exponential", Link::Actuator, &[K, SCALE], exponential),
        Form::new(
            "power",
            Link::Actuator,
            &[
                K,
                SCALE,
                Parameter::other("exponent", "1", (0.05, 5.0), 1.0),
            ],
            power,
        ),
        Form::new(
            "first_filling",
            Link::Actuator,
            &[Parameter::size("less_n", "N", -200.0, 200.0)],
            first_filling,
        ),
    ],
};

fn exponential(given: &Given, at: &Moment, force: f64) -> f64 {
    let [k, scale, _] = given.p;
    force * (1.0 + k * libm::expm1(-at.cycle / scale))
}

fn power(given: &Given, at: &Moment, force: f64) -> f64 {
    let [k, scale, exponent] = given.p;
    force * (1.0 - k * (1.0 - libm::pow(1.0 + at.cycle / scale, -exponent)))
}

fn first_filling(given: &Given, at: &Moment, force: f64) -> f64 {
    if at.at.phase == Phase::Depressurizing {
        return force;
    }
    let contracted = at.contraction_rel / 0.1;
    let slides = 1.0 - libm::exp(-contracted * contracted);
    force - given.p[0] * slides * libm::exp(-2.0 * at.own_cycle)
}
