//! The actuator kinks where the joint is flexed far.
//!
//! Two angles from which it does: a bend that begins early, and one at the end of the motion.

use super::{Effect, JointForm, Place, Subject};

/// Its id.
pub const ID: &str = "kinking";

/// M = r F (1 - c (|theta| - theta_0)).
pub struct Kinking;

const MEASUREMENT: &str = "photograph the actuator at large flexion and look for the kink";
const SOURCE: &str = "knee paper, last section: M = r (F - c F theta)";

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[
    JointForm {
        name: "past 30 deg",
        title: None,
        place: Place::Actuator,
        equation: "M = r F (1 - c (|theta| - 30 deg)) past 30 deg",
        symbols: &["c"],
        unit: "1/rad",
        bounds: (0.0, 2.0),
        usual: 1.0,
        needs: None,
        stands_for: &[],
        measurement: MEASUREMENT,
        source: SOURCE,
    },
    JointForm {
        name: "past 75 deg",
        title: None,
        place: Place::Actuator,
        equation: "M = r F (1 - c (|theta| - 75 deg)) past 75 deg",
        symbols: &["c"],
        unit: "1/rad",
        bounds: (0.0, 2.0),
        usual: 1.0,
        needs: None,
        stands_for: &[],
        measurement: MEASUREMENT,
        source: SOURCE,
    },
];

impl Effect for Kinking {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "kinking of the actuator"
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
