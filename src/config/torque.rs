//! Torque about a knee.

use crate::documented::Comments;
use serde::{Deserialize, Serialize};

documented! {
/// Options of the torque stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueOptions {
    /// Length of one end fitting where a session states none, mm.
    pub fitting_mm: f64,
    /// Words in the notes that mark a torque session as doubtful: it is shown, but used in no fit. `[]` for none.
    pub doubtful_words: Vec<String>,
}
}

impl Default for TorqueOptions {
    fn default() -> Self {
        let words = [
            "superseded",
            "excluded",
            "reject",
            "rejected",
            "doubtful",
            "uncertain",
            "unsure",
            "slipped",
            "unreliable",
        ];
        Self {
            fitting_mm: 25.4,
            doubtful_words: words.map(str::to_owned).to_vec(),
        }
    }
}
