//! plotters' elements on our paper: the primitives that they draw with, as compact paths.
//!
//! plotters' own SVG backend knows neither millimetres nor dashes, groups, glyph outlines or shared marks, and takes some hundred
//! bytes for each point.

use super::paper::{Paper, hex};
use super::path::PathData;
use super::style::Dash;
use plotters::prelude::DrawingBackend;
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingErrorKind};
use std::convert::Infallible;
use std::fmt::Write;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl Paper {
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
        let mut paint = format!(
            " fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"",
            hex(color)
        );
        if color.alpha < 1.0 {
            let _ = write!(paint, " stroke-opacity=\"{}\"", color.alpha);
        }
        if self.dash != Dash::Solid {
            let pattern: Vec<String> = self.dash.pattern().iter().map(u32::to_string).collect();
            let _ = write!(paint, " stroke-dasharray=\"{}\"", pattern.join(" "));
        }
        paint
    }
}

fn fill(color: BackendColor) -> String {
    if color.alpha < 1.0 {
        format!(" fill=\"{}\" fill-opacity=\"{}\"", hex(color), color.alpha)
    } else {
        format!(" fill=\"{}\"", hex(color))
    }
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

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
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

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let paint = self.stroke(style.color(), style.stroke_width());
        self.path(path, false, &paint);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        vert: I,
        style: &S,
    ) -> Drawn {
        self.path(vert, true, &fill(style.color()));
        Ok(())
    }
}
