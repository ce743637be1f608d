//! A figure: panels on a grid, their plot rectangles aligned, at the size at which a journal prints it.

use super::legend::{Key, rows_within};
use super::panel::{Panel, Plan};
use super::paper::Paper;
use super::pencil::Pencil;
use super::units::{Rect, mm};
use pipeline_base::error::{Error, Result};
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
/// How much of a figure's height its common legend may take.
const LEGEND_SHARE: f64 = 0.3;

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

    /// The same figure, by some steps of so many mm higher if it is too small for its labels: how many rows a legend takes depends on their width.
    pub fn with_room(mut self, step_mm: f64, most_steps: usize) -> Figure {
        for _ in 0..most_steps {
            if self.to_svg().is_ok() {
                break;
            }
            self.height_mm += step_mm;
        }
        self
    }

    /// The figure as an SVG file.
    ///
    /// # Errors
    /// If there is no panel, or the figure is too small for its labels.
    pub fn to_svg(&self) -> Result<String> {
        let paper = Rc::new(RefCell::new(Paper::new(
            mm(self.width_mm),
            mm(self.height_mm),
        )));
        self.draw(&Pencil::new(&paper))?;
        let paper =
            Rc::into_inner(paper).ok_or_else(|| Error::internal("a pencil outlived its figure"))?;
        Ok(paper.into_inner().finish(&self.title))
    }

    fn draw(&self, pencil: &Pencil) -> Result<()> {
        let layers = self.panels.iter().flat_map(|p| &p.layers);
        let most_rows = rows_within(LEGEND_SHARE * mm(self.height_mm));
        let shared = Key::new(layers.filter(|_| self.shared_legend), most_rows);
        let width = mm(self.width_mm - 2.0 * EDGE_MM);
        let head = shared.rows_room(width);
        let mut plans = self.plans();
        let mut rects = self.layout(&plans, head)?;
        while settle_one(&mut plans, pencil, &rects) {
            rects = self.layout(&plans, head)?;
        }
        shared.draw_rows(pencil, (mm(EDGE_MM), mm(EDGE_MM)), width)?;
        for (i, (plan, rect)) in plans.iter().zip(&rects).enumerate() {
            let row = i / self.columns.len() * self.columns.len();
            let neighbours = &plans[row..(row + self.columns.len()).min(plans.len())];
            let above = rect.top - room_above(neighbours, narrowest(&rects));
            pencil.group(&format!("panel-{}", i + 1), || {
                plan.draw(pencil, *rect, above)
            })?;
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
        let across = self.across(plans);
        let widths = across.iter().map(|(from, to)| to - from);
        let narrowest = widths.fold(f64::INFINITY, f64::min);
        let down = self.down(plans, head, narrowest);
        let rect = |i: usize| {
            let ((left, right), (top, bottom)) = (across[i % columns], down[i / columns]);
            Rect {
                left,
                top,
                right,
                bottom,
            }
        };
        let rects: Vec<Rect> = (0..plans.len()).map(rect).collect();
        let large = |r: &Rect| r.width() >= mm(10.0) && r.height() >= mm(5.0);
        if rects.is_empty() || !rects.iter().all(large) {
            return Err(self.too_small());
        }
        Ok(rects)
    }

    /// Where the plot rectangles of each column begin and end.
    fn across(&self, plans: &[Plan<'_>]) -> Vec<(f64, f64)> {
        let columns = self.columns.len();
        let margins = (0..columns).map(|c| {
            let column = || plans.iter().skip(c).step_by(columns);
            let left = column().map(Plan::left).fold(0.0, f64::max);
            let right = column().map(Plan::right).fold(0.0, f64::max);
            (left, right)
        });
        let right = mm(self.width_mm - EDGE_MM);
        share(mm(EDGE_MM), right, margins, &self.columns)
    }

    /// Where the plot rectangles of each row begin and end, below a common legend of height `head`.
    fn down(&self, plans: &[Plan<'_>], head: f64, width: f64) -> Vec<(f64, f64)> {
        let rows = plans.chunks(self.columns.len());
        let margins = rows.map(|row| {
            let bottom = row.iter().map(Plan::bottom).fold(0.0, f64::max);
            (room_above(row, width), bottom)
        });
        let weight = |r: usize| self.rows.get(r).copied().unwrap_or(1.0);
        let weights: Vec<f64> = (0..self.row_count()).map(weight).collect();
        let bottom = mm(self.height_mm - EDGE_MM);
        share(mm(EDGE_MM) + head, bottom, margins, &weights)
    }

    fn too_small(&self) -> Error {
        Error::internal(format!(
            "figure \"{}\": {} panels do not fit on {} mm x {} mm",
            self.title,
            self.panels.len(),
            self.width_mm,
            self.height_mm
        ))
    }
}

/// Room above the plot rectangles of a row.
fn room_above(row: &[Plan<'_>], width: f64) -> f64 {
    row.iter().map(|p| p.top(width)).fold(0.0, f64::max)
}

fn narrowest(rects: &[Rect]) -> f64 {
    rects.iter().map(Rect::width).fold(f64::INFINITY, f64::min)
}

/// Moves a legend that finds no room inside its panel; says whether there was one.
fn settle_one(plans: &mut [Plan<'_>], pencil: &Pencil, rects: &[Rect]) -> bool {
    let mut panels = plans.iter_mut().zip(rects);
    panels.any(|(plan, rect)| plan.settle_legend(pencil, *rect))
}

/// Shares out a length: each part gets its margins before and after, the rest goes by weight. Returns where the parts begin and end.
fn share(
    from: f64,
    to: f64,
    margins: impl Iterator<Item = (f64, f64)>,
    weights: &[f64],
) -> Vec<(f64, f64)> {
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
