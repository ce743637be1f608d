//! An attachment of the actuator is elsewhere than drawn.

use super::{Effect, JointForm, Place, Subject};

/// Its id.
pub const ID: &str = "attachment_shift";

/// An attachment is where it is drawn plus (x, y).
pub struct AttachmentShift;

const MEASUREMENT: &str = "photograph the leg from the side with a scale and read the attachments off, or probe them with a caliper from the joint's axis";
const SOURCE: &str = "knee paper, table of attachments: read off drawings and printed parts";

/// What it is about a joint.
pub const JOINT_FORMS: &[JointForm] = &[
    JointForm {
        name: "origin",
        title: None,
        place: Place::Input,
        equation: "origin = drawn + (x, y), in the femur's frame",
        symbols: &["x", "y"],
        unit: "mm",
        bounds: (-40.0, 40.0),
        usual: 10.0,
        needs: None,
        stands_for: &[],
        measurement: MEASUREMENT,
        source: SOURCE,
    },
    JointForm {
        name: "insertion",
        title: None,
        place: Place::Input,
        equation: "insertion = drawn + (x, y), in the tibia's frame",
        symbols: &["x", "y"],
        unit: "mm",
        bounds: (-40.0, 40.0),
        usual: 10.0,
        needs: None,
        stands_for: &[],
        measurement: MEASUREMENT,
        source: SOURCE,
    },
];

impl Effect for AttachmentShift {
    fn id(&self) -> &'static str {
        ID
    }
    fn title(&self) -> &'static str {
        "shift of the attachments"
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
