//! Bladder threshold: the bladder must first swell to the braid, and pressure below P_th makes no force.
//!
//! - `sharp`: P -> max(0, P - P_th).
//! - `smooth`: P -> w ln(1 + exp((P - P_th)/w)), less its value at P = 0: the bladder touches the braid here sooner, there later.
//!
//! Source: G. K. Klute and B. Hannaford, J. Dyn. Sys. Meas. Control 122 (2000) 386: the bladder takes part of the pressure.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const THRESHOLD: Parameter = Parameter::size("threshold_kpa", "kPa", 0.0, 200.0);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::bladder_threshold::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new("sharp", Link::Pressure, &[THRESHOLD], sharp),
        Form::new(
            "smooth",
            Link::Pressure,
            &[
                THRESHOLD,
                Parameter::other("width_kpa", "kPa", (0.1, 100.0), 12.0),
            ],
            smooth,
        ),
    ],
};

fn sharp(given: &Given, _: &Moment, pressure: f64) -> f64 {
    (pressure - given.p[0]).max(0.0)
}

fn smooth(given: &Given, _: &Moment, pressure: f64) -> f64 {
    let [threshold, width, _] = given.p;
    // ln(1 + e^x) without overflow.
    let soft = |x: f64| x.max(0.0) + libm::log1p(libm::exp(-x.abs()));
    let above = soft((pressure - threshold) / width) - soft(-threshold / width);
    (width * above).max(0.0)
}
