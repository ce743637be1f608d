//! Draws straight onto the paper, in canvas units, with plotters' elements.

use super::label::{Anchor, Label};
use super::paper::Paper;
use super::style::{Dash, Mark, Stroke};
use super::units::{Rect, snap};
use pipeline_base::error::{Error, Result};
use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, PathElement, Rectangle};
use plotters::style::{RGBAColor, ShapeStyle};
use std::cell::RefCell;
use std::rc::Rc;

/// A hand on a sheet of paper that others may draw on too.
#[derive(Clone)]
pub struct Pencil {
    paper: Rc<RefCell<Paper>>,
    root: DrawingArea<Paper, Shift>,
}

impl Pencil {
    /// A pencil for `paper`.
    pub fn new(paper: &Rc<RefCell<Paper>>) -> Pencil {
        Pencil {
            paper: paper.clone(),
            root: paper.into(),
        }
    }

    /// The whole sheet, for coordinates to be laid over it.
    pub fn sheet(&self) -> &DrawingArea<Paper, Shift> {
        &self.root
    }

    /// A line through points.
    pub fn line(&self, points: &[(f64, f64)], stroke: &Stroke) -> Result<()> {
        let points: Vec<(i32, i32)> = points.iter().map(|(x, y)| (snap(*x), snap(*y))).collect();
        self.dashed(stroke.dash, || {
            self.root
                .draw(&PathElement::new(points, shape_style(stroke)))
                .map_err(Error::internal)
        })
    }

    /// Runs `draw` with a dash pattern.
    pub fn dashed(&self, dash: Dash, draw: impl FnOnce() -> Result<()>) -> Result<()> {
        self.paper.borrow_mut().dash(dash);
        let drawn = draw();
        self.paper.borrow_mut().dash(Dash::Solid);
        drawn
    }

    /// A filled rectangle.
    pub fn fill(&self, rect: Rect, color: RGBAColor) -> Result<()> {
        let corners =
            [(rect.left, rect.top), (rect.right, rect.bottom)].map(|(x, y)| (snap(x), snap(y)));
        let style = ShapeStyle {
            color,
            filled: true,
            stroke_width: 0,
        };
        self.root
            .draw(&Rectangle::new(corners, style))
            .map_err(Error::internal)
    }

    /// A label.
    pub fn label(&self, label: &Label, at: (f64, f64), anchor: Anchor) {
        self.paper.borrow_mut().label(label, at, anchor);
    }

    /// Marks.
    pub fn marks(&self, mark: Mark, places: &[(i32, i32)]) {
        self.paper.borrow_mut().marks(mark, places);
    }

    /// Everything that `draw` draws, as a named group.
    pub fn group(&self, name: &str, draw: impl FnOnce() -> Result<()>) -> Result<()> {
        self.paper.borrow_mut().begin_group(name);
        let drawn = draw();
        self.paper.borrow_mut().end_group();
        drawn
    }
}

/// A stroke as plotters' elements take it.
pub fn shape_style(stroke: &Stroke) -> ShapeStyle {
    ShapeStyle {
        color: stroke.ink.tint(1.0),
        filled: false,
        stroke_width: stroke.width(),
    }
}
