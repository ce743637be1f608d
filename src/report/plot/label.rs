//! A line of text with subscripts, superscripts and variables, measured exactly and drawn as outlines.

use super::glyphs::{CAP_HEIGHT, Placed, Style, UNITS_PER_EM, shape};
use super::style::SCRIPT_SCALE;
use super::units::pt;
use crate::markup::{self, Piece, Script};

/// Drop of subscripts below the base line, in ems.
const SUB_DROP: f64 = 0.2;
/// Rise of superscripts above the base line, in ems.
const SUPER_RISE: f64 = 0.38;
/// Depth of letters such as g, in ems.
const DEPTH: f64 = 0.2;

/// Horizontal alignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Text begins here.
    Left,
    /// Text is centred here.
    Middle,
    /// Text ends here.
    Right,
}

/// Vertical alignment, by the height of capitals and digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Top of capitals.
    Top,
    /// Half the height of capitals.
    Center,
    /// Base line.
    Base,
}

/// Which point of a label stands at the given place, and in which direction it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Anchor {
    /// Along the text.
    pub side: Side,
    /// Across the text.
    pub level: Level,
    /// Read from bottom to top.
    pub upwards: bool,
}

impl Anchor {
    /// Horizontal text.
    pub fn new(side: Side, level: Level) -> Anchor {
        Anchor {
            side,
            level,
            upwards: false,
        }
    }

    /// Text read from bottom to top.
    pub fn upwards(side: Side, level: Level) -> Anchor {
        Anchor {
            side,
            level,
            upwards: true,
        }
    }
}

/// Glyphs of one face and size.
#[derive(Clone)]
pub struct Run {
    /// Face.
    pub style: Style,
    /// Size of the em in canvas units.
    pub size: f64,
    /// Beginning, from the beginning of the label.
    pub x: f64,
    /// Height above the base line.
    pub rise: f64,
    /// Glyphs in font units.
    pub glyphs: Vec<Placed>,
}

/// A measured line of text.
#[derive(Clone)]
pub struct Label {
    /// Its runs from left to right.
    pub runs: Vec<Run>,
    /// Its width in canvas units.
    pub width: f64,
    /// The text without styles.
    pub plain: String,
    size_pt: f64,
    style: Style,
    pieces: Vec<Piece>,
}

impl Label {
    /// Shapes and measures markup at a size in points.
    pub fn new(markup: &str, size_pt: f64) -> Label {
        Label::styled(markup, size_pt, Style::Regular)
    }

    /// The same in bold.
    pub fn bold(markup: &str, size_pt: f64) -> Label {
        Label::styled(markup, size_pt, Style::Bold)
    }

    /// [`Label::new`], no wider than `width` (canvas units).
    pub fn within(markup: &str, size_pt: f64, width: f64) -> Label {
        Label::new(markup, size_pt).within_width(width)
    }

    /// The same, no wider than `width`: the middle of a longer text gives way to an ellipsis, because the names of a laboratory differ at
    /// their ends. Screen readers have the whole text.
    pub fn within_width(self, width: f64) -> Label {
        let count: usize = self.pieces.iter().map(|p| p.text.chars().count()).sum();
        if self.width <= width || count < 2 {
            return self;
        }
        // The first guess is by the mean width of a letter; each further one leaves out one letter more.
        let guess = (count as f64 * width / self.width).ceil().max(0.0) as usize;
        let shortened = |kept: usize| {
            let pieces = markup::without_middle(&self.pieces, kept);
            Label::of_pieces(pieces, self.plain.clone(), self.size_pt, self.style)
        };
        (1..=guess.min(count - 1))
            .rev()
            .map(shortened)
            .find(|label| label.width <= width)
            .unwrap_or_else(|| shortened(1))
    }

    fn styled(markup: &str, size_pt: f64, style: Style) -> Label {
        let pieces = markup::parse(markup);
        Label::of_pieces(pieces, markup::plain(markup), size_pt, style)
    }

    fn of_pieces(pieces: Vec<Piece>, plain: String, size_pt: f64, style: Style) -> Label {
        let mut label = Label {
            runs: Vec::new(),
            width: 0.0,
            plain,
            size_pt,
            style,
            pieces: Vec::new(),
        };
        let mut after_script = 0.0;
        for (i, piece) in pieces.iter().enumerate() {
            let start = label.width;
            label.push(piece, style);
            let next = pieces.get(i + 1).map(|p| p.script);
            let stacked = matches!(
                (piece.script, next),
                (Script::Sub, Some(Script::Super)) | (Script::Super, Some(Script::Sub))
            );
            if stacked {
                after_script = label.width;
                label.width = start;
            } else {
                label.width = label.width.max(after_script);
            }
        }
        label.pieces = pieces;
        label
    }

    fn push(&mut self, piece: &Piece, style: Style) {
        let em = pt(self.size_pt);
        let (size, rise) = match piece.script {
            Script::Base => (em, 0.0),
            Script::Sub => (em * SCRIPT_SCALE, -SUB_DROP * em),
            Script::Super => (em * SCRIPT_SCALE, SUPER_RISE * em),
        };
        let style = if piece.italic { Style::Italic } else { style };
        let (glyphs, advance) = shape(style, &piece.text);
        self.runs.push(Run {
            style,
            size,
            x: self.width,
            rise,
            glyphs,
        });
        self.width += f64::from(advance) * size / UNITS_PER_EM;
    }

    /// Height of capitals in canvas units.
    pub fn height(&self) -> f64 {
        pt(self.size_pt) * CAP_HEIGHT
    }

    /// Room below the base line in canvas units.
    pub fn depth(&self) -> f64 {
        pt(self.size_pt) * DEPTH
    }

    /// The smallest letters in points.
    pub fn smallest_pt(&self) -> f64 {
        let smallest = self
            .runs
            .iter()
            .map(|r| r.size)
            .fold(pt(self.size_pt), f64::min);
        (smallest / pt(1.0) * 100.0).round() / 100.0
    }

    /// Where the label's base line begins relative to its anchor, along and across the text.
    pub fn offset(&self, anchor: Anchor) -> (f64, f64) {
        let along = match anchor.side {
            Side::Left => 0.0,
            Side::Middle => -self.width / 2.0,
            Side::Right => -self.width,
        };
        let across = match anchor.level {
            Level::Top => self.height(),
            Level::Center => self.height() / 2.0,
            Level::Base => 0.0,
        };
        (along, across)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_are_smaller_lower_and_never_below_five_points() {
        let label = Label::new("F_{620} (N)", 7.0);
        let sub = &label.runs[1];
        assert!(sub.size < label.runs[0].size && sub.rise < 0.0);
        assert!(label.smallest_pt() >= 5.0);
        assert_eq!(label.plain, "F_620 (N)");
    }

    #[test]
    fn both_scripts_of_a_letter_stand_above_each_other() {
        let label = Label::new("F_{a}^{b}", 8.0);
        assert_eq!(label.runs[1].x, label.runs[2].x);
    }

    #[test]
    fn a_label_that_is_too_wide_loses_its_middle_and_keeps_its_words_for_screen_readers() {
        let long = format!("l_{{rest}} of {}end", "specimen ".repeat(20));
        let whole = Label::new(&long, 7.0);
        for width in [500.0, 1000.0, 4000.0] {
            let label = Label::within(&long, 7.0, width);
            assert!(label.width <= width, "{} > {width}", label.width);
            assert!(label.width > width - 300.0, "{} of {width}", label.width);
            assert_eq!(label.plain, whole.plain);
        }
        assert_eq!(
            Label::within("short", 7.0, 1000.0).width,
            Label::new("short", 7.0).width
        );
        assert!(Label::within(&long, 7.0, 1.0).width > 0.0);
    }

    #[test]
    fn anchors_move_the_beginning() {
        let label = Label::new("100", 7.0);
        let (dx, dy) = label.offset(Anchor::new(Side::Right, Level::Center));
        assert_eq!(dx, -label.width);
        assert!(dy > 0.0);
    }
}
