//! The frame, a bracket or a tendon yields, so that the actuator is shorter than the set-up says, the more so the harder it pulls.

use super::{Argument, Conditions, Effect, Form, Link, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

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

impl Effect for SeriesCompliance {
    fn id(&self) -> &'static str {
        "series_compliance"
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
