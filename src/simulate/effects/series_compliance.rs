//! Series compliance: frame, bracket or tendon give way under the force, and the actuator is shorter than the distance held.
//!
//! - `linear`: l = l_nominal - C F.
//! - `stiffening`: l = l_nominal - C F/(1 + F/F_s): play and cushions at first, steel later.
//!
//! F is the axial force, which itself depends on l: both are solved together ([`super::super::chain`]).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const COMPLIANCE: Parameter = Parameter::size("c_um_per_n", "um/N", 0.0, 200.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::series_compliance::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("linear", Link::Frame, &[COMPLIANCE], linear),
        Form::new(
            "stiffening",
            Link::Frame,
            &[
                COMPLIANCE,
                Parameter::other("stiffening_n", "N", (1.0, 1e5), 400.0),
            ],
            stiffening,
        ),
    ],
};

fn linear(given: &Given, at: &Moment, length: f64) -> f64 {
    length - 1e-6 * given.p[0] * at.axial_force_n
}

fn stiffening(given: &Given, at: &Moment, length: f64) -> f64 {
    let [compliance, scale, _] = given.p;
    length - 1e-6 * compliance * at.axial_force_n / (1.0 + at.axial_force_n / scale)
}
