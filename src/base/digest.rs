//! SHA-256 digests of bytes and files.

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fmt;
use std::io::Read;
use std::path::Path;

/// Outputs of a computation: bytes by name.
pub type Outputs = BTreeMap<String, Vec<u8>>;

const PREFIX: &str = "sha256:";

/// The SHA-256 of some bytes, written `sha256:` and 64 hexadecimal digits.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Digest(String);

impl Digest {
    /// The digest of these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self::tagged(Sha256::digest(bytes).as_slice())
    }

    /// One digest over digests with names, in the order given.
    pub fn of_named<'a>(digests: impl Iterator<Item = (&'a String, &'a Digest)>) -> Self {
        let lines: Vec<String> = digests.map(|(name, d)| format!("{name:?} {d}\n")).collect();
        Self::of(lines.concat().as_bytes())
    }

    fn tagged(hash: &[u8]) -> Self {
        const DIGITS: &[u8; 16] = b"0123456789abcdef";
        let nibbles = hash.iter().flat_map(|b| [b >> 4, b & 15]);
        let mut text = String::with_capacity(PREFIX.len() + 2 * hash.len());
        text.push_str(PREFIX);
        text.extend(nibbles.map(|n| char::from(DIGITS[usize::from(n)])));
        Self(text)
    }

    /// The 64 hexadecimal digits.
    pub fn hex(&self) -> &str {
        self.0.strip_prefix(PREFIX).unwrap_or(&self.0)
    }

    /// The first twelve digits, enough for a person.
    pub fn short(&self) -> &str {
        let hex = self.hex();
        &hex[..hex.len().min(12)]
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.short())
    }
}

/// The digest of a file, read in pieces.
///
/// # Errors
/// What the system says.
pub fn of_file(path: &Path) -> std::io::Result<Digest> {
    let mut file = std::fs::File::open(path)?;
    let mut hasher = Sha256::new();
    let mut piece = vec![0_u8; 1 << 18];
    loop {
        let n = file.read(&mut piece)?;
        if n == 0 {
            return Ok(Digest::tagged(hasher.finalize().as_slice()));
        }
        hasher.update(&piece[..n]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_the_standard_one() {
        assert_eq!(
            Digest::of(b"abc").to_string(),
            "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
