//! The actuator is longer or shorter than the tape measure says: end fittings, a bolt that slipped, a wrong resting length.
//!
//! With d_r in place of d the error is in l_rest: the contraction (l_rest + d_r - l)/(l_rest + d_r) then changes nearly as by a length
//! that is too short by d_r, so the two belong to one effect.

use super::{
    Argument, Conditions, Effect, Form, Grouping, JointForm, Link, Parameter, Place, Subject,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "length_offset";

/// l_m = l_nominal + d.
pub struct LengthOffset;

const FORMS: &[Form] = &[Form {
    name: "constant",
    place: Place::Input,
    equation: "l_m = l_nominal + d",
    amplitude: Parameter {
        name: "d",
        unit: "mm",
        absent: 0.0,
        bounds: (-60.0, 60.0),
    },
    shape: None,
    needs: &[],
}];

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[JointForm {
    name: "constant",
    title: None,
    place: Place::Input,
    equation: "l_m = L_MT - 2 l_fit - l_tendon - d",
    symbols: &["d"],
    unit: "mm",
    bounds: (-60.0, 60.0),
    usual: 20.0,
    needs: None,
    stands_for: &[],
    measurement: "measure clamp to clamp with a caliper at every angle, loaded and unloaded",
    source: "knee paper, fitted length of the end fittings",
}];

impl Effect for LengthOffset {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "offset of the length"
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
        "measure clamp to clamp with a caliper at every set length, loaded and unloaded"
    }
    fn source(&self) -> &'static str {
        "knee paper, section on the actuator's length (end fittings)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Contraction)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [d, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.length = link.length + d * 1e-3;
}
