//! Fingerprints of the code behind each crate of the workspace, by its name: made when this crate is built, from the graph of crates.

include!(concat!(env!("OUT_DIR"), "/fingerprints.rs"));
