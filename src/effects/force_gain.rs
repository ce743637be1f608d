//! The load cell's gain is wrong.
//!
//! A gain common to all readings is taken up by b1 of the base model; it shows against a model whose coefficients are held. A gain
//! that differs between sessions shows always, and one that differs between specimens cannot be told from specimen gains.

use super::{
    Argument, Conditions, Effect, Form, Grouping, JointForm, Link, Parameter, Place, StandsFor,
    Subject, misalignment, specimen_variation,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "force_gain";

/// F_meas = g F.
pub struct ForceGain;

const FORMS: &[Form] = &[Form {
    name: "gain",
    place: Place::Sensor,
    equation: "F_meas = g F",
    amplitude: Parameter {
        name: "g",
        unit: "1",
        absent: 1.0,
        bounds: (-0.9, 4.0),
    },
    shape: None,
    needs: &[],
}];

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[JointForm {
    name: "gain",
    title: None,
    place: Place::Actuator,
    equation: "F = g A(l_m, P), reported is g - 1",
    symbols: &["g - 1"],
    unit: "1",
    bounds: (-0.4, 0.4),
    usual: 0.1,
    needs: None,
    stands_for: &[
        StandsFor {
            id: misalignment::ID,
            where_negative: false,
        },
        StandsFor {
            id: specimen_variation::ID,
            where_negative: false,
        },
    ],
    measurement: "measure the force of the same actuators on the isometric rig",
    source: "force paper, scatter of the actuators' maximum force",
}];

impl Effect for ForceGain {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "gain of the load cell"
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
        "hang three known weights on the load cell before and after the campaign"
    }
    fn source(&self) -> &'static str {
        "JCGM 200:2012, 4.12 (sensitivity of a measuring system)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Force)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [g, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.force = link.force * (g + 1.0);
}
