//! The joint rubs, against the way it turned last.

use super::{Effect, JointForm, JointNeed, Place, StandsFor, Subject, hysteresis};

/// Its id.
pub const ID: &str = "joint_friction";

/// M_meas = M - f s, s the sense of the last motion.
pub struct JointFriction;

const MEASUREMENT: &str =
    "come to every angle from both sides, and turn the joint with the actuator vented";
const SOURCE: &str = "Coulomb friction; sense of motion from the order of the readings";

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[
    JointForm {
        name: "dry",
        title: None,
        place: Place::Sensor,
        equation: "M_meas = M - f s, s = 1 after extension, -1 after flexion",
        symbols: &["f"],
        unit: "N.m",
        // An actuator's own hysteresis is friction of the other sign where it drives the joint.
        bounds: (-10.0, 10.0),
        usual: 3.0,
        needs: Some(JointNeed::BothSenses),
        stands_for: &[StandsFor {
            id: hysteresis::ID,
            where_negative: true,
        }],
        measurement: MEASUREMENT,
        source: SOURCE,
    },
    JointForm {
        name: "loaded",
        title: None,
        place: Place::Sensor,
        equation: "M_meas = M - mu |M| s, s = 1 after extension, -1 after flexion",
        symbols: &["mu"],
        unit: "1",
        bounds: (-0.5, 0.5),
        usual: 0.1,
        needs: Some(JointNeed::BothSenses),
        stands_for: &[StandsFor {
            id: hysteresis::ID,
            where_negative: true,
        }],
        measurement: MEASUREMENT,
        source: "Coulomb friction: what the joint carries grows with the torque; sense of motion from the order of the readings",
    },
];

impl Effect for JointFriction {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "friction of the joint"
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
