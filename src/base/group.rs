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

    /// Whether it takes in what was measured in a campaign on actuators of a diameter, mm.
    pub fn takes_in(&self, campaign: &str, diameter_mm: f64) -> bool {
        let is_member = self.members.iter().any(|member| member == campaign);
        is_member && diameter_mm.round() as u32 == self.diameter_mm
    }
}
