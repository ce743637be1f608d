//! What lies on the knee does not pull.

use super::{Effect, JointForm, JointNeed, Place, Subject};

/// Its id.
pub const ID: &str = "wrapping_loss";

/// A part of the actuator that is wrapped round the knee.
pub struct WrappingLoss;

const MEASUREMENT: &str = "mark the actuator and photograph which part lies on the knee";
const SOURCE: &str = "series model of the measurers, after the knee paper";

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[JointForm {
    name: "contact",
    title: None,
    place: Place::Actuator,
    equation: "l_m less chi R |theta_wrap - theta| (1 - eps*)^2, R = 30 mm",
    symbols: &["chi"],
    unit: "1",
    bounds: (0.0, 3.0),
    usual: 2.0,
    needs: Some(JointNeed::Contact),
    stands_for: &[],
    measurement: MEASUREMENT,
    source: SOURCE,
}];

impl Effect for WrappingLoss {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "loss where the actuator wraps"
    }
    fn subject(&self) -> Subject {
        Subject::Rig
    }
    fn joint_forms(&self) -> &'static [JointForm] {
        JOINT_FORMS
    }
    fn measurement(&self) -> &'static str {
        MEASUREMENT
    }
    fn source(&self) -> &'static str {
        SOURCE
    }
}
