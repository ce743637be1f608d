#![warn(missing_docs)]
//! The cache: what was computed from what, kept by content.
//!
//! ```text
//! derived/cache/objects/ab/cdef…        every stage output, named by the SHA-256 of its bytes
//! derived/cache/entries/ab/cdef….jsonl  one computation: the parts of its key, and the digests of its outputs
//! derived/cache/state.jsonl             what each stage and unit had last time: its key, to say why it differs now, and its outputs
//! derived/cache/unchanged.jsonl         fingerprints of all files before and after the last run ([`tree`]), and its messages
//! derived/cache/hashes.jsonl            size and times of raw files and reports with their digests, only to skip re-hashing
//! ```
//! Everything but the objects begins with its own digest ([`sealed`]): what is damaged is not accepted.
//!
//! A run without changes ends after a look at the names, sizes and times of all files (`unchanged.jsonl`). With any change it opens only those
//! entries, of which a large campaign has tens of thousands, that the change concerns: `state.jsonl` holds what is needed of the others, and
//! their objects are only looked at, size and time ([`store::Store::checked`]).
//!
//! A key is made of the stage, its version, a fingerprint of its source files, the options it reads and the digests of its inputs
//! ([`key`]). Because inputs enter by content, an output that comes out unchanged stops the cascade; because neither paths outside
//! the tree nor times enter, moving the directory changes nothing.
//!
//! Many processes may add to one cache at a time (a shared lock, which dies with its process): an object or entry is renamed to its name when it is
//! whole, and the name is a digest, so that two writers of one name write the same. What is not named by its contents, `state.json` and
//! the files that people read, is written by one whole run, which waits until it is alone; so does `gc`.
//!
//! Architecture invariant: the cache knows no stage and no format; it moves bytes.

pub mod collect;
pub mod key;
pub mod reason;
pub mod sealed;
pub mod seen;
pub mod state;
pub mod store;
pub mod tree;

pub use key::KeyParts;
pub use reason::Reason;
pub use seen::FileHashes;
pub use state::{Left, State};
pub use store::{Entry, Store};
