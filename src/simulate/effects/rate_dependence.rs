//! Rate dependence: the force follows the speed at which the pressure changes (viscous friction, air that has not yet come through).
//! r = dP/dt.
//!
//! - `linear`: F + c r.
//! - `square_root`: F + c sign(r) sqrt(|r| r_0), as flow through an orifice.
//! - `saturating`: F + c r/(1 + |r|/r_0), as friction that thins with speed.
//!
//! Source: J. L. Serres, D. B. Reynolds, C. A. Phillips, M. J. Gerschutz and D. W. Repperger, Comput. Methods Biomech. Biomed. Eng. 12
//! (2009) 423 (spring and damper in parallel).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const SLOPE: Parameter = Parameter::size("n_s_per_kpa", "N s/kPa", -10.0, 10.0);
const SPEED: Parameter = Parameter::other("rate_kpa_per_s", "kPa/s", (0.1, 1e4), 50.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::rate_dependence::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("linear", Link::Actuator, &[SLOPE], linear),
        Form::new("square_root", Link::Actuator, &[SLOPE, SPEED], square_root),
        Form::new("saturating", Link::Actuator, &[SLOPE, SPEED], saturating),
    ],
};

fn linear(given: &Given, at: &Moment, force: f64) -> f64 {
    force + given.p[0] * at.at.rate_kpa_per_s
}

fn square_root(given: &Given, at: &Moment, force: f64) -> f64 {
    let rate = at.at.rate_kpa_per_s;
    force + given.p[0] * (rate.abs() * given.p[1]).sqrt().copysign(rate)
}

fn saturating(given: &Given, at: &Moment, force: f64) -> f64 {
    let rate = at.at.rate_kpa_per_s;
    force + given.p[0] * rate / (1.0 + rate.abs() / given.p[1])
}
