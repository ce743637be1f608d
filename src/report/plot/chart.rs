//! The inside of a panel: maps data to paper through plotters' Cartesian coordinates and draws the layers.

use super::clip::{Window, thin};
use super::label::{Anchor, Label};
use super::layer::{Layer, Place, Series};
use super::marks;
use super::paper::Paper;
use super::pencil::{Pencil, shape_style};
use super::style::{Dash, Ink, Mark, OUTLINE_PT, SMALL_PT, Stroke};
use super::units::{Rect, mm, snap};
use pipeline_base::error::{Error, Result};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{Cartesian2d, DrawingArea, PathElement, Polygon};
use std::collections::BTreeSet;

/// Opacity of shaded windows.
pub const WINDOW_OPACITY: f64 = 0.3;
/// Half the width of the caps of error bars, in millimetres.
const CAP_MM: f64 = 0.5;
/// Width of the columns in which curves are thinned, in millimetres.
const COLUMN_MM: f64 = 0.08;

/// A plot rectangle on paper with its coordinates.
pub struct Chart {
    pencil: Pencil,
    area: DrawingArea<Paper, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    /// What is visible, in data units.
    pub window: Window,
    /// Where it stands on the paper.
    pub rect: Rect,
}

impl Chart {
    /// Coordinates over `rect`, in which `window` is visible.
    pub fn new(pencil: &Pencil, rect: Rect, window: Window) -> Chart {
        let x: RangedCoordf64 = (window.x.0..window.x.1).into();
        let y: RangedCoordf64 = (window.y.0..window.y.1).into();
        let across = snap(rect.left)..snap(rect.right);
        let up = snap(rect.bottom)..snap(rect.top);
        let coordinates = Cartesian2d::new(x, y, (across, up));
        Chart {
            pencil: pencil.clone(),
            area: pencil.sheet().apply_coord_spec(coordinates),
            window,
            rect,
        }
    }

    /// Where a data point stands on the paper.
    pub fn map(&self, point: (f64, f64)) -> (f64, f64) {
        let (x, y) = self.area.map_coordinate(&point);
        (f64::from(x), f64::from(y))
    }

    /// Draws a layer.
    pub fn draw(&self, layer: &Layer) -> Result<()> {
        let Window { x, y } = self.window;
        match layer {
            Layer::Series(series) => self.series(series),
            Layer::Band {
                points,
                ink,
                opacity,
                ..
            } => self.band(points, *ink, *opacity),
            Layer::Windows { spans, ink, .. } => {
                spans.iter().try_for_each(|s| self.shade(*s, *ink))
            }
            Layer::Steps { at, stroke, .. } => at
                .iter()
                .try_for_each(|at| self.curve(&[(*at, y.0), (*at, y.1)], stroke)),
            Layer::Level { at, stroke, .. } => self.curve(&[(x.0, *at), (x.1, *at)], stroke),
            Layer::Identity { .. } => self.curve(&self.identity(), &identity_stroke()),
            Layer::Text {
                text,
                place,
                anchor,
            } => {
                self.text(text, *place, *anchor);
                Ok(())
            }
        }
    }

    /// Two points of the line `y = x` that lie outside the window or on its edge.
    pub fn identity(&self) -> [(f64, f64); 2] {
        let Window { x, y } = self.window;
        let (low, high) = (x.0.min(y.0), x.1.max(y.1));
        [(low, low), (high, high)]
    }

    /// Where an annotation is anchored on the paper.
    pub fn place(&self, place: Place) -> (f64, f64) {
        match place {
            Place::Data(x, y) => self.map((x, y)),
            Place::Plot(x, y) => (
                self.rect.left + x * self.rect.width(),
                self.rect.bottom - y * self.rect.height(),
            ),
        }
    }

    fn series(&self, series: &Series) -> Result<()> {
        if let Some(stroke) = &series.line {
            self.curve(&series.points, stroke)?;
        }
        let ink = series.mark.map(|m| m.ink).or(series.line.map(|l| l.ink));
        let bar = Stroke {
            width_pt: OUTLINE_PT,
            ..Stroke::new(ink.unwrap_or(Ink::Black), Dash::Solid)
        };
        for ((x, _), (low, high)) in series.points.iter().zip(&series.y_errors) {
            self.error_bar([(*x, *low), (*x, *high)], (mm(CAP_MM), 0.0), &bar)?;
        }
        for ((_, y), (low, high)) in series.points.iter().zip(&series.x_errors) {
            self.error_bar([(*low, *y), (*high, *y)], (0.0, mm(CAP_MM)), &bar)?;
        }
        if let Some(mark) = series.mark {
            self.pencil.marks(mark, &self.places(series, mark));
        }
        Ok(())
    }

    /// A line between two points with short strokes across its visible ends.
    fn error_bar(
        &self,
        ends: [(f64, f64); 2],
        (dx, dy): (f64, f64),
        stroke: &Stroke,
    ) -> Result<()> {
        self.curve(&ends, stroke)?;
        for end in ends.into_iter().filter(|e| self.window.contains(*e)) {
            let (x, y) = self.map(end);
            self.pencil
                .line(&[(x - dx, y - dy), (x + dx, y + dy)], stroke)?;
        }
        Ok(())
    }

    /// Where the marks of a series stand; marks that would cover each other to within a hair are drawn once.
    fn places(&self, series: &Series, mark: Mark) -> Vec<(i32, i32)> {
        let cell = if marks::is_dot(mark) { 10 } else { 5 };
        let mut taken = BTreeSet::new();
        let visible = series.points.iter().filter(|p| self.window.contains(**p));
        visible
            .map(|p| self.area.map_coordinate(p))
            .filter(|(x, y)| taken.insert((x / cell, y / cell)))
            .collect()
    }

    fn curve(&self, points: &[(f64, f64)], stroke: &Stroke) -> Result<()> {
        let column = (self.window.x.1 - self.window.x.0) / self.rect.width() * mm(COLUMN_MM);
        self.pencil.dashed(stroke.dash, || {
            for piece in self.window.curve(points) {
                let element = PathElement::new(thin(piece, column), shape_style(stroke));
                self.area.draw(&element).map_err(Error::internal)?;
            }
            Ok(())
        })
    }

    fn band(&self, points: &[(f64, f64, f64)], ink: Ink, opacity: f64) -> Result<()> {
        let visible = self.window.band(points);
        let there = visible.iter().map(|(x, low, _)| (*x, *low));
        let back = visible.iter().rev().map(|(x, _, high)| (*x, *high));
        let outline: Vec<(f64, f64)> = there.chain(back).collect();
        if outline.is_empty() {
            return Ok(());
        }
        let element = Polygon::new(outline, ink.tint(opacity));
        self.area.draw(&element).map_err(Error::internal)
    }

    fn shade(&self, (from, to): (f64, f64), ink: Ink) -> Result<()> {
        let y = self.window.y.0;
        let Some([from, to]) = self.window.segment((from, y), (to, y)) else {
            return Ok(());
        };
        let rect = Rect {
            left: self.map(from).0,
            right: self.map(to).0,
            ..self.rect
        };
        self.pencil.fill(rect, ink.tint(WINDOW_OPACITY))
    }

    fn text(&self, text: &str, place: Place, anchor: Anchor) {
        let label = Label::new(text, SMALL_PT);
        self.pencil.label(&label, self.place(place), anchor);
    }
}

/// The look of the line `y = x`.
pub fn identity_stroke() -> Stroke {
    Stroke::hair(Ink::Black, Dash::Dashed)
}
