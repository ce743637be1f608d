//! The frame, a bracket or a tendon yields, so that the actuator is shorter than the set-up says, the more so the harder it pulls.

use super::{
    Argument, Conditions, Effect, Form, JointForm, JointNeed, Link, Parameter, Place, Subject,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "series_compliance";

/// l_m = l_nominal - C F.
pub struct SeriesCompliance;

const FORMS: &[Form] = &[Form {
    name: "linear",
    place: Place::Frame,
    equation: "l_m = l_nominal - C F",
    amplitude: Parameter {
        name: "C",
        unit: "um/N",
        absent: 0.0,
        bounds: (0.0, 200.0),
    },
    shape: None,
    needs: &[],
}];

const BRACKETS: &str = "bracket stiffness and series model of the measurers, after the knee paper";
const LOADED: &str =
    "hang a dead weight in place of the actuator and read the bracket's deflection on a dial gauge";

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[
    JointForm {
        name: "axial",
        title: None,
        place: Place::Frame,
        equation: "l_m = L_MT - 2 l_fit - l_tendon - C F",
        symbols: &["C"],
        unit: "um/N",
        bounds: (0.0, 400.0),
        usual: 100.0,
        needs: None,
        stands_for: &[],
        measurement: LOADED,
        source: BRACKETS,
    },
    JointForm {
        name: "loose",
        title: Some("loose parts in series with the actuator"),
        place: Place::Frame,
        equation: "l_m = L_MT - 2 l_fit - l_tendon - s F/(F + 100 N)",
        symbols: &["s"],
        unit: "mm",
        bounds: (0.0, 60.0),
        usual: 20.0,
        needs: None,
        stands_for: &[],
        measurement: LOADED,
        source: "series model of the measurers, stiffening: knots, bolts in their holes, a tendon that straightens",
    },
    JointForm {
        name: "origin bracket",
        title: None,
        place: Place::Frame,
        equation: "origin moves by C_o F (u - (u.a) a), a from foot to attachment",
        symbols: &["C_o"],
        unit: "um/N",
        bounds: (0.0, 1000.0),
        usual: 200.0,
        needs: Some(JointNeed::OriginBracket),
        stands_for: &[],
        measurement: LOADED,
        source: BRACKETS,
    },
    JointForm {
        name: "insertion bracket",
        title: None,
        place: Place::Frame,
        equation: "insertion moves by C_i F (u - (u.a) a), a from foot to attachment",
        symbols: &["C_i"],
        unit: "um/N",
        bounds: (0.0, 1000.0),
        usual: 200.0,
        needs: Some(JointNeed::InsertionBracket),
        stands_for: &[],
        measurement: LOADED,
        source: BRACKETS,
    },
];

impl Effect for SeriesCompliance {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "compliance in series with the actuator"
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
    fn measurement(&self) -> &'static str {
        "put a dial gauge on the crossmember, or hang a dead weight in place of the actuator"
    }
    fn source(&self) -> &'static str {
        "knee paper, section on the compliance of brackets and tendon"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Force)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [c, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.length = link.length - c * link.force * 1e-6;
}
