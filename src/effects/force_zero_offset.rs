//! The load cell shows something without force.

use super::{Conditions, Effect, Form, Grouping, Link, Parameter, Place};
use crate::numerics::real::Real;

/// F_meas = F + z.
pub struct ForceZeroOffset;

const FORMS: &[Form] = &[Form {
    name: "constant",
    place: Place::Sensor,
    equation: "F_meas = F + z",
    amplitude: Parameter {
        name: "z",
        unit: "N",
        absent: 0.0,
        bounds: (-500.0, 500.0),
    },
    shape: None,
    needs: &[],
}];

impl Effect for ForceZeroOffset {
    fn id(&self) -> &'static str {
        "force_zero_offset"
    }
    fn title(&self) -> &'static str {
        "zero of the load cell"
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn grouping(&self) -> Grouping {
        Grouping::Parts
    }
    fn measurement(&self) -> &'static str {
        "log the load cell with the actuator unhooked before and after each session"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 4.28 (zero error)"
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [z, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.force = link.force + z;
}
