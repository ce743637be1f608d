//! A figure: panels on a grid, their plot rectangles aligned, at the size at which a journal prints it.

use super::backend::Paper;
use super::legend::Key;
use super::panel::{Panel, Plan};
use super::pencil::Pencil;
use super::units::{Rect, mm};
use crate::base::error::{Error, Result};
use std::cell::RefCell;
use std::rc::Rc;

/// Width of a single column in millimetres.
pub const SINGLE_MM: f64 = 85.0;
/// Width of two columns in millimetres.
pub const DOUBLE_MM: f64 = 175.0;
/// Blank edge of a figure in millimetres.
const EDGE_MM: f64 = 0.5;
/// Room between panels in millimetres.
const GAP_MM: f64 = 3.0;

/// A figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it shows, for screen readers and file managers; plain text.
    pub title: String,
    /// Width in millimetres.
    pub width_mm: f64,
    /// Height in millimetres.
    pub height_mm: f64,
    /// Panels by rows.
    pub panels: Vec<Panel>,
    /// Relative widths of the columns of panels.
    pub columns: Vec<f64>,
    /// Relative heights of the rows of panels; rows without one count as 1.
    pub rows: Vec<f64>,
    /// Whether panels are labelled (A), (B) and so on.
    pub lettered: bool,
    /// Whether one legend in rows above all panels replaces theirs.
    pub shared_legend: bool,
}

impl Figure {
    /// A figure without panels, one panel wide.
    pub fn new(title: &str, width_mm: f64, height_mm: f64) -> Figure {
        Figure {
            title: title.into(),
            width_mm,
            height_mm,
            panels: Vec::new(),
            columns: vec![1.0],
            rows: Vec::new(),
            lettered: false,
            shared_legend: false,
        }
    }

    /// The same figure with one panel more.
    pub fn with(mut self, panel: Panel) -> Figure {
        self.panels.push(panel);
        self
    }

    /// The same figure with so many columns of panels, which are lettered.
    pub fn grid(mut self, columns: usize) -> Figure {
        self.columns = vec![1.0; columns.max(1)];
        self.lettered = true;
        self
    }

    /// The same figure with relative row heights.
    pub fn row_heights(mut self, heights: &[f64]) -> Figure {
        self.rows = heights.to_vec();
        self
    }

    /// The same figure with one legend for all panels.
    pub fn shared_legend(mut self) -> Figure {
        self.shared_legend = true;
        self
    }

    /// The figure as an SVG file.
    ///
    /// # Errors
    /// If there is no panel, or the figure is too small for its labels.
    pub fn to_svg(&self) -> Result<String> {
        let paper = Rc::new(RefCell::new(Paper::new(mm(self.width_mm), mm(self.height_mm))));
        self.draw(&Pencil::new(&paper))?;
        let paper = Rc::into_inner(paper).ok_or_else(|| Error::internal("a pencil outlived its figure"))?;
        Ok(paper.into_inner().finish(&self.title))
    }

    fn draw(&self, pencil: &Pencil) -> Result<()> {
        let shared = Key::new(self.panels.iter().flat_map(|p| &p.layers).filter(|_| self.shared_legend));
        let width = mm(self.width_mm - 2.0 * EDGE_MM);
        let head = shared.rows_height(width);
        let mut plans = self.plans();
        let rects = self.layout(&plans, head)?;
        let mut moved = false;
        for (plan, rect) in plans.iter_mut().zip(&rects) {
            moved |= plan.settle_legend(pencil, *rect);
        }
        let rects = if moved { self.layout(&plans, head)? } else { rects };
        shared.draw_rows(pencil, (mm(EDGE_MM), mm(EDGE_MM)), width)?;
        for (i, (plan, rect)) in plans.iter().zip(rects).enumerate() {
            pencil.group(&format!("panel-{}", i + 1), || plan.draw(pencil, rect))?;
        }
        Ok(())
    }

    fn plans(&self) -> Vec<Plan<'_>> {
        let size = (
            mm(self.width_mm) / self.columns.len() as f64 - mm(13.0),
            mm(self.height_mm) / self.row_count() as f64 - mm(11.0),
        );
        let letter = |i: usize| match (self.lettered, u8::try_from(i)) {
            (true, Ok(i)) if i < 26 => format!("({})", char::from(b'A' + i)),
            _ => String::new(),
        };
        let panels = self.panels.iter().enumerate();
        panels
            .map(|(i, panel)| Plan::new(panel, letter(i), size, !self.shared_legend))
            .collect()
    }

    fn row_count(&self) -> usize {
        self.panels.len().div_ceil(self.columns.len()).max(1)
    }

    /// The plot rectangles: equal margins in each column and row, the rest shared out by weight.
    fn layout(&self, plans: &[Plan<'_>], head: f64) -> Result<Vec<Rect>> {
        let columns = self.columns.len();
        let rows = self.row_count();
        let in_column = |c: usize| plans.iter().skip(c).step_by(columns);
        let in_row = |r: usize| plans.iter().skip(r * columns).take(columns);
        let margins = (0..columns).map(|c| (largest(in_column(c), Plan::left), largest(in_column(c), Plan::right)));
        let across = share(mm(EDGE_MM), mm(self.width_mm - EDGE_MM), margins, &self.columns);
        let widths: Vec<f64> = across.iter().map(|(from, to)| to - from).collect();
        let narrowest = widths.iter().copied().fold(f64::INFINITY, f64::min);
        let margins = (0..rows).map(|r| (largest(in_row(r), |p| p.top(narrowest)), largest(in_row(r), Plan::bottom)));
        let weights: Vec<f64> = (0..rows).map(|r| self.rows.get(r).copied().unwrap_or(1.0)).collect();
        let down = share(mm(EDGE_MM) + head, mm(self.height_mm - EDGE_MM), margins, &weights);
        let rects: Vec<Rect> = (0..plans.len())
            .map(|i| {
                let ((left, right), (top, bottom)) = (across[i % columns], down[i / columns]);
                Rect { left, top, right, bottom }
            })
            .collect();
        let large = |r: &Rect| r.width() >= mm(10.0) && r.height() >= mm(5.0);
        if rects.is_empty() || !rects.iter().all(large) {
            return Err(Error::internal(format!(
                "figure \"{}\": {} panels do not fit on {} mm x {} mm",
                self.title,
                self.panels.len(),
                self.width_mm,
                self.height_mm
            )));
        }
        Ok(rects)
    }
}

fn largest<'a, 'b: 'a>(plans: impl Iterator<Item = &'a Plan<'b>>, of: impl Fn(&Plan<'b>) -> f64) -> f64 {
    plans.map(of).fold(0.0, f64::max)
}

/// Shares out a length: each part gets its margins before and after, the rest goes by weight. Returns where the parts begin and end.
fn share(from: f64, to: f64, margins: impl Iterator<Item = (f64, f64)>, weights: &[f64]) -> Vec<(f64, f64)> {
    let margins: Vec<(f64, f64)> = margins.collect();
    let taken: f64 = margins.iter().map(|(before, after)| before + after).sum();
    let free = to - from - taken - mm(GAP_MM) * (weights.len() as f64 - 1.0);
    let total: f64 = weights.iter().sum();
    let mut at = from;
    let mut parts = Vec::new();
    for ((before, after), weight) in margins.iter().zip(weights) {
        let begin = at + before;
        let end = begin + free * weight / total;
        parts.push((begin, end));
        at = end + after + mm(GAP_MM);
    }
    parts
}
