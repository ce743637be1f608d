//! Journal figures: a thin layer over plotters that thinks in millimetres and points.
//!
//! A [`Figure`] holds [`Panel`]s on a grid, a panel two [`Axis`] and [`Layer`]s. Everything that journals ask for is the default:
//! letters of 7 points or more (subscripts 5), lines of half a point or more, ticks outwards, no grid, colours that the colour blind
//! tell apart and that never stand alone, legends that cover no data where that is possible.
//!
//! What plotters does for us: its Cartesian coordinates map data to the paper, its paths, polygons and rectangles come through
//! [`backend`] as primitives, and its types of colour and stroke are ours. Only [`chart`], [`pencil`] and [`backend`] draw with it.
//!
//! What we do: the page in millimetres; axes and their ticks; clipping and thinning of curves; labels and legends, and where they find
//! room; marks, dashes, letters as outlines ([`glyphs`] says why) and the SVG itself. plotters' own chart builder, legends and text
//! know neither millimetres nor journals.
//!
//! Invariants: nothing that is not finite reaches the file; numbers in it are whole hundredths of a millimetre; no order depends on
//! a hash; the same figure gives the same bytes.

pub mod axis;
mod backend;
mod chart;
mod clip;
pub mod figure;
mod frame;
pub mod glyphs;
pub mod label;
pub mod layer;
pub mod legend;
mod marks;
mod obstacles;
pub mod panel;
mod paper;
mod path;
mod pencil;
pub mod style;
pub mod units;

pub use axis::Axis;
pub use figure::{DOUBLE_MM, Figure, SINGLE_MM};
pub use label::{Anchor, Level, Side};
pub use layer::{Layer, Place, Series};
pub use legend::Legend;
pub use panel::Panel;
pub use style::{Dash, Ink, Mark, Shape, Stroke, look};

#[cfg(test)]
mod tests;
