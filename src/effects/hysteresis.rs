//! The force differs between filling and venting: friction in the braid.
//!
//! Friction is between parts that move against each other: at resting length the braid does not slide over the bladder, and the laboratory's rig
//! shows loops of 8 N at every contraction of 4% and more, of less than 1 N at none. They are closed at the pressure at which filling turns into
//! venting and widen away from it (*sliding, closed at the top*).
//!
//! A frame that yields carries what is left of the force. What also shows where the actuator is slack is not of its braid.
//!
//! Every amplitude is half of the loop, of one that closes half of it at half of the highest pressure, positive where the force is higher while
//! venting, as friction makes it at a held length.

use super::{
    Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject, within_tension,
};
use pipeline_mechanics::models::P_620_KPA;
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "hysteresis";

/// Half of the loop, with the sign of the direction.
pub struct Hysteresis;

const fn form(
    name: &'static str,
    place: Place,
    equation: &'static str,
    symbol: &'static str,
    unit: &'static str,
    most: f64,
) -> Form {
    Form {
        name,
        place,
        equation,
        amplitude: Parameter {
            name: symbol,
            unit,
            absent: 0.0,
            bounds: (-most, most),
        },
        shape: None,
        needs: &[Need::Direction],
    }
}

const FORMS: &[Form] = &[
    form(
        "constant",
        Place::Braid,
        "F -> F - L(c), c = h s (s = +1 filling, -1 venting); L(c) = c where the actuator pulls, else c/sqrt(1 + (c/F)^2)",
        "h",
        "N",
        300.0,
    ),
    form(
        "constant, slack too",
        Place::Sensor,
        "F -> F - h s (s = +1 filling, -1 venting)",
        "h",
        "N",
        300.0,
    ),
    form(
        "proportional to force",
        Place::Braid,
        "F -> F (1 - h s) (s = +1 filling, -1 venting)",
        "h",
        "1",
        0.5,
    ),
    form(
        "proportional to pressure",
        Place::Braid,
        "F -> F - L(c), c = h s P/620 kPa (s = +1 filling, -1 venting); L(c) = c where the actuator pulls, else c/sqrt(1 + (c/F)^2)",
        "h",
        "N",
        300.0,
    ),
    form(
        "play in pressure",
        Place::Input,
        "P -> P - w s, s of the last change of the pressure",
        "w",
        "kPa",
        60.0,
    ),
    form(
        "sliding, closed at the top",
        Place::Braid,
        "F -> F - L(c), c = 2 h s (1 - P/P_top) x^2/(1 + x^2), x = eps/0.01, s = +1 filling, -1 venting, P_top the highest of the log; L(c) = c where the actuator pulls, else c/sqrt(1 + (c/F)^2)",
        "h",
        "N",
        300.0,
    ),
];

impl Effect for Hysteresis {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "hysteresis between filling and venting"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "approach one pressure from below and from above at one length, ten times each"
    }
    fn source(&self) -> &'static str {
        "Chou and Hannaford 1996 (Coulomb friction of the braid); Vo-Minh et al., IEEE/ASME Trans. Mechatron. 16 (2011) 177"
    }
    fn if_negative(&self) -> Option<&'static str> {
        Some("a lag, not of friction")
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Pressure)
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [h, _]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    let s = at.direction;
    match form {
        0 => link.force = link.force - within_tension(h * s, link.force, at),
        1 => link.force = link.force - h * s,
        2 => link.force = link.force * (h * -s + 1.0),
        3 => {
            let friction = h * (s * at.pressure_kpa / P_620_KPA);
            link.force = link.force - within_tension(friction, link.force, at);
        }
        4 => link.pressure = link.pressure - h * at.moved,
        5 => {
            // A log that was never filled is at the end of no loop.
            let highest_kpa = at.highest_kpa.max(f64::MIN_POSITIVE);
            let friction = h * (2.0 * s * at.sliding() * (1.0 - at.pressure_kpa / highest_kpa));
            link.force = link.force - within_tension(friction, link.force, at);
        }
        _ => {}
    }
}
