#![warn(missing_docs)]
//! One mixed model, and what is asked of it.
