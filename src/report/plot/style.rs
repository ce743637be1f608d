//! Colours that the colour blind tell apart (Okabe and Ito 2008), marks, dashes, and the sizes of journal figures.

use super::units::{mm, pt};
use plotters::style::{RGBAColor, RGBColor};

/// Size of tick labels, legends and annotations in points; subscripts are 5.04 pt.
pub const SMALL_PT: f64 = 7.0;
/// Size of axis labels in points.
pub const LABEL_PT: f64 = 8.0;
/// Size of panel labels in points.
pub const PANEL_PT: f64 = 9.0;
/// Size of sub- and superscripts relative to their text.
pub const SCRIPT_SCALE: f64 = 0.72;
/// Width of axes, ticks and helper lines in points.
pub const HAIR_PT: f64 = 0.5;
/// Width of data lines in points.
pub const LINE_PT: f64 = 1.0;
/// Width of the outline of marks and of error bars in points.
pub const OUTLINE_PT: f64 = 0.6;

/// A colour of the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ink {
    /// Black.
    Black,
    /// Blue.
    Blue,
    /// Vermilion.
    Vermilion,
    /// Bluish green.
    Green,
    /// Reddish purple.
    Purple,
    /// Orange.
    Orange,
    /// Sky blue.
    Sky,
    /// Grey, for what is beside the point.
    Grey,
    /// Paper.
    White,
}

impl Ink {
    /// Red, green and blue.
    pub fn rgb(self) -> RGBColor {
        match self {
            Ink::Black => RGBColor(0, 0, 0),
            Ink::Blue => RGBColor(0, 114, 178),
            Ink::Vermilion => RGBColor(213, 94, 0),
            Ink::Green => RGBColor(0, 158, 115),
            Ink::Purple => RGBColor(204, 121, 167),
            Ink::Orange => RGBColor(230, 159, 0),
            Ink::Sky => RGBColor(86, 180, 233),
            Ink::Grey => RGBColor(128, 128, 128),
            Ink::White => RGBColor(255, 255, 255),
        }
    }

    /// With an opacity between 0 and 1.
    pub fn tint(self, opacity: f64) -> RGBAColor {
        let RGBColor(r, g, b) = self.rgb();
        RGBAColor(r, g, b, opacity)
    }
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dash, dot.
    DashDot,
    /// Long dashes.
    Long,
    /// Dash, dot, dot.
    DashDotDot,
    /// Long dash, dot.
    LongDot,
    /// Long dash, short dash.
    LongShort,
    /// Close short dashes.
    Short,
}

impl Dash {
    /// Lengths of strokes and gaps in canvas units; empty for a solid line.
    pub fn pattern(self) -> &'static [u32] {
        match self {
            Dash::Solid => &[],
            Dash::Dashed => &[120, 70],
            Dash::Dotted => &[35, 55],
            Dash::DashDot => &[130, 55, 35, 55],
            Dash::Long => &[230, 80],
            Dash::DashDotDot => &[130, 55, 35, 55, 35, 55],
            Dash::LongDot => &[230, 60, 35, 60],
            Dash::LongShort => &[230, 60, 80, 60],
            Dash::Short => &[65, 45],
        }
    }
}

/// The outline of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// Circle.
    Circle,
    /// Square.
    Square,
    /// Triangle on its base.
    Triangle,
    /// Diamond.
    Diamond,
    /// Triangle on its tip.
    Wedge,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
    /// A small dot: for clouds of thousands of points, which take few bytes and no outline.
    Dot,
}

/// A mark at a data point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Mark {
    /// Outline.
    pub shape: Shape,
    /// Filled with its colour, else with paper.
    pub filled: bool,
    /// Colour.
    pub ink: Ink,
    /// Half its width in canvas units.
    pub radius: u32,
}

impl Mark {
    /// A filled mark of the usual size: 1.5 mm, dots 0.5 mm.
    pub fn filled(shape: Shape, ink: Ink) -> Mark {
        let width = if shape == Shape::Dot { 0.5 } else { 1.5 };
        Mark {
            shape,
            filled: true,
            ink,
            radius: (mm(width) / 2.0) as u32,
        }
    }

    /// An open mark of the usual size.
    pub fn open(shape: Shape, ink: Ink) -> Mark {
        Mark {
            filled: false,
            ..Mark::filled(shape, ink)
        }
    }

    /// The mark that stands for this one in a legend: dots as discs that can be seen.
    pub fn in_legend(self) -> Mark {
        match self.shape {
            Shape::Dot => Mark::filled(Shape::Circle, self.ink).wide(1.0),
            _ => self,
        }
    }

    /// The same mark, so many millimetres wide.
    pub fn wide(mut self, width_mm: f64) -> Mark {
        self.radius = (mm(width_mm) / 2.0) as u32;
        self
    }
}

/// A line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub ink: Ink,
    /// Pattern.
    pub dash: Dash,
    /// Width in points.
    pub width_pt: f64,
}

impl Stroke {
    /// A line of the usual width.
    pub fn new(ink: Ink, dash: Dash) -> Stroke {
        Stroke {
            ink,
            dash,
            width_pt: LINE_PT,
        }
    }

    /// A hair line.
    pub fn hair(ink: Ink, dash: Dash) -> Stroke {
        Stroke {
            width_pt: HAIR_PT,
            ..Stroke::new(ink, dash)
        }
    }

    /// Width in canvas units; never below half a point.
    pub fn width(&self) -> u32 {
        pt(self.width_pt.max(HAIR_PT)).ceil() as u32
    }
}

/// Colour, mark and dash of the n-th of several series: distinct in each of the three, so that none depends on colour alone.
pub fn look(n: usize) -> (Ink, Shape, Dash) {
    const LOOKS: [(Ink, Shape, Dash); 7] = [
        (Ink::Blue, Shape::Circle, Dash::Solid),
        (Ink::Vermilion, Shape::Square, Dash::Dashed),
        (Ink::Green, Shape::Triangle, Dash::DashDot),
        (Ink::Purple, Shape::Diamond, Dash::Long),
        (Ink::Orange, Shape::Wedge, Dash::Dotted),
        (Ink::Black, Shape::Plus, Dash::Solid),
        (Ink::Sky, Shape::Cross, Dash::Dashed),
    ];
    LOOKS[n % LOOKS.len()]
}
