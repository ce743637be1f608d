//! A panel: two axes, layers and a legend; measured first, drawn when its place is known.

use super::axis::Axis;
use super::chart::Chart;
use super::clip::Window;
use super::frame::Frame;
use super::layer::{Layer, union};
use super::legend::{Key, Legend, rows_within};
use super::obstacles::{emptiest_spot, free_spot};
use super::pencil::Pencil;
use super::units::{Rect, mm};
use pipeline_base::error::Result;

/// Room between a panel and the legend beside it, in millimetres.
const LEGEND_GAP_MM: f64 = 1.2;
/// How much of a panel's height the legend above it may take.
const LEGEND_SHARE: f64 = 0.4;

/// A panel of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Layers from back to front.
    pub layers: Vec<Layer>,
    /// Where the legend stands.
    pub legend: Legend,
    /// A short heading above the plot, in markup; empty for none.
    pub title: String,
    /// Both axes cover the same range.
    pub same_range: bool,
}

impl Panel {
    /// An empty panel.
    pub fn new(x: Axis, y: Axis) -> Panel {
        Panel {
            x,
            y,
            layers: Vec::new(),
            legend: Legend::Auto,
            title: String::new(),
            same_range: false,
        }
    }

    /// The same panel with one layer more, in front of the others.
    pub fn with(mut self, layer: impl Into<Layer>) -> Panel {
        self.layers.push(layer.into());
        self
    }

    /// The same panel with its legend elsewhere.
    pub fn legend(mut self, legend: Legend) -> Panel {
        self.legend = legend;
        self
    }

    /// The same panel with a heading.
    pub fn title(mut self, title: &str) -> Panel {
        self.title = title.into();
        self
    }

    /// The same panel with the same range on both axes, for measured against predicted values.
    pub fn same_range(mut self) -> Panel {
        self.same_range = true;
        self
    }
}

/// A panel with its ranges, ticks and margins.
pub struct Plan<'a> {
    panel: &'a Panel,
    letter: String,
    frame: Frame,
    key: Key,
    legend: Legend,
}

impl<'a> Plan<'a> {
    /// Measures a panel that will be about as large as `size`; `letter` is its label, empty for none; a panel whose figure has one
    /// legend for all gets none of its own.
    pub fn new(panel: &'a Panel, letter: String, size: (f64, f64), own_legend: bool) -> Plan<'a> {
        let steps = Frame::steps(size);
        let extent = panel.layers.iter().filter_map(Layer::extent).reduce(union);
        let mut window = Window {
            x: panel.x.range(extent.map(|e| e[0]), steps.0),
            y: panel.y.range(extent.map(|e| e[1]), steps.1),
        };
        if panel.same_range {
            let all = (window.x.0.min(window.y.0), window.x.1.max(window.y.1));
            window = Window { x: all, y: all };
        }
        let mut key = Key::new(&panel.layers, rows_within(LEGEND_SHARE * size.1));
        if panel.legend == Legend::Beside {
            key = key.block_of(rows_within(size.1));
        }
        let legend = if key.is_empty() || !own_legend {
            Legend::None
        } else {
            panel.legend
        };
        Plan {
            frame: Frame::new(panel, window, size),
            panel,
            letter,
            key,
            legend,
        }
    }

    /// Room needed left of the plot rectangle.
    pub fn left(&self) -> f64 {
        self.frame.left()
    }

    /// Room needed below the plot rectangle.
    pub fn bottom(&self) -> f64 {
        self.frame.bottom()
    }

    /// Room needed right of the plot rectangle.
    pub fn right(&self) -> f64 {
        match self.legend {
            Legend::Beside => self.frame.right() + self.key.block().0 + mm(LEGEND_GAP_MM),
            _ => self.frame.right(),
        }
    }

    /// Room needed above a plot rectangle so wide.
    pub fn top(&self, width: f64) -> f64 {
        let rows = match self.legend {
            Legend::Above => self.key.rows_room(width),
            _ => 0.0,
        };
        self.frame.top(&self.letter, rows)
    }

    /// Moves the legend above the panel if there is no room inside; says whether it moved.
    pub fn settle_legend(&mut self, pencil: &Pencil, rect: Rect) -> bool {
        let chart = Chart::new(pencil, rect, self.frame.window);
        let moves = self.legend == Legend::Auto
            && free_spot(&chart, &self.panel.layers, self.key.block()).is_none();
        if moves {
            self.legend = Legend::Above;
        }
        moves
    }

    /// Draws the panel around its plot rectangle, its letter below `above`.
    pub fn draw(&self, pencil: &Pencil, rect: Rect, above: f64) -> Result<()> {
        let chart = Chart::new(pencil, rect, self.frame.window);
        self.panel
            .layers
            .iter()
            .try_for_each(|layer| chart.draw(layer))?;
        self.frame.draw(pencil, &chart)?;
        self.frame.draw_heading(pencil, &self.letter, (rect, above));
        match self.legend {
            Legend::None => Ok(()),
            Legend::Above => {
                let top = rect.top - self.key.rows_room(rect.width());
                self.key.draw_rows(pencil, (rect.left, top), rect.width())
            }
            Legend::Beside => {
                let left = rect.right + self.frame.right() + mm(LEGEND_GAP_MM);
                self.key.draw_block(pencil, Rect { left, ..rect })
            }
            Legend::Auto => {
                let size = self.key.block();
                let spot = free_spot(&chart, &self.panel.layers, size);
                let spot = spot.unwrap_or_else(|| emptiest_spot(&chart, &self.panel.layers, size));
                self.key.draw_block(pencil, spot)
            }
        }
    }
}
