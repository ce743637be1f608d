//! The pressure sensor shows something at no pressure.

use super::{
    Argument, Conditions, Effect, Form, Grouping, JointForm, Link, Parameter, Place, Subject,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "pressure_zero_offset";

/// P = P_meas - p.
pub struct PressureZeroOffset;

const FORMS: &[Form] = &[Form {
    name: "constant",
    place: Place::Input,
    equation: "P = P_meas - p",
    amplitude: Parameter {
        name: "p",
        unit: "kPa",
        absent: 0.0,
        // A sensor that reads a vacuum at the pressure of the room; one of absolute pressure.
        bounds: (-101.0, 150.0),
    },
    shape: None,
    needs: &[],
}];

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[JointForm {
    name: "constant",
    title: None,
    place: Place::Input,
    equation: "P = P_meas - p",
    symbols: &["p"],
    unit: "kPa",
    bounds: (-60.0, 60.0),
    usual: 20.0,
    needs: None,
    stands_for: &[],
    measurement: "log the pressure channel with the actuator vented",
    source: "data sheets of pressure transducers: offset",
}];

impl Effect for PressureZeroOffset {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "zero of the pressure sensor"
    }
    fn subject(&self) -> Subject {
        Subject::Rig
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn joint_forms(&self) -> &'static [JointForm] {
        JOINT_FORMS
    }
    fn grouping(&self) -> Grouping {
        Grouping::Parts
    }
    fn measurement(&self) -> &'static str {
        "vent the actuator to the room before each session and log the pressure sensor for ten seconds"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 4.28 (zero error)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Pressure)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [p, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.pressure = link.pressure - p;
}
