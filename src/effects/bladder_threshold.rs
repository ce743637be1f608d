//! The bladder must be stretched to the braid before any pressure pulls.
//!
//! Above the threshold this is a zero error of the pressure sensor; only readings below it tell the two apart. A pressure below 0, as a vented channel
//! may read it, stays as it is in both forms: else they would change readings at any threshold, however small.

use super::{Argument, Conditions, Effect, Form, JointForm, Link, Parameter, Place, Subject};
use pipeline_numerics::real::Real;

/// Its id.
pub const ID: &str = "bladder_threshold";

/// P -> max(0, P - P_th), of a pressure above 0.
pub struct BladderThreshold;

const THRESHOLD: Parameter = Parameter {
    name: "P_th",
    unit: "kPa",
    absent: 0.0,
    bounds: (0.0, 200.0),
};

/// A threshold below which both forms are the same at any pressure that is set, kPa.
const SMALLEST_KPA: f64 = 1e-3;

const FORMS: &[Form] = &[
    Form {
        name: "sharp",
        place: Place::Input,
        equation: "P = max(0, P_meas - P_th)",
        amplitude: THRESHOLD,
        shape: None,
        needs: &[],
    },
    Form {
        name: "gradual",
        place: Place::Input,
        equation: "P = P_meas - P_th (1 - exp(-P_meas/P_th))",
        amplitude: THRESHOLD,
        shape: None,
        needs: &[],
    },
];

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[JointForm {
    name: "constant",
    title: None,
    place: Place::Input,
    equation: "P -> max(0, P - P_th)",
    symbols: &["P_th"],
    unit: "kPa",
    bounds: (0.0, 150.0),
    usual: 60.0,
    needs: None,
    stands_for: &[],
    measurement: "fill slowly at the resting length and read the pressure at which force sets in",
    source: "pressure that stretches the bladder before the braid carries",
}];

impl Effect for BladderThreshold {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "threshold pressure of the bladder"
    }
    fn subject(&self) -> Subject {
        Subject::Actuator
    }
    fn forms(&self) -> &'static [Form] {
        FORMS
    }
    fn joint_forms(&self) -> &'static [JointForm] {
        JOINT_FORMS
    }
    fn measurement(&self) -> &'static str {
        "raise the pressure in steps of 5 kPa from 0 to 80 kPa at resting length and see where force begins"
    }
    fn source(&self) -> &'static str {
        "Chou and Hannaford, IEEE Trans. Robot. Autom. 12 (1996) 90 (threshold pressure of the bladder)"
    }
    fn argument(&self, _form: usize) -> Option<Argument> {
        Some(Argument::Pressure)
    }
}

/// The operator.
pub fn apply<R: Real>(form: usize, [threshold, _]: [R; 2], _at: &Conditions, link: &mut Link<R>) {
    let pressure = link.pressure;
    if pressure.value() < 0.0 {
        return;
    }
    link.pressure = if form == 0 || threshold.value() < SMALLEST_KPA {
        (pressure - threshold).positive_part()
    } else {
        pressure - threshold * (R::constant(1.0) - (-(pressure / threshold)).exp())
    };
}
