//! Age, outside the library: a rubber that hardens loses force with the days since it was made. Needs a column `age_days`.
//!
//! - `gain`: F (1 + k A), A in days.
//! - `saturating`: F (1 + k A_0 (1 - exp(-A/A_0))), as oxidation that runs out of sites.
//!
//! Source: K. T. Gillen and R. L. Clough, on the ageing of elastomers: property change near linear at first, then levelling off.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};

const K: Parameter = Parameter::size("k_per_day", "1/d", -0.1, 0.1);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: "age",
    column: Column::Named("age_days"),
    per: Per::Session,
    forms: &[
        Form::new("gain", Link::Actuator, &[K], gain),
        Form::new(
            "saturating",
            Link::Actuator,
            &[K, Parameter::other("scale_days", "d", (0.1, 1e5), 60.0)],
            saturating,
        ),
    ],
};

fn gain(given: &Given, _: &Moment, force: f64) -> f64 {
    force * (1.0 + given.p[0] * given.column)
}

fn saturating(given: &Given, _: &Moment, force: f64) -> f64 {
    let [k, scale, _] = given.p;
    force * (1.0 - k * scale * libm::expm1(-given.column / scale))
}
