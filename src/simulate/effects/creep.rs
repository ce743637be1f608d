//! Creep: force at a held length still changes after the last step in pressure, as the rubber and the braid give way.
//!
//! - `logarithm`: F (1 + k ln(1 + t/tau)), t the time since the step.
//! - `stretched`: F (1 + k (1 - exp(-(t/tau)^b))), which comes to an end.
//!
//! Readings with a step right before them (time 0, or readings without any clock) show none.
//!
//! Source: M. Van Damme et al., Int. J. Robot. Res. 28 (2009) 266 (logarithmic creep of pleated muscles); R. Kohlrausch, Ann. Phys.
//! 91 (1854) 179 (stretched exponential).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const K: Parameter = Parameter::size("k", "1", -0.5, 0.5);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::creep::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new(
            "logarithm",
            Link::Actuator,
            &[K, Parameter::other("tau_s", "s", (0.01, 1e4), 1.0)],
            logarithm,
        ),
        Form::new(
            "stretched",
            Link::Actuator,
            &[
                K,
                Parameter::other("tau_s", "s", (0.01, 1e4), 15.0),
                Parameter::other("exponent", "1", (0.05, 1.0), 0.5),
            ],
            stretched,
        ),
    ],
};

fn logarithm(given: &Given, at: &Moment, force: f64) -> f64 {
    let [k, tau, _] = given.p;
    force * (1.0 + k * libm::log1p(at.at.since_step_s / tau))
}

fn stretched(given: &Given, at: &Moment, force: f64) -> f64 {
    let [k, tau, exponent] = given.p;
    let grown = libm::expm1(-libm::pow(at.at.since_step_s / tau, exponent));
    force * (1.0 - k * grown)
}
