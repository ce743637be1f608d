//! A fresh actuator softens over its first cycles (Mullins effect), or wears.

use super::{Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// F (1 - k (1 - exp(-N/N_0))), N cycles done.
pub struct Conditioning;

const FORMS: &[Form] = &[Form {
    name: "exponential",
    place: Place::Actuator,
    equation: "F -> F (1 - k (1 - exp(-N/N_0)))",
    amplitude: Parameter {
        name: "k",
        unit: "1",
        absent: 0.0,
        bounds: (-0.5, 0.9),
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
}];

impl Effect for Conditioning {
    fn id(&self) -> &'static str {
        "conditioning"
    }
    fn title(&self) -> &'static str {
        "softening over cycles"
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
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Cycles)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [k, n0]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    let share = (R::constant(-at.cycles) / n0).exp() - 1.0;
    link.force = link.force * (k * share + 1.0);
}
