//! Hysteresis: friction in the braid makes the force smaller while filling (s = -1) and larger while venting (s = +1). Every size is
//! half the width of the loop.
//!
//! - `constant`: F + s h.
//! - `proportional`: F + s k P, friction that grows with the pressure between the fibres.
//! - `play`: the force follows a pressure w that lags behind P by r: w = max(0, P - r) while filling, and
//!   w = min(P + r, P_peak - r) while venting, so that the loop opens only after the turning point (Prandtl's play operator for
//!   one cycle from an empty actuator).
//! - `sliding`: F + s h (1 - exp(-(eps*/0.1)^2)) for a braid that slides, where after the turning point friction turns round over a pressure w:
//!   1 - 2 exp(-(P_peak - P)/w) (P. R. Dahl, AIAA J. 14 (1976) 1675).
//!
//! Source: B. Tondu and P. Lopez, IEEE Control Syst. Mag. 20 (2000) 15 (friction of the braid); T. Vo-Minh et al., IEEE/ASME Trans.
//! Mechatronics 16 (2011) 177 (play operators).

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_base::session::Phase;
use pipeline_effects as library;

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::hysteresis::ID,
    column: Column::None,
    per: Per::Session,
    forms: &[
        Form::new(
            "constant",
            Link::Actuator,
            &[Parameter::size("half_width_n", "N", -200.0, 200.0)],
            constant,
        ),
        Form::new(
            "proportional",
            Link::Actuator,
            &[Parameter::size("half_width_n_per_kpa", "N/kPa", -0.5, 0.5)],
            proportional,
        ),
        Form::new(
            "sliding",
            Link::Actuator,
            &[
                Parameter::size("half_width_n", "N", -200.0, 200.0),
                Parameter::other("turning_kpa", "kPa", (5.0, 1000.0), 200.0),
            ],
            sliding,
        ),
        Form::new(
            "play",
            Link::Pressure,
            &[Parameter::size("half_width_kpa", "kPa", 0.0, 200.0)],
            play,
        ),
    ],
};

fn constant(given: &Given, at: &Moment, force: f64) -> f64 {
    force + at.at.direction() * given.p[0]
}

fn proportional(given: &Given, at: &Moment, force: f64) -> f64 {
    force + at.at.direction() * given.p[0] * at.at.pressure_kpa
}

fn sliding(given: &Given, at: &Moment, force: f64) -> f64 {
    let contracted = at.contraction_rel / 0.1;
    let slides = 1.0 - libm::exp(-contracted * contracted);
    let turned = match at.at.phase {
        Phase::Pressurizing => 1.0,
        Phase::Depressurizing => {
            1.0 - 2.0 * libm::exp((at.at.pressure_kpa - at.at.peak_kpa) / given.p[1])
        }
    };
    force + at.at.direction() * given.p[0] * slides * turned
}

fn play(given: &Given, at: &Moment, pressure: f64) -> f64 {
    let filled = |p: f64| (p - given.p[0]).max(0.0);
    match at.at.phase {
        Phase::Pressurizing => filled(pressure),
        Phase::Depressurizing => {
            let turned = filled(at.at.peak_kpa.max(pressure));
            (pressure + given.p[0]).min(turned)
        }
    }
}
