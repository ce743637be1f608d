//! The force follows the rate of the pressure: flow through the inlet, viscosity of the bladder.

use super::{
    Argument, Conditions, Effect, Form, Link, Need, Parameter, Place, Subject, within_tension,
};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "rate_dependence";

/// F_meas = F - r dP/dt.
pub struct RateDependence;

const FORMS: &[Form] = &[Form {
    name: "linear",
    place: Place::Braid,
    equation: "F -> F - L(c), c = r dP/dt; L(c) = c where the actuator pulls, else c/sqrt(1 + (c/F)^2)",
    amplitude: Parameter {
        name: "r",
        unit: "N s/kPa",
        absent: 0.0,
        bounds: (-50.0, 50.0),
    },
    shape: None,
    needs: &[Need::Rate],
}];

impl Effect for RateDependence {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "dependence on the rate of the pressure"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn measurement(&self) -> &'static str {
        "fill and vent through the same pressures at three rates, the slowest ten times slower than now"
    }
    fn source(&self) -> &'static str {
        "Tondu and Lopez, IEEE Control Syst. Mag. 20 (2000) 15 (dynamic friction)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Rate)
    }
}

/// The operator.
pub fn apply<R: Real>(_form: usize, [r, _]: [R; 2], at: &Conditions, link: &mut Link<R>) {
    link.force = link.force - within_tension(r * at.rate_kpa_per_s, link.force, at);
}
