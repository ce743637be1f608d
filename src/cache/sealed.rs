//! Small files that carry their own digest: the digest on the first line, JSON on the second.
//!
//! Objects are named by their digest and need none. An entry or an index with a flipped bit may still be valid JSON, and would then send a
//! run after the wrong result or tell people the wrong digest of a raw file; what does not agree with its first line is as good as absent.

use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The value as the bytes of a file.
///
/// # Errors
/// A value that is no JSON.
pub fn seal(value: &impl Serialize) -> Result<Vec<u8>> {
    let json = serde_json::to_vec(value).map_err(Error::internal)?;
    let mut bytes = format!("\"{}\"\n", Digest::of(&json)).into_bytes();
    bytes.extend(json);
    bytes.push(b'\n');
    Ok(bytes)
}

/// The value in the bytes of a file; none where they are not whole.
pub fn unseal<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let end = bytes.iter().position(|b| *b == b'\n')?;
    let (first, json) = (&bytes[..end], bytes[end + 1..].strip_suffix(b"\n")?);
    let whole = format!("\"{}\"", Digest::of(json)).as_bytes() == first;
    whole.then(|| serde_json::from_slice(json).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_and_every_lost_byte_is_seen() {
        let value = vec!["a".to_owned(), "b".to_owned()];
        let bytes = seal(&value).unwrap();
        assert_eq!(unseal(&bytes), Some(value));
        for k in 0..bytes.len() {
            assert_eq!(unseal::<Vec<String>>(&bytes[..k]), None, "cut at {k}");
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[k] ^= 1 << bit;
                assert_eq!(unseal::<Vec<String>>(&flipped), None, "byte {k}, bit {bit}");
            }
        }
    }
}
