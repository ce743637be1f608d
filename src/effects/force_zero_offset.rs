//! The load cell shows something without force.

use super::{Conditions, Effect, Form, Grouping, JointForm, Link, Need, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "force_zero_offset";

/// F_meas = F + z; or the zeros that were taken off were no zeros: F_meas = F - a (z_s - median z).
pub struct ForceZeroOffset;

const FORMS: &[Form] = &[
    Form {
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
    },
    // A zero log that is recorded while the actuator already pulls (hooked in, stretched) has that pull in it. What differs from the
    // campaign's other zeros is then, to the part a, force that was taken off by mistake.
    Form {
        name: "pull in the zero logs",
        place: Place::Sensor,
        equation: "F_meas = F - a (z_s - z_med), z_s the zero taken off in the session, z_med their median",
        amplitude: Parameter {
            name: "a",
            unit: "1",
            absent: 0.0,
            bounds: (0.0, 2.0),
        },
        shape: None,
        needs: &[Need::Zeros],
    },
];

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[JointForm {
    name: "torque",
    title: None,
    place: Place::Sensor,
    equation: "M_meas = M + z",
    symbols: &["z"],
    unit: "N.m",
    bounds: (-10.0, 10.0),
    usual: 1.0,
    needs: None,
    stands_for: &[],
    measurement: "log the torque at every angle with the actuator vented",
    source: "data sheets of load cells: zero balance; weight of the leg",
}];

impl Effect for ForceZeroOffset {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "zero of the load cell"
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
        "log the load cell with the actuator unhooked, not only vented, before and after each session"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 4.28 (zero error)"
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [z, _]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    link.force = match form {
        0 => link.force + z,
        _ => link.force - z * at.zero_force_n,
    };
}
