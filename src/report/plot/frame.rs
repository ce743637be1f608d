//! The frame of a panel: two axes with ticks outwards, their numbers and labels, the panel's letter and heading. No box, no grid.

use super::axis::{Axis, Ticks};
use super::chart::Chart;
use super::clip::Window;
use super::label::{Anchor, Label, Level, Side};
use super::panel::Panel;
use super::pencil::Pencil;
use super::style::{Dash, Ink, LABEL_PT, PANEL_PT, SMALL_PT, Stroke};
use super::units::{PER_MM, Rect, mm};
use pipeline_base::error::Result;

/// Length of ticks, in millimetres.
const TICK_MM: f64 = 0.9;
/// Distance between a tick and its number, in millimetres.
const NUMBER_GAP_MM: f64 = 0.8;
/// Distance between numbers and the label of the axis, in millimetres.
const LABEL_GAP_MM: f64 = 1.6;
/// How far labels and headings may reach beyond their panel, in millimetres.
const BESIDE_MM: f64 = 10.0;
/// Widest name of a tick, as a part of the panel's width: a longer one would leave no room for the data.
const WIDEST_NAME: f64 = 0.5;
/// Names of ticks below a panel take at least so much room, in millimetres, and have so much between them.
const NAME_WIDTH_MM: f64 = 9.0;
const NAME_GAP_MM: f64 = 1.5;
/// Names of ticks beside a panel stand at least so far apart, in millimetres.
const NAME_PITCH_MM: f64 = 2.8;
/// Distance between a panel's heading and what is below it, in millimetres.
const HEADING_GAP_MM: f64 = 2.2;

/// Measured axes.
pub struct Frame {
    /// What is visible, in data units.
    pub window: Window,
    x_ticks: Vec<(f64, Label)>,
    y_ticks: Vec<(f64, Label)>,
    x_label: Label,
    y_label: Label,
    title: Label,
}

impl Frame {
    /// How many steps suit axes of a panel of about this size.
    pub fn steps((width, height): (f64, f64)) -> (usize, usize) {
        let count = |length: f64, pitch: f64, most: f64| {
            (length / PER_MM / pitch).floor().clamp(2.0, most) as usize
        };
        (count(width, 10.0, 8.0), count(height, 7.5, 7.0))
    }

    /// Measures the axes of a panel.
    pub fn new(panel: &Panel, window: Window, size: (f64, f64)) -> Frame {
        let (mut across, mut up) = Frame::steps(size);
        if panel.same_range {
            (across, up) = (across.min(up), across.min(up));
        }
        let labelled = |ticks: Vec<(f64, String)>, numbered: bool| -> Vec<(f64, Label)> {
            let text = |t: String| if numbered { t } else { String::new() };
            ticks
                .into_iter()
                .map(|(at, t)| (at, Label::new(&text(t), SMALL_PT)))
                .collect()
        };
        let fits = |ticks: &[(f64, Label)]| {
            let room: f64 = ticks.iter().map(|(_, l)| l.width + mm(2.0)).sum();
            room <= size.0
        };
        let ticks = |n: usize| labelled(panel.x.ticks(window.x, n), panel.x.numbered);
        // One number says nothing of the scale: more steps then, if they fit.
        let x_ticks = (2..=across)
            .rev()
            .chain(across + 1..=2 * across)
            .map(ticks)
            .find(|ticks| fits(ticks) && ticks.len() > 1)
            .unwrap_or_else(|| crowded(ticks(2), &panel.x, size.0));
        let y_ticks = labelled(panel.y.ticks(window.y, up), panel.y.numbered);
        Frame {
            window,
            x_ticks,
            y_ticks: beside(y_ticks, &panel.y, size),
            x_label: Label::within(&panel.x.label, LABEL_PT, size.0 + mm(BESIDE_MM)),
            y_label: Label::within(&panel.y.label, LABEL_PT, size.1 + mm(BESIDE_MM)),
            title: Label::within(&panel.title, LABEL_PT, size.0 + mm(BESIDE_MM)),
        }
    }

    /// Room for numbers and label of the vertical axis.
    pub fn left(&self) -> f64 {
        let numbers = widest(&self.y_ticks);
        let label = if self.y_label.width > 0.0 {
            self.y_label.height() + self.y_label.depth() + mm(LABEL_GAP_MM)
        } else {
            0.0
        };
        mm(TICK_MM + NUMBER_GAP_MM) + numbers + label
    }

    /// Room for numbers and label of the horizontal axis.
    pub fn bottom(&self) -> f64 {
        let numbers = if widest(&self.x_ticks) > 0.0 {
            Label::new("0", SMALL_PT).height() + mm(NUMBER_GAP_MM)
        } else {
            0.0
        };
        let label = if self.x_label.width > 0.0 {
            self.x_label.height() + self.x_label.depth() + mm(LABEL_GAP_MM)
        } else {
            0.0
        };
        mm(TICK_MM) + numbers + label
    }

    /// Room for the half of the last number that stands beyond the axis.
    pub fn right(&self) -> f64 {
        self.x_ticks
            .last()
            .map_or(0.0, |(_, l)| l.width / 2.0)
            .max(mm(1.0))
    }

    /// Room above the plot rectangle for letter, heading and the rows of a legend, which stand beside the letter where there is no
    /// heading.
    pub fn top(&self, letter: &str, rows: f64) -> f64 {
        let heading = self.heading_height(letter);
        let together = if self.title.plain.is_empty() {
            heading.max(rows)
        } else {
            heading + rows
        };
        together.max(mm(1.2))
    }

    /// Height of the line with letter and heading; none where both are missing.
    fn heading_height(&self, letter: &str) -> f64 {
        if letter.is_empty() && self.title.plain.is_empty() {
            return 0.0;
        }
        Label::bold(letter, PANEL_PT).height() + mm(HEADING_GAP_MM)
    }

    /// Draws letter and heading with their capitals touching `top`.
    pub fn draw_heading(&self, pencil: &Pencil, letter: &str, (rect, top): (Rect, f64)) {
        let letter = Label::bold(letter, PANEL_PT);
        let base = top + letter.height();
        let far_left = (rect.left - self.left(), base);
        pencil.label(&letter, far_left, Anchor::new(Side::Left, Level::Base));
        let middle = ((rect.left + rect.right) / 2.0, base);
        pencil.label(&self.title, middle, Anchor::new(Side::Middle, Level::Base));
    }

    /// Draws axes, ticks, numbers and labels.
    pub fn draw(&self, pencil: &Pencil, chart: &Chart) -> Result<()> {
        let rect = chart.rect;
        let hair = Stroke::hair(Ink::Black, Dash::Solid);
        let corner = [
            (rect.left, rect.top),
            (rect.left, rect.bottom),
            (rect.right, rect.bottom),
        ];
        pencil.line(&corner, &hair)?;
        let below = rect.bottom + mm(TICK_MM);
        for (at, number) in &self.x_ticks {
            let x = chart.map((*at, self.window.y.0)).0;
            pencil.line(&[(x, rect.bottom), (x, below)], &hair)?;
            pencil.label(
                number,
                (x, below + mm(NUMBER_GAP_MM)),
                Anchor::new(Side::Middle, Level::Top),
            );
        }
        let beside = rect.left - mm(TICK_MM);
        for (at, number) in &self.y_ticks {
            let y = chart.map((self.window.x.0, *at)).1;
            pencil.line(&[(rect.left, y), (beside, y)], &hair)?;
            pencil.label(
                number,
                (beside - mm(NUMBER_GAP_MM), y),
                Anchor::new(Side::Right, Level::Center),
            );
        }
        self.draw_labels(pencil, rect);
        Ok(())
    }

    fn draw_labels(&self, pencil: &Pencil, rect: Rect) {
        let x = (rect.left + rect.right) / 2.0;
        let y = rect.bottom + self.bottom() - self.x_label.depth();
        pencil.label(
            &self.x_label,
            (x, y),
            Anchor::new(Side::Middle, Level::Base),
        );
        let x = rect.left - self.left() + self.y_label.height();
        let y = (rect.top + rect.bottom) / 2.0;
        pencil.label(
            &self.y_label,
            (x, y),
            Anchor::upwards(Side::Middle, Level::Base),
        );
    }
}

/// Named ticks that have no room beside each other: as many as have, their names shortened to it. Numbers stay as they are.
fn crowded(ticks: Vec<(f64, Label)>, axis: &Axis, width: f64) -> Vec<(f64, Label)> {
    if !matches!(axis.ticks, Ticks::Named(_)) {
        return ticks;
    }
    let step = every(ticks.len(), width, mm(NAME_WIDTH_MM));
    let shown = ticks.len().div_ceil(step).max(1);
    let room = width / shown as f64 - mm(NAME_GAP_MM);
    let shorter = |(at, label): (f64, Label)| (at, label.within_width(room));
    ticks.into_iter().step_by(step).map(shorter).collect()
}

/// Ticks beside a panel: of named ones as many as have room above each other, with names that leave the panel some width.
fn beside(ticks: Vec<(f64, Label)>, axis: &Axis, size: (f64, f64)) -> Vec<(f64, Label)> {
    if !matches!(axis.ticks, Ticks::Named(_)) {
        return ticks;
    }
    let step = every(ticks.len(), size.1, mm(NAME_PITCH_MM));
    let narrow = |(at, label): (f64, Label)| (at, label.within_width(WIDEST_NAME * size.0));
    ticks.into_iter().step_by(step).map(narrow).collect()
}

/// One of how many ticks keeps its name, where each name takes `pitch` of `length`.
fn every(count: usize, length: f64, pitch: f64) -> usize {
    let room = (length / pitch).floor().max(1.0) as usize;
    count.div_ceil(room).max(1)
}

fn widest(ticks: &[(f64, Label)]) -> f64 {
    ticks
        .iter()
        .map(|(_, label)| label.width)
        .fold(0.0, f64::max)
}
