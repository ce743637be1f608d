//! What enters the key of a computation, and what does not.
//!
//! | enters | why |
//! |---|---|
//! | stage and its version | two stages never share a result; the version is raised by hand when meaning changes without code |
//! | fingerprint of the stage's code: its crate, the crates below it, their libraries in `Cargo.lock`, and the crate that writes results | taken from the graph of crates when the program is built, so that nobody can forget a file |
//! | the options that the stage reads | and no others: a report option must not redo a fit |
//! | inputs: name within the session or stage, and digest of the contents | an unchanged intermediate result stops the cascade |
//!
//! Not: times of change, absolute paths, the machine, the number of jobs, the order of discovery.

use pipeline_base::digest::Digest;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything that a result depends on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyParts {
    /// Name of the stage.
    pub stage: String,
    /// Version constant of the stage.
    pub version: u32,
    /// Fingerprint of the stage's code.
    pub code: String,
    /// The options that the stage reads, by dotted name.
    pub options: BTreeMap<String, String>,
    /// Digests of the inputs, by name.
    pub inputs: BTreeMap<String, Digest>,
}

impl KeyParts {
    /// The key: a digest over the parts in a fixed order.
    pub fn key(&self) -> Digest {
        let mut text = format!("{}\n{}\n{}\n", self.stage, self.version, self.code);
        for (name, value) in &self.options {
            text.push_str(&format!("option {name:?} {value:?}\n"));
        }
        for (name, digest) in &self.inputs {
            text.push_str(&format!("input {name:?} {digest}\n"));
        }
        Digest::of(text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts() -> KeyParts {
        KeyParts {
            stage: "clean".into(),
            version: 1,
            code: "sha256:0".into(),
            options: [("clean.settle_s".into(), "0.2".into())].into(),
            inputs: [("a.csv".into(), Digest::of(b"a"))].into(),
        }
    }

    #[test]
    fn every_part_changes_the_key() {
        let base = parts().key();
        let changes: [fn(&mut KeyParts); 6] = [
            |p| p.stage = "fit".into(),
            |p| p.version = 2,
            |p| p.code = "sha256:1".into(),
            |p| p.options = [("clean.settle_s".into(), "0.3".into())].into(),
            |p| p.inputs = [("a.csv".into(), Digest::of(b"b"))].into(),
            |p| p.inputs = [("b.csv".into(), Digest::of(b"a"))].into(),
        ];
        for change in changes {
            let mut other = parts();
            change(&mut other);
            assert_ne!(other.key(), base, "{other:?}");
        }
        assert_eq!(parts().key(), base);
    }
}
