//! Which models are compared.

use crate::documented::Comments;
use serde::{Deserialize, Serialize};

documented! {
/// Options of the compare stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CompareOptions {
    /// Ids of the published models to compare; empty for all.
    pub models: Vec<String>,
}
}
