//! The load cell stands at an angle to the actuator.
//!
//! At first order in phi the sensitivity is 0, so the search looks for it near 10 degrees. It is a gain below one: an angle common to all
//! readings hides in b1, one of a session or specimen is told from a gain by its sign alone.

use super::{
    Argument, Conditions, Effect, Form, Grouping, Link, Parameter, Place, Subject, force_gain,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "misalignment";

/// F_meas = F cos(phi).
pub struct Misalignment;

const FORMS: &[Form] = &[Form {
    name: "constant angle",
    place: Place::Sensor,
    equation: "F_meas = F cos(phi)",
    amplitude: Parameter {
        name: "phi",
        unit: "deg",
        absent: 0.0,
        bounds: (0.0, 60.0),
    },
    shape: None,
    needs: &[],
}];

impl Effect for Misalignment {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "angle between load cell and actuator"
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
        "measure the angle between load cell and actuator, or the force across the axis"
    }
    fn source(&self) -> &'static str {
        "knee paper, section on the load cell's direction"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Force)
    }
    fn joint_absorbed_by(&self) -> Option<&'static str> {
        // A force that is not along the sensor shrinks as one of a weaker actuator.
        Some(force_gain::ID)
    }
    fn near(&self) -> f64 {
        10.0
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [phi, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.force = link.force * (phi * (std::f64::consts::PI / 180.0)).cos();
}
