//! A fresh actuator softens over its first cycles (Mullins effect), or wears; one whose length was just set pulls less in its first filling, until
//! the braid has settled.

use super::{
    Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject, within_tension,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "conditioning";

/// F (1 - k (1 - exp(-N/N_0))), N cycles done, k not negative: neither softening nor wear makes it stronger; or F - h in the first filling of a set length.
pub struct Conditioning;

const FORMS: &[Form] = &[
    Form {
        name: "exponential",
        place: Place::Actuator,
        equation: "F -> F (1 - k (1 - exp(-N/N_0)))",
        amplitude: Parameter {
            name: "k",
            unit: "1",
            absent: 0.0,
            bounds: (0.0, 0.9),
        },
        shape: Some((
            Parameter {
                name: "N_0",
                unit: "1",
                absent: 0.0,
                bounds: (0.5, 1e5),
            },
            &[2.0, 10.0, 50.0, 250.0],
        )),
        needs: &[Need::Cycles],
    },
    Form {
        name: "first filling",
        place: Place::Braid,
        equation: "F -> F - L(c), c = h x^2/(1 + x^2) in the first filling of a set length, 0 later; x = eps/0.01; L(c) = c where the actuator pulls, else c/sqrt(1 + (c/F)^2)",
        amplitude: Parameter {
            name: "h",
            unit: "N",
            absent: 0.0,
            bounds: (-300.0, 300.0),
        },
        shape: None,
        needs: &[Need::LaterFillings],
    },
];

impl Effect for Conditioning {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "change over cycles"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "measure one new actuator at one set point before and after 10, 100 and 1000 cycles"
    }
    fn source(&self) -> &'static str {
        "Mullins, Rubber Chem. Technol. 42 (1969) 339; Klute and Hannaford, IROS 1998 (fatigue of McKibben actuators)"
    }
    fn argument(&self, form: usize) -> Option<Argument> {
        Some(if form == 0 {
            Argument::Cycles
        } else {
            Argument::Pressure
        })
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [size, n0]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    if form == 0 {
        let share = (R::constant(-at.cycles) / n0).exp() - 1.0;
        link.force = link.force * (size * share + 1.0);
    } else if at.first_filling {
        let less = size * at.sliding();
        link.force = link.force - within_tension(less, link.force, at);
    }
}
