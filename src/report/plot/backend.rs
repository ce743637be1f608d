//! The paper: a plotters backend that writes compact SVG in hundredths of a millimetre.
//!
//! plotters' own SVG backend knows neither millimetres nor dashes, groups, glyph outlines or shared marks, and takes some hundred
//! bytes for each point. This one offers all of that beside the primitives that plotters' elements draw with.

use super::glyphs::{self, Style};
use super::label::{Anchor, Label};
use super::path::PathData;
use super::style::{Dash, Mark};
use super::units::{PER_MM, snap};
use super::marks;
use plotters::prelude::DrawingBackend;
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingErrorKind};
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::fmt::Write;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// A sheet of paper of a given size, drawn upon through plotters or directly.
pub struct Paper {
    width: u32,
    height: u32,
    dash: Dash,
    body: String,
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
        let (x, y) = if anchor.upwards { (x + dy, y - dx) } else { (x + dx, y + dy) };
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
        let number = self.marks.iter().position(|m| *m == mark).unwrap_or_else(|| {
            self.marks.push(mark);
            self.marks.len() - 1
        });
        for (x, y) in places {
            let _ = write!(self.body, "<use href=\"#m{number}\" x=\"{x}\" y=\"{y}\"/>");
        }
        self.body.push('\n');
    }

    fn path(&mut self, points: impl IntoIterator<Item = BackendCoord>, closed: bool, paint: &str) {
        let mut path = PathData::default();
        for point in points {
            path.to(point);
        }
        if closed {
            path.close();
        }
        let _ = writeln!(self.body, "<path d=\"{}\"{paint}/>", path.text());
    }

    fn stroke(&self, color: BackendColor, width: u32) -> String {
        let mut paint = format!(" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"", hex(color));
        if color.alpha < 1.0 {
            let _ = write!(paint, " stroke-opacity=\"{}\"", color.alpha);
        }
        if self.dash != Dash::Solid {
            let pattern: Vec<String> = self.dash.pattern().iter().map(u32::to_string).collect();
            let _ = write!(paint, " stroke-dasharray=\"{}\"", pattern.join(" "));
        }
        paint
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
            let _ = writeln!(svg, "<path id=\"{}\" d=\"{outline}\"/>", glyph_name(*style, *glyph));
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

fn fill(color: BackendColor) -> String {
    if color.alpha < 1.0 {
        format!(" fill=\"{}\" fill-opacity=\"{}\"", hex(color), color.alpha)
    } else {
        format!(" fill=\"{}\"", hex(color))
    }
}

/// Text that XML shows as it stands. The one place of escapes of this format.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

impl DrawingBackend for Paper {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        self.draw_rect((x, y), (x + 1, y + 1), &color, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        filled: bool,
    ) -> Drawn {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        let paint = if filled {
            fill(style.color())
        } else {
            self.stroke(style.color(), style.stroke_width())
        };
        self.path(corners, true, &paint);
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        let paint = self.stroke(style.color(), style.stroke_width());
        self.path(path, false, &paint);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, vert: I, style: &S) -> Drawn {
        self.path(vert, true, &fill(style.color()));
        Ok(())
    }
}
