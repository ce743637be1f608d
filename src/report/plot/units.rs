//! Lengths of the printed page. The canvas counts in hundredths of a millimetre, which is finer than any press.

/// Canvas units in a millimetre.
pub const PER_MM: f64 = 100.0;
/// Canvas units in a point (1/72 inch).
pub const PER_PT: f64 = 2540.0 / 72.0;

/// Millimetres as canvas units.
pub fn mm(length: f64) -> f64 {
    length * PER_MM
}

/// Points as canvas units.
pub fn pt(length: f64) -> f64 {
    length * PER_PT
}

/// The nearest whole canvas unit.
pub fn snap(length: f64) -> i32 {
    length.round() as i32
}

/// A rectangle on the canvas, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

impl Rect {
    /// From the upper left corner and a size.
    pub fn sized(left: f64, top: f64, width: f64, height: f64) -> Rect {
        Rect {
            left,
            top,
            right: left + width,
            bottom: top + height,
        }
    }

    /// Horizontal extent.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Vertical extent.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// The same rectangle, larger by `margin` on all sides.
    pub fn wider(&self, margin: f64) -> Rect {
        Rect {
            left: self.left - margin,
            top: self.top - margin,
            right: self.right + margin,
            bottom: self.bottom + margin,
        }
    }

    /// Whether a point lies inside or nearer than `margin`.
    pub fn near(&self, (x, y): (f64, f64), margin: f64) -> bool {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.wider(margin);
        (left..=right).contains(&x) && (top..=bottom).contains(&y)
    }
}
