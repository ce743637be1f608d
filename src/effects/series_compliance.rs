//! The frame, a bracket or a tendon yields, so that the actuator is shorter than the set-up says, the more so the harder it pulls.

use super::{Conditions, Effect, Form, Link, Parameter, Place};
use crate::numerics::real::Real;

/// l_m = l_nominal - s(F).
pub struct SeriesCompliance;

const COMPLIANCE: Parameter = Parameter {
    name: "C",
    unit: "um/N",
    absent: 0.0,
    bounds: (0.0, 200.0),
};

const FORMS: &[Form] = &[
    Form {
        name: "linear",
        place: Place::Frame,
        equation: "l_m = l_nominal - C F",
        amplitude: COMPLIANCE,
        shape: None,
        needs: &[],
    },
    Form {
        name: "stiffening",
        place: Place::Frame,
        equation: "l_m = l_nominal - C F_s ln(1 + F/F_s)",
        amplitude: COMPLIANCE,
        shape: Some((
            Parameter {
                name: "F_s",
                unit: "N",
                absent: 0.0,
                bounds: (10.0, 1e4),
            },
            &[100.0, 400.0],
        )),
        needs: &[],
    },
];

impl Effect for SeriesCompliance {
    fn id(&self) -> &'static str {
        "series_compliance"
    }
    fn title(&self) -> &'static str {
        "compliance in series with the actuator"
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
}

/// The operator. Where the force is negative (a guess on the way to the balance) the frame is linear.
pub fn apply<R: Real>(form: usize, [c, scale]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    let yields = if form == 1 && link.force.value() > 0.0 {
        (link.force / scale + 1.0).ln() * scale
    } else {
        link.force
    };
    link.length = link.length - c * yields * 1e-6;
}
