//! Actuators of one make differ in gain.
//!
//! Every model of the residual search lets each specimen have a gain of its own, F (1 + u), with u normal about 0: it is scatter, whose size is
//! reported, and never a finding.

use super::{Conditions, Effect, Form, Grouping, Link, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "specimen_variation";

/// F_620 (1 + u), u a random effect of the specimen.
pub struct SpecimenVariation;

const FORMS: &[Form] = &[Form {
    name: "specimen gain",
    place: Place::Actuator,
    equation: "F -> F (1 + u), u ~ N(0, sd)",
    amplitude: Parameter {
        name: "sd",
        unit: "1",
        absent: 0.0,
        bounds: (0.0, 0.5),
    },
    shape: None,
    needs: &[],
}];

impl Effect for SpecimenVariation {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "specimen gain"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn grouping(&self) -> Grouping {
        Grouping::Drawn
    }
    fn measurement(&self) -> &'static str {
        "measure three specimens of one resting length, and one specimen again after remounting"
    }
    fn source(&self) -> &'static str {
        "Pinheiro and Bates, Mixed-Effects Models in S and S-PLUS (2000), chapter 2"
    }
}

/// The operator for one specimen.
pub fn apply<R: Real>(_form: usize, [u, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    link.force = link.force * (u + 1.0);
}
