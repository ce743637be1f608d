//! Reports: typed tables, figures and typeset pages.
//!
//! | module | what |
//! |---|---|
//! | [`input`] | everything that a report is made of |
//! | [`table`], [`number`], [`markup`] | one table model: cells, rounding, symbols |
//! | [`render`] | tables as CSV, LaTeX, Typst, Markdown: one file a format |
//! | [`tables`] | one file a table |
//!
//! Architecture invariant: only this folder knows plotters and Typst, and it computes no statistic: every number comes from a stage.

pub mod input;
pub mod markup;
pub mod number;
pub mod render;
pub mod table;
pub mod tables;
