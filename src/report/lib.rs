#![warn(missing_docs)]
//! Reports: typed tables, figures and typeset pages.
//!
//! | module | what |
//! |---|---|
//! | [`input`] | everything that a report is made of |
//! | [`extent`] | how much the pages of a large laboratory hold |
//! | [`table`], [`number`], [`markup`], [`symbols`] | one table model: cells, rounding, symbols |
//! | [`described`] | how a table is described: columns of headings, units, roundings and what they say of a row |
//! | [`render`] | tables as CSV, LaTeX, Typst, Markdown: one file a format |
//! | [`tables`] | the tables, those that are variants of each other in one file |
//! | [`plot`] | journal figures on plotters: axes, layers, legends |
//! | [`figures`] | one file a figure |
//! | [`wording`] | names, numbers and sentences of what was found |
//! | [`predictions`] | what models and the residual search expect of every reading |
//! | [`left_out`] | figures and documents that could not be built |
//! | [`pages`] | what every document has in common: data of its template, tables, pictures |
//! | [`force`] | the pages of `force.pdf`; `opening` its first |
//! | [`audit`] | the pages of `audit.pdf` |
//! | [`residual`] | the pages of `residual.pdf` |
//! | [`knee`] | the pages of `knee.pdf` |
//! | [`explorer`] | the page for a browser, `explorer.html` |
//! | [`layout`] | what stands where on a typeset page |
//! | `summary` | `summary.json` |
//! | [`supplement`] | the pages of `supplement.pdf` |
//! | [`typeset`], [`raster`], [`fonts`] | pages through Typst, figures as PNG, the bundled fonts |
//!
//! Architecture invariant: only this folder knows plotters and Typst, and it computes no statistic: every number comes from a stage.

pub mod audit;
pub mod described;
pub mod explorer;
pub mod extent;
pub mod figures;
pub mod fonts;
pub mod force;
pub mod input;
pub mod knee;
pub mod layout;
pub mod left_out;
pub mod markup;
pub mod number;
mod opening;
pub mod pages;
pub mod plot;
pub mod predictions;
pub mod raster;
pub mod render;
pub mod residual;
pub mod stage;
mod summary;
pub mod supplement;
pub mod symbols;
pub mod table;
pub mod tables;
pub mod typeset;
pub mod wording;
