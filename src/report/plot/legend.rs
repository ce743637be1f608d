//! Legends: a sample of each named layer and its name, as a block inside or beside a panel or as rows above it.

use super::chart::{WINDOW_OPACITY, identity_stroke};
use super::label::{Anchor, Label, Level, Side};
use super::layer::Layer;
use super::pencil::Pencil;
use super::style::{Ink, Mark, SMALL_PT, Stroke};
use super::units::{Rect, mm, snap};
use pipeline_base::error::Result;
use std::borrow::Cow;
use std::collections::BTreeSet;

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
/// Width of the longest name, in millimetres: with its sample it fits on a single column. A longer one is shortened.
const WIDEST_MM: f64 = 72.0;
/// So many rows have room above anything.
const FEWEST_ROWS: usize = 3;

/// How many rows fit into a height, canvas units.
pub fn rows_within(height: f64) -> usize {
    ((height / mm(PITCH_MM)).floor() as usize).max(FEWEST_ROWS)
}

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
    /// Of the line that counts what a legend leaves out.
    None,
}

/// A sample and its name.
#[derive(Clone)]
struct Entry {
    sample: Sample,
    name: Label,
}

impl Entry {
    /// The line that counts entries for which there is no room.
    fn more(count: usize) -> Entry {
        Entry {
            sample: Sample::None,
            name: Label::new(&format!("and {count} more"), SMALL_PT),
        }
    }
}

/// Entries from top to bottom, by rows, with their places from the left.
type Rows<'a> = Vec<Vec<(f64, Cow<'a, Entry>)>>;

/// The entries of a legend, measured.
///
/// A legend has no more rows than it is given: a pool of a hundred specimens would leave its figure no room. What is left out is counted in a
/// line of its own.
pub struct Key {
    entries: Vec<Entry>,
    sample_width: f64,
    /// Of rows above a panel.
    most_rows: usize,
    /// Of lines of a block.
    most_lines: usize,
}

impl Key {
    /// The named layers, each name once, in so many rows at most. A block has a line for each, unless it is given fewer ([`Key::block_of`]).
    pub fn new<'a>(layers: impl IntoIterator<Item = &'a Layer>, most_rows: usize) -> Key {
        let mut entries: Vec<Entry> = Vec::new();
        let mut seen = BTreeSet::new();
        for (name, sample) in layers.into_iter().filter_map(sample) {
            if !name.is_empty() && seen.insert(name) {
                let name = Label::within(name, SMALL_PT, mm(WIDEST_MM));
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
            most_rows,
            most_lines: usize::MAX,
        }
    }

    /// The same with so many lines in a block at most.
    pub fn block_of(mut self, most_lines: usize) -> Key {
        self.most_lines = most_lines;
        self
    }

    /// Nothing to explain.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Width and height of a block with one entry a line.
    pub fn block(&self) -> (f64, f64) {
        let lines = self.lines();
        let widest = lines.iter().map(|e| e.name.width).fold(0.0, f64::max);
        let height = lines.len() as f64 * mm(PITCH_MM);
        (self.sample_width + mm(GAP_MM) + widest, height)
    }

    /// The entries of a block.
    fn lines(&self) -> Vec<Cow<'_, Entry>> {
        let count = self.entries.len();
        if count <= self.most_lines {
            return self.beginning(count);
        }
        self.beginning(self.most_lines.saturating_sub(1))
    }

    /// The first entries, and where these are not all a line that counts the others.
    fn beginning(&self, count: usize) -> Vec<Cow<'_, Entry>> {
        let mut entries: Vec<Cow<Entry>> =
            self.entries[..count].iter().map(Cow::Borrowed).collect();
        let left = self.entries.len() - count;
        if left > 0 {
            entries.push(Cow::Owned(Entry::more(left)));
        }
        entries
    }

    /// Draws a block with its upper left corner there, on paper that veils what lies below it.
    pub fn draw_block(&self, pencil: &Pencil, corner: Rect) -> Result<()> {
        let (width, height) = self.block();
        let rect = Rect::sized(corner.left, corner.top, width, height);
        pencil.fill(rect.wider(mm(VEIL_MM)), Ink::White.tint(VEIL_OPACITY))?;
        for (i, entry) in self.lines().iter().enumerate() {
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
                self.draw_entry(pencil, &entry, (left + x, y))?;
            }
        }
        Ok(())
    }

    /// The entries of each row with their places: all of them, or as many of the first as leave room for the line that counts the others.
    fn rows(&self, width: f64) -> Rows<'_> {
        let count = self.entries.len();
        let all = self.arranged(self.beginning(count), width);
        if all.len() <= self.most_rows {
            return all;
        }
        let narrowest = self.sample_width + mm(GAP_MM + COLUMN_GAP_MM);
        let at_most = self.most_rows * (width / narrowest).ceil().max(1.0) as usize;
        let first = |k: usize| self.arranged(self.beginning(k), width);
        let shortened = (1..=at_most.min(count - 1)).rev().map(first);
        shortened
            .into_iter()
            .find(|rows| rows.len() <= self.most_rows)
            .unwrap_or_else(|| first(0))
    }

    /// One after another if they fit into a row, else in columns.
    fn arranged<'a>(&self, entries: Vec<Cow<'a, Entry>>, width: f64) -> Rows<'a> {
        let widths: Vec<f64> = entries
            .iter()
            .map(|e| self.sample_width + mm(GAP_MM) + e.name.width)
            .collect();
        let total: f64 = widths.iter().map(|w| w + mm(COLUMN_GAP_MM)).sum();
        if total - mm(COLUMN_GAP_MM) <= width {
            let starts = widths.iter().scan(0.0, |at, w| {
                let start = *at;
                *at += w + mm(COLUMN_GAP_MM);
                Some(start)
            });
            return vec![starts.zip(entries).collect()];
        }
        let pitch = widths.iter().copied().fold(0.0, f64::max) + mm(COLUMN_GAP_MM);
        let columns = ((width + mm(COLUMN_GAP_MM)) / pitch).floor().max(1.0) as usize;
        let mut rows: Rows<'a> = Vec::new();
        for (i, entry) in entries.into_iter().enumerate() {
            if i % columns == 0 {
                rows.push(Vec::new());
            }
            let x = (i % columns) as f64 * pitch;
            if let Some(row) = rows.last_mut() {
                row.push((x, entry));
            }
        }
        rows
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
            Sample::None => {
                let anchor = Anchor::new(Side::Left, Level::Center);
                pencil.label(&entry.name, (x, y), anchor);
                return Ok(());
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
        Layer::Band {
            name, ink, opacity, ..
        } => (name, Sample::Patch(*ink, *opacity)),
        Layer::Windows { name, ink, .. } => (name, Sample::Patch(*ink, WINDOW_OPACITY)),
        Layer::Steps { name, stroke, .. } | Layer::Level { name, stroke, .. } => {
            (name, Sample::Line(Some(*stroke), None))
        }
        Layer::Identity { name } => (name, Sample::Line(Some(identity_stroke()), None)),
        Layer::Text { .. } => return None,
    })
}
