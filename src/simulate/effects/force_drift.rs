//! Force drift: the zero of the force channel runs away.
//!
//! - `linear`: F + d t, t the time in the log.
//! - `saturating`: F + d tau (1 - exp(-t/tau)), an amplifier that warms up.
//! - `campaign`: F + d n, n the sessions measured before this one.
//!
//! The zero logs do not show it: they were taken before.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const RATE: Parameter = Parameter::size("n_per_s", "N/s", -20.0, 20.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::force_drift::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("linear", Link::ForceSensor, &[RATE], linear),
        Form::new(
            "saturating",
            Link::ForceSensor,
            &[RATE, Parameter::other("tau_s", "s", (0.1, 1e5), 30.0)],
            saturating,
        ),
        Form::new(
            "campaign",
            Link::ForceSensor,
            &[Parameter::size("n_per_session", "N a session", -50.0, 50.0)],
            campaign,
        ),
    ],
};

fn linear(given: &Given, at: &Moment, force: f64) -> f64 {
    force + given.p[0] * at.at.time_s
}

fn saturating(given: &Given, at: &Moment, force: f64) -> f64 {
    let [rate, tau, _] = given.p;
    force - rate * tau * libm::expm1(-at.at.time_s / tau)
}

fn campaign(given: &Given, at: &Moment, force: f64) -> f64 {
    force + given.p[0] * at.place
}
