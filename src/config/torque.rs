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
    /// Words by which the notes of a torque session say that it is in doubt: it is shown, and takes part in no fit. `[]` for none.
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
