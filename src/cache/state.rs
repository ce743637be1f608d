//! What the last run left, unit by unit.

use crate::seen;
use crate::store::Objects;
use pipeline_base::digest::Digest;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What was left of one unit.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Left {
    /// The key of its computation.
    pub key: Digest,
    /// When the file of its entry was written, ns since 1970; 0 where that is not known.
    pub entry_ns: u64,
    /// What that gave.
    pub outputs: Objects,
}

impl Left {
    /// The same, without the times of files that were written just now: they may change again without a new time.
    pub fn settled(mut self) -> Self {
        let objects = self.outputs.values_mut().map(|o| &mut o.written_ns);
        for time_ns in objects.chain([&mut self.entry_ns]) {
            if !seen::is_settled(*time_ns) {
                *time_ns = 0;
            }
        }
        self
    }
}

/// What was left of every unit, by `stage/unit`.
pub type State = BTreeMap<String, Left>;
