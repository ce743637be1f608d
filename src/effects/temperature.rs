//! The force, or the load cell, depends on temperature.

use super::{Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "temperature";

/// F_meas = F (1 + k (T - T_ref)), with T_ref the campaign's mean.
pub struct Temperature;

const SLOPE: Parameter = Parameter {
    name: "k",
    unit: "1/K",
    absent: 0.0,
    bounds: (-0.1, 0.1),
};

const BEND: Parameter = Parameter {
    name: "q",
    unit: "1/K",
    absent: 0.0,
    bounds: (-1.0, 1.0),
};

const FORMS: &[Form] = &[
    Form {
        name: "linear",
        place: Place::Sensor,
        equation: "F_meas = F (1 + k (T - T_mean))",
        amplitude: SLOPE,
        shape: None,
        needs: &[Need::Temperature],
    },
    Form {
        name: "curved",
        place: Place::Sensor,
        equation: "F_meas = F (1 + k (dT + q dT^2)), dT = T - T_mean",
        amplitude: SLOPE,
        shape: Some((BEND, &[-0.05, 0.05])),
        needs: &[Need::Temperature],
    },
];

impl Effect for Temperature {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "temperature"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "repeat one session at two temperatures at least 10 K apart, with a dead weight on the load cell at both"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 2.52 (influence quantity)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Temperature)
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [k, q]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    let dt = at.temperature_c;
    let lever = if form == 0 {
        R::constant(dt)
    } else {
        q * (dt * dt) + dt
    };
    link.force = link.force * (k * lever + 1.0);
}
