//! Letters as outlines: shaping with the bundled font's own kerning, and the outline of each glyph as SVG path data.
//!
//! Text is drawn as outlines, as matplotlib does by default, because it is the only form that looks the same in a browser without
//! the font, in Inkscape, in LaTeX, in Typst and in resvg: an embedded `@font-face` is ignored by all but browsers. Each glyph is
//! defined once a file and used by reference, so the price is small, and the words stand in `aria-label` for screen readers.

use crate::fonts;
use rustybuzz::ttf_parser::{GlyphId, OutlineBuilder};
use rustybuzz::{Face, UnicodeBuffer};
use std::fmt::Write;
use std::sync::LazyLock;

/// A face of the figures' family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Style {
    /// Upright.
    Regular,
    /// Bold.
    Bold,
    /// Italic.
    Italic,
}

/// Font units in an em, of all faces of the family.
pub const UNITS_PER_EM: f64 = 2816.0;
/// Height of capitals and digits, in ems.
pub const CAP_HEIGHT: f64 = 0.727;

static FACES: LazyLock<[Face<'static>; 3]> = LazyLock::new(|| {
    [fonts::SANS, fonts::SANS_BOLD, fonts::SANS_ITALIC].map(|bytes| {
        Face::from_slice(bytes, 0).expect("the bundled fonts are whole, as a test assures")
    })
});

fn face(style: Style) -> &'static Face<'static> {
    &FACES[style as usize]
}

/// A glyph and its place from the beginning of its run, in font units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placed {
    /// Number of the glyph in its face.
    pub glyph: u16,
    /// Place of its origin.
    pub x: i32,
}

/// Shapes a run of text: its glyphs and its total advance in font units.
pub fn shape(style: Style, text: &str) -> (Vec<Placed>, i32) {
    let mut buffer = UnicodeBuffer::new();
    buffer.push_str(text);
    buffer.guess_segment_properties();
    let shaped = rustybuzz::shape(face(style), &[], buffer);
    let mut at = 0;
    let mut glyphs = Vec::new();
    for (info, position) in shaped.glyph_infos().iter().zip(shaped.glyph_positions()) {
        glyphs.push(Placed {
            glyph: info.glyph_id as u16,
            x: at + position.x_offset,
        });
        at += position.x_advance;
    }
    (glyphs, at)
}

/// The outline of a glyph as SVG path data in font units, y upwards; `None` for blanks.
pub fn outline(style: Style, glyph: u16) -> Option<String> {
    let mut path = Path(String::new());
    face(style).outline_glyph(GlyphId(glyph), &mut path)?;
    Some(path.0)
}

struct Path(String);

impl Path {
    fn command(&mut self, letter: char, coordinates: &[f32]) {
        self.0.push(letter);
        for (i, c) in coordinates.iter().enumerate() {
            let c = c.round() as i32;
            let gap = if i > 0 && c >= 0 { " " } else { "" };
            let _ = write!(self.0, "{gap}{c}");
        }
    }
}

impl OutlineBuilder for Path {
    fn move_to(&mut self, x: f32, y: f32) {
        self.command('M', &[x, y]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.command('L', &[x, y]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.command('Q', &[x1, y1, x, y]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.command('C', &[x1, y1, x2, y2, x, y]);
    }

    fn close(&mut self) {
        self.0.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_agree_on_their_units_and_know_the_symbols_of_the_field() {
        for style in [Style::Regular, Style::Bold, Style::Italic] {
            assert_eq!(f64::from(face(style).units_per_em()), UNITS_PER_EM);
            for c in "εΔσμα²³−±×·°µ≤≥≈*%…".chars() {
                let (glyphs, _) = shape(style, &c.to_string());
                assert!(glyphs.iter().all(|g| g.glyph != 0), "{c} in {style:?}");
            }
        }
        let capitals = face(Style::Regular).capital_height().unwrap();
        assert!((f64::from(capitals) / UNITS_PER_EM - CAP_HEIGHT).abs() < 0.002);
    }

    #[test]
    fn kerning_draws_letters_together() {
        let width = |text| shape(Style::Regular, text).1;
        assert!(width("AV") < width("A") + width("V"));
    }

    #[test]
    fn blanks_have_no_outline() {
        let space = shape(Style::Regular, " ").0[0].glyph;
        assert_eq!(outline(Style::Regular, space), None);
    }
}
