//! The cache: what was computed from what, kept by content.
//!
//! ```text
//! derived/cache/objects/ab/cdef…       every stage output, named by the SHA-256 of its bytes
//! derived/cache/entries/ab/cdef….json  one computation: the parts of its key, and the digests of its outputs
//! derived/cache/state.json             the key that each stage and unit had last time, to say why it differs now
//! derived/cache/hashes.json            size and time of raw files with their digests, only to skip re-hashing
//! ```
//! A key is made of the stage, its version, a fingerprint of its source files, the options it reads and the digests of its inputs
//! ([`key`]). Because inputs enter by content, an output that comes out unchanged stops the cascade; because neither paths outside
//! the tree nor times enter, moving the directory changes nothing.
//!
//! Architecture invariant: the cache knows no stage and no format; it moves bytes.

pub mod collect;
pub mod hashing;
pub mod key;
pub mod reason;
pub mod store;

pub use hashing::{Digest, FileHashes};
pub use key::KeyParts;
pub use reason::Reason;
pub use store::{Entry, Outputs, Store};
