//! The force differs between filling and venting: friction in the braid.
//!
//! Every amplitude is half of the loop, positive where the force is higher while venting, as friction makes it at a held length.

use super::{
    Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject, within_tension,
};
use crate::models::P_620_KPA;
use pipeline_numerics::real::Real;

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
        Place::Sensor,
        "F -> F - h s/sqrt(1 + (h/F)^2) (s = +1 filling, -1 venting)",
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
        Place::Sensor,
        "F -> F (1 - h s)",
        "h",
        "1",
        0.5,
    ),
    form(
        "proportional to pressure",
        Place::Sensor,
        "F -> F - c s/sqrt(1 + (c/F)^2), c = h P/620 kPa",
        "h",
        "N",
        300.0,
    ),
    form(
        "play in pressure",
        Place::Input,
        "P -> P - w s",
        "w",
        "kPa",
        60.0,
    ),
];

impl Effect for Hysteresis {
    fn id(&self) -> &'static str {
        "hysteresis"
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
        4 => link.pressure = link.pressure - h * s,
        _ => {}
    }
}
