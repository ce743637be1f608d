//! The force depends on the resting length and the base model does not know it.
//!
//! Both forms have the slope k at the middle resting length: a straight line, and the first terms of an arc tangent for long
//! actuators, atan(b x) = pi/2 - 1/(b x) (force paper, Eqs. 5 and 6).

use super::{Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "rest_length_scaling";

/// F_620 grows with l_rest.
pub struct RestLengthScaling;

const AMPLITUDE: Parameter = Parameter {
    name: "k",
    unit: "1/m",
    absent: 0.0,
    bounds: (-20.0, 20.0),
};

const FORMS: &[Form] = &[
    Form {
        name: "linear",
        place: Place::Actuator,
        equation: "F -> F (1 + k (l_rest - l_mid))",
        amplitude: AMPLITUDE,
        shape: None,
        needs: &[Need::LengthLaw, Need::RestLengths],
    },
    Form {
        name: "saturating",
        place: Place::Actuator,
        equation: "F -> F (1 + k l_mid (1 - l_mid/l_rest))",
        amplitude: AMPLITUDE,
        shape: None,
        needs: &[Need::LengthLaw, Need::RestLengths],
    },
];

impl Effect for RestLengthScaling {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "dependence of the force on the resting length"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "measure two more resting lengths, the shortest and the longest that the rig takes"
    }
    fn source(&self) -> &'static str {
        "force paper, Eqs. 5 and 6"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::RestLength)
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [k, _]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    let (length, middle) = (at.rest_length_m, at.middle_rest_length_m);
    let lever = if form == 0 {
        length - middle
    } else {
        middle * (1.0 - middle / length)
    };
    link.force = link.force * (k * lever + 1.0);
}
