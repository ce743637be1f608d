//! What is drawn inside a panel, from the back to the front.

use super::label::{Anchor, Level, Side};
use super::style::{Dash, Ink, Mark, Stroke};

/// A series of points, with a line, marks, error bars, or any of them together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend, in markup; empty for none.
    pub name: String,
    /// Points in data units; a point that is not finite parts the line.
    pub points: Vec<(f64, f64)>,
    /// Line through the points in their order.
    pub line: Option<Stroke>,
    /// Mark at each point.
    pub mark: Option<Mark>,
    /// Vertical error bars: ends in data units, one pair a point.
    pub y_errors: Vec<(f64, f64)>,
    /// Horizontal error bars: ends in data units, one pair a point.
    pub x_errors: Vec<(f64, f64)>,
}

impl Series {
    /// A line.
    pub fn line(name: &str, points: Vec<(f64, f64)>, stroke: Stroke) -> Series {
        Series {
            name: name.into(),
            points,
            line: Some(stroke),
            mark: None,
            y_errors: Vec::new(),
            x_errors: Vec::new(),
        }
    }

    /// Marks.
    pub fn marks(name: &str, points: Vec<(f64, f64)>, mark: Mark) -> Series {
        Series {
            line: None,
            mark: Some(mark),
            ..Series::line(name, points, Stroke::new(mark.ink, Dash::Solid))
        }
    }

    /// The same series with marks at its points.
    pub fn with_marks(mut self, mark: Mark) -> Series {
        self.mark = Some(mark);
        self
    }

    /// The same series with vertical error bars, given by their ends.
    pub fn with_y_errors(mut self, ends: Vec<(f64, f64)>) -> Series {
        self.y_errors = ends;
        self
    }

    /// The same series with horizontal error bars, given by their ends.
    pub fn with_x_errors(mut self, ends: Vec<(f64, f64)>) -> Series {
        self.x_errors = ends;
        self
    }
}

/// Where an annotation stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At a point in data units.
    Data(f64, f64),
    /// At a share of the plot's width from the left and of its height from below.
    Plot(f64, f64),
}

/// Something drawn in a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Layer {
    /// Points, lines, error bars.
    Series(Series),
    /// The area between two curves, such as a confidence band.
    Band {
        /// Name in the legend; empty for none.
        name: String,
        /// `x`, lower and upper value, by rising `x`.
        points: Vec<(f64, f64, f64)>,
        /// Colour.
        ink: Ink,
        /// Opacity of the area, 0 to 1.
        opacity: f64,
    },
    /// Ranges of `x` shaded over the full height, such as plateaus of a time series.
    Windows {
        /// Name in the legend; empty for none.
        name: String,
        /// Beginning and end of each.
        spans: Vec<(f64, f64)>,
        /// Colour.
        ink: Ink,
    },
    /// Thin vertical lines over the full height, such as steps of a set point.
    Steps {
        /// Name in the legend; empty for none.
        name: String,
        /// Their places.
        at: Vec<f64>,
        /// Look.
        stroke: Stroke,
    },
    /// A thin horizontal line over the full width, such as zero.
    Level {
        /// Name in the legend; empty for none.
        name: String,
        /// Its value.
        at: f64,
        /// Look.
        stroke: Stroke,
    },
    /// The line on which `y` equals `x`.
    Identity {
        /// Name in the legend; empty for none.
        name: String,
    },
    /// A line of text.
    Text {
        /// The text, in markup.
        text: String,
        /// Where it stands.
        place: Place,
        /// Which of its points stands there.
        anchor: Anchor,
    },
}

/// Opacity of a band.
const BAND_OPACITY: f64 = 0.25;
/// Opacity of a part of a bar: colours stay apart, black numbers stay legible.
const PART_OPACITY: f64 = 0.6;

impl Layer {
    /// A band, through which what lies under it shows.
    pub fn band(name: &str, points: Vec<(f64, f64, f64)>, ink: Ink) -> Layer {
        Layer::Band {
            name: name.into(),
            points,
            ink,
            opacity: BAND_OPACITY,
        }
    }

    /// An area that is told from others by its colour: a part of a bar.
    pub fn part(name: &str, points: Vec<(f64, f64, f64)>, ink: Ink) -> Layer {
        Layer::Band {
            name: name.into(),
            points,
            ink,
            opacity: PART_OPACITY,
        }
    }

    /// Shaded windows.
    pub fn windows(name: &str, spans: Vec<(f64, f64)>) -> Layer {
        Layer::Windows {
            name: name.into(),
            spans,
            ink: Ink::Sky,
        }
    }

    /// Step marks.
    pub fn steps(name: &str, at: Vec<f64>) -> Layer {
        Layer::Steps {
            name: name.into(),
            at,
            stroke: Stroke::hair(Ink::Grey, Dash::Dotted),
        }
    }

    /// The zero line.
    pub fn zero() -> Layer {
        Layer::Level {
            name: String::new(),
            at: 0.0,
            stroke: Stroke::hair(Ink::Grey, Dash::Solid),
        }
    }

    /// The line `y = x`.
    pub fn identity(name: &str) -> Layer {
        Layer::Identity { name: name.into() }
    }

    /// Text that begins at a place.
    pub fn text(text: &str, place: Place) -> Layer {
        Layer::Text {
            text: text.into(),
            place,
            anchor: Anchor::new(Side::Left, Level::Center),
        }
    }

    /// Smallest and largest `x` and `y`, of what should be visible in full.
    pub fn extent(&self) -> Option<[(f64, f64); 2]> {
        match self {
            Layer::Series(series) => {
                let ends = series.points.iter().zip(&series.y_errors);
                let bars = ends.flat_map(|((x, _), (low, high))| [(*x, *low), (*x, *high)]);
                let sides = series.points.iter().zip(&series.x_errors);
                let sides = sides.flat_map(|((_, y), (low, high))| [(*low, *y), (*high, *y)]);
                bounds(series.points.iter().copied().chain(bars).chain(sides))
            }
            Layer::Band { points, .. } => bounds(
                points
                    .iter()
                    .flat_map(|(x, low, high)| [(*x, *low), (*x, *high)]),
            ),
            _ => None,
        }
    }
}

impl From<Series> for Layer {
    fn from(series: Series) -> Layer {
        Layer::Series(series)
    }
}

/// The bounding box of the finite points.
fn bounds(points: impl Iterator<Item = (f64, f64)>) -> Option<[(f64, f64); 2]> {
    points
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .map(|(x, y)| [(x, x), (y, y)])
        .reduce(union)
}

/// The smallest box around two.
pub fn union(a: [(f64, f64); 2], b: [(f64, f64); 2]) -> [(f64, f64); 2] {
    [0, 1].map(|i| (a[i].0.min(b[i].0), a[i].1.max(b[i].1)))
}
