//! After a step of pressure or length the force goes on changing: bladder and braid creep.

use super::{Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "creep";

/// F (1 + k ln(1 + t/tau)), t since the last step.
pub struct Creep;

const AMPLITUDE: Parameter = Parameter {
    name: "k",
    unit: "1",
    absent: 0.0,
    bounds: (-0.5, 0.5),
};

const TAU: Parameter = Parameter {
    name: "tau",
    unit: "s",
    absent: 0.0,
    bounds: (0.01, 1e4),
};

const FORMS: &[Form] = &[
    Form {
        name: "logarithmic",
        place: Place::Actuator,
        equation: "F -> F (1 + k ln(1 + t/tau))",
        amplitude: AMPLITUDE,
        shape: Some((TAU, &[0.1, 1.0, 10.0, 100.0])),
        needs: &[Need::SinceStep],
    },
    Form {
        name: "exponential",
        place: Place::Actuator,
        equation: "F -> F (1 + k (1 - exp(-t/tau)))",
        amplitude: AMPLITUDE,
        shape: Some((TAU, &[1.0, 10.0, 100.0])),
        needs: &[Need::SinceStep],
    },
];

impl Effect for Creep {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "creep after a step"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "hold one pressure and length for ten minutes and log the force"
    }
    fn source(&self) -> &'static str {
        "Minh et al., Mechatronics 20 (2010) 402 (creep of McKibben actuators); Findley et al., Creep and Relaxation (1976)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::SinceStep)
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [k, tau]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    let t = R::constant(at.since_step_s) / tau;
    let grown = if form == 0 {
        (t + 1.0).ln()
    } else {
        -(-t).exp() + 1.0
    };
    link.force = link.force * (k * grown + 1.0);
}
