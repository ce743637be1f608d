//! Which rows are fitted together.

use serde::{Deserialize, Serialize};

/// Rows that are fitted together.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Group {
    /// The campaign, or `pooled-10mm` and the like.
    pub campaign: String,
    /// Uninflated inner diameter, mm.
    pub diameter_mm: u32,
    /// The campaigns in it.
    pub members: Vec<String>,
    /// Whether the data are simulated.
    pub simulated: bool,
}

impl Group {
    /// Whether it is a pool: one diameter over several campaigns.
    pub fn is_pool(&self) -> bool {
        self.members.len() > 1
    }
}
