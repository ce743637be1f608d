//! The paper: an SVG file under way, in hundredths of a millimetre, with named groups, labels as outlines and shared marks.
//! Lines and areas come from plotters' elements through [`super::backend`].

use super::glyphs::{self, Style};
use super::label::{Anchor, Label};
use super::marks;
use super::style::{Dash, Mark};
use super::units::{PER_MM, snap};
use plotters_backend::BackendColor;
use std::collections::BTreeSet;
use std::fmt::Write;

/// A sheet of paper of a given size, drawn upon through plotters or directly.
pub struct Paper {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) dash: Dash,
    pub(super) body: String,
    glyphs: BTreeSet<(Style, u16)>,
    marks: Vec<Mark>,
}

impl Paper {
    /// Blank paper, sizes in canvas units.
    pub fn new(width: f64, height: f64) -> Paper {
        Paper {
            width: snap(width) as u32,
            height: snap(height) as u32,
            dash: Dash::Solid,
            body: String::new(),
            glyphs: BTreeSet::new(),
            marks: Vec::new(),
        }
    }

    /// The pattern of the lines that follow.
    pub fn dash(&mut self, dash: Dash) {
        self.dash = dash;
    }

    /// Opens a group that carries a name for whoever edits the file, closed by [`Paper::end_group`].
    pub fn begin_group(&mut self, name: &str) {
        let _ = writeln!(self.body, "<g id=\"{}\">", escape(name));
    }

    /// Closes the group opened last.
    pub fn end_group(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Draws a label; `anchor` says which of its points stands at `(x, y)`.
    pub fn label(&mut self, label: &Label, (x, y): (f64, f64), anchor: Anchor) {
        let (dx, dy) = label.offset(anchor);
        let (x, y) = if anchor.upwards {
            (x + dy, y - dx)
        } else {
            (x + dx, y + dy)
        };
        let turn = if anchor.upwards { "rotate(-90)" } else { "" };
        let _ = write!(
            self.body,
            "<g aria-label=\"{}\" data-pt=\"{}\" transform=\"translate({} {}){turn}\">",
            escape(&label.plain),
            label.smallest_pt(),
            snap(x),
            snap(y),
        );
        for run in &label.runs {
            let scale = run.size / glyphs::UNITS_PER_EM;
            let _ = write!(
                self.body,
                "<g transform=\"translate({} {})scale({scale:.5} -{scale:.5})\">",
                snap(run.x),
                snap(-run.rise),
            );
            for placed in &run.glyphs {
                self.glyph(run.style, placed);
            }
            self.body.push_str("</g>");
        }
        self.body.push_str("</g>\n");
    }

    fn glyph(&mut self, style: Style, placed: &glyphs::Placed) {
        if glyphs::outline(style, placed.glyph).is_none() {
            return;
        }
        self.glyphs.insert((style, placed.glyph));
        let name = glyph_name(style, placed.glyph);
        let _ = match placed.x {
            0 => write!(self.body, "<use href=\"#{name}\"/>"),
            x => write!(self.body, "<use href=\"#{name}\" x=\"{x}\"/>"),
        };
    }

    /// Draws the same mark at every place.
    pub fn marks(&mut self, mark: Mark, places: &[(i32, i32)]) {
        if marks::is_dot(mark) {
            self.body.push_str(&marks::dots(mark, places));
            return;
        }
        let number = self
            .marks
            .iter()
            .position(|m| *m == mark)
            .unwrap_or_else(|| {
                self.marks.push(mark);
                self.marks.len() - 1
            });
        for (x, y) in places {
            let _ = write!(self.body, "<use href=\"#m{number}\" x=\"{x}\" y=\"{y}\"/>");
        }
        self.body.push('\n');
    }

    /// The finished file.
    pub fn finish(self, title: &str) -> String {
        let (width, height) = (self.width, self.height);
        let (width_mm, height_mm) = (f64::from(width) / PER_MM, f64::from(height) / PER_MM);
        let title = escape(title);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_mm}mm\" height=\"{height_mm}mm\" \
             viewBox=\"0 0 {width} {height}\" stroke-linejoin=\"round\" role=\"img\">\n<title>{title}</title>\n<defs>\n"
        );
        for (style, glyph) in &self.glyphs {
            let outline = glyphs::outline(*style, *glyph).unwrap_or_default();
            let _ = writeln!(
                svg,
                "<path id=\"{}\" d=\"{outline}\"/>",
                glyph_name(*style, *glyph)
            );
        }
        for (number, mark) in self.marks.iter().enumerate() {
            svg.push_str(&marks::definition(*mark, number));
        }
        svg.push_str("</defs>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
        svg.push_str(&self.body);
        svg.push_str("</svg>\n");
        svg
    }
}

fn glyph_name(style: Style, glyph: u16) -> String {
    let family = match style {
        Style::Regular => 'r',
        Style::Bold => 'b',
        Style::Italic => 'i',
    };
    format!("{family}{glyph}")
}

/// A colour as SVG writes it.
pub fn hex(color: BackendColor) -> String {
    let (r, g, b) = color.rgb;
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text that XML shows as it stands. The one place of escapes of this format.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
