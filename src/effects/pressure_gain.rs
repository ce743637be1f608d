//! The pressure sensor's gain is wrong.
//!
//! A gain common to all readings is taken up by b1 and c0 of the base model (F* is linear in P* but for the relaxation, and both scale);
//! a gain that differs between sessions is not.

use super::{Argument, Conditions, Effect, Form, Grouping, Link, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "pressure_gain";

/// P = g P_meas.
pub struct PressureGain;

const FORMS: &[Form] = &[Form {
    name: "gain",
    place: Place::Input,
    equation: "P = g P_meas",
    amplitude: Parameter {
        name: "g",
        unit: "1",
        absent: 1.0,
        bounds: (-0.6, 2.0),
    },
    shape: None,
    needs: &[],
}];

impl Effect for PressureGain {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "gain of the pressure sensor"
    }
    fn subject(&self) -> Subject {
        Subject::Rig
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn grouping(&self) -> Grouping {
        Grouping::Parts
    }
    fn measurement(&self) -> &'static str {
        "compare the pressure sensor with a reference gauge at 0, 300 and 600 kPa"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 4.12 (sensitivity of a measuring system)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Pressure)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [g, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.pressure = link.pressure * (g + 1.0);
}
