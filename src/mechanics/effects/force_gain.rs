//! The load cell's gain is wrong.
//!
//! A gain common to all readings is taken up by b1 of the base model; it shows against a model whose coefficients are held. A gain
//! that differs between sessions shows always, and one that differs between specimens cannot be told from their strengths.

use super::{Argument, Conditions, Effect, Form, Grouping, Link, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

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

impl Effect for ForceGain {
    fn id(&self) -> &'static str {
        "force_gain"
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
