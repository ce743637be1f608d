//! Legends: a sample of each named layer and its name, as a block inside or beside a panel or as rows above it.

use super::chart::{BAND_OPACITY, WINDOW_OPACITY, identity_stroke};
use super::label::{Anchor, Label, Level, Side};
use super::layer::Layer;
use super::pencil::Pencil;
use super::style::{Ink, Mark, SMALL_PT, Stroke};
use super::units::{Rect, mm, snap};
use crate::base::error::Result;

/// Distance between the base lines of entries, in millimetres.
const PITCH_MM: f64 = 3.4;
/// Distance between a sample and its name, in millimetres.
const GAP_MM: f64 = 1.2;
/// Distance between entries of a row, in millimetres.
const COLUMN_GAP_MM: f64 = 4.0;

/// How far the paper below a legend reaches beyond it, in millimetres.
const VEIL_MM: f64 = 0.6;
/// Opacity of that paper.
const VEIL_OPACITY: f64 = 0.85;

/// Room below a legend in rows, in millimetres.
const ROWS_GAP_MM: f64 = 1.2;

/// Where the legend of a panel stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Legend {
    /// Inside where nothing is covered, else above.
    Auto,
    /// In rows above the panel.
    Above,
    /// To the right of the panel.
    Beside,
    /// Nowhere.
    None,
}

/// The sample of a layer.
#[derive(Clone, Debug, PartialEq)]
enum Sample {
    Line(Option<Stroke>, Option<Mark>),
    Patch(Ink, f64),
}

/// A sample and its name.
struct Entry {
    sample: Sample,
    name: Label,
}

/// The entries of a legend, measured.
pub struct Key {
    entries: Vec<Entry>,
    sample_width: f64,
}

impl Key {
    /// The named layers, each name once.
    pub fn new<'a>(layers: impl IntoIterator<Item = &'a Layer>) -> Key {
        let mut entries: Vec<Entry> = Vec::new();
        for (name, sample) in layers.into_iter().filter_map(sample) {
            let name = Label::new(name, SMALL_PT);
            if !name.plain.is_empty() && entries.iter().all(|e| e.name.plain != name.plain) {
                entries.push(Entry { sample, name });
            }
        }
        let marks_only = |e: &Entry| matches!(e.sample, Sample::Line(None, _));
        let sample_width = if entries.iter().all(marks_only) {
            mm(2.0)
        } else {
            mm(6.0)
        };
        Key {
            entries,
            sample_width,
        }
    }

    /// Nothing to explain.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Width and height of a block with one entry a line.
    pub fn block(&self) -> (f64, f64) {
        let widest = self
            .entries
            .iter()
            .map(|e| e.name.width)
            .fold(0.0, f64::max);
        let height = self.entries.len() as f64 * mm(PITCH_MM);
        (self.sample_width + mm(GAP_MM) + widest, height)
    }

    /// Draws a block with its upper left corner there, on paper that veils what lies below it.
    pub fn draw_block(&self, pencil: &Pencil, corner: Rect) -> Result<()> {
        let (width, height) = self.block();
        let rect = Rect::sized(corner.left, corner.top, width, height);
        pencil.fill(rect.wider(mm(VEIL_MM)), Ink::White.tint(VEIL_OPACITY))?;
        for (i, entry) in self.entries.iter().enumerate() {
            let y = rect.top + (i as f64 + 0.5) * mm(PITCH_MM);
            self.draw_entry(pencil, entry, (rect.left, y))?;
        }
        Ok(())
    }

    /// Height of rows no wider than `width`, with the gap below them; nothing where there is nothing to explain.
    pub fn rows_room(&self, width: f64) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        self.rows(width).len() as f64 * mm(PITCH_MM) + mm(ROWS_GAP_MM)
    }

    /// Draws rows no wider than `width` from the upper left corner on.
    pub fn draw_rows(&self, pencil: &Pencil, (left, top): (f64, f64), width: f64) -> Result<()> {
        for (i, row) in self.rows(width).into_iter().enumerate() {
            let y = top + (i as f64 + 0.5) * mm(PITCH_MM);
            for (x, entry) in row {
                self.draw_entry(pencil, entry, (left + x, y))?;
            }
        }
        Ok(())
    }

    /// The entries of each row with their places: one after another if they fit into a row, else in columns.
    fn rows(&self, width: f64) -> Vec<Vec<(f64, &Entry)>> {
        let width_of = |e: &Entry| self.sample_width + mm(GAP_MM) + e.name.width;
        let widths = self.entries.iter().map(width_of);
        let total: f64 = widths.clone().map(|w| w + mm(COLUMN_GAP_MM)).sum();
        if total - mm(COLUMN_GAP_MM) <= width {
            let starts = widths.scan(0.0, |at, w| {
                let start = *at;
                *at += w + mm(COLUMN_GAP_MM);
                Some(start)
            });
            return vec![starts.zip(&self.entries).collect()];
        }
        let pitch = widths.fold(0.0, f64::max) + mm(COLUMN_GAP_MM);
        let columns = ((width + mm(COLUMN_GAP_MM)) / pitch).floor().max(1.0) as usize;
        let placed = |(i, e)| (i as f64 * pitch, e);
        let rows = self.entries.chunks(columns);
        rows.map(|row| row.iter().enumerate().map(placed).collect())
            .collect()
    }

    fn draw_entry(&self, pencil: &Pencil, entry: &Entry, (x, y): (f64, f64)) -> Result<()> {
        let end = x + self.sample_width;
        match &entry.sample {
            Sample::Line(stroke, mark) => {
                if let Some(stroke) = stroke {
                    pencil.line(&[(x, y), (end, y)], stroke)?;
                }
                if let Some(mark) = mark {
                    pencil.marks(*mark, &[(snap((x + end) / 2.0), snap(y))]);
                }
            }
            Sample::Patch(ink, opacity) => {
                let patch = Rect::sized(x, y - mm(1.0), self.sample_width, mm(2.0));
                pencil.fill(patch, ink.tint(*opacity))?;
            }
        }
        let at = (end + mm(GAP_MM), y);
        pencil.label(&entry.name, at, Anchor::new(Side::Left, Level::Center));
        Ok(())
    }
}

fn sample(layer: &Layer) -> Option<(&str, Sample)> {
    Some(match layer {
        Layer::Series(series) => {
            let mark = series.mark.map(Mark::in_legend);
            (&series.name, Sample::Line(series.line, mark))
        }
        Layer::Band { name, ink, .. } => (name, Sample::Patch(*ink, BAND_OPACITY)),
        Layer::Windows { name, ink, .. } => (name, Sample::Patch(*ink, WINDOW_OPACITY)),
        Layer::Steps { name, stroke, .. } | Layer::Level { name, stroke, .. } => {
            (name, Sample::Line(Some(*stroke), None))
        }
        Layer::Identity { name } => (name, Sample::Line(Some(identity_stroke()), None)),
        Layer::Text { .. } => return None,
    })
}
