//! The residual search.

use crate::documented::Comments;
use serde::{Deserialize, Serialize};

/// Most effects in one model of the loop.
pub const MOST_EFFECTS: usize = 6;

/// Fewest draws of the residual search: with fewer no probability reaches the level of 0.02 at which something comes in, and nothing is ever found.
pub const FEWEST_DRAWS: usize = 49;

documented! {
/// Options of the residual search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DiagnoseOptions {
    /// The model whose residual is searched: "new", "new_published", or the id of another published model.
    pub base_model: String,
    /// Whether its coefficients are refitted with every effect (of a published model: a factor on its force; those of "new_published" are
    /// held in any case).
    pub refit: bool,
    /// Most effects in one answer, at most 6.
    pub most_effects: usize,
    /// Most readings of a campaign that the search uses, an equal share of each session.
    pub most_readings: usize,
    /// Draws from the fitted null model, with which the strongest candidate is compared.
    pub draws: usize,
    /// Smallest effect of interest, N (root mean square over the readings that it acts on): a smaller one is listed as negligible and
    /// changes no verdict.
    pub smallest_effect_n: f64,
    /// The same of torques, N.m.
    pub smallest_effect_nm: f64,
    /// All campaigns of one diameter are searched together as well, with a gain, a zero and a noise of each campaign, where they have at most so
    /// many specimens; 0 for never.
    pub pooled_specimens: usize,
    /// Seed of draws and of the shuffled column.
    pub seed: u64,
}
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self {
            base_model: "new".to_owned(),
            refit: true,
            most_effects: 6,
            most_readings: 4000,
            draws: 199,
            smallest_effect_n: 0.5,
            smallest_effect_nm: 0.05,
            pooled_specimens: 12,
            seed: 1,
        }
    }
}
