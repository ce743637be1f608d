//! Marks at data points: each kind defined once a file, then used by reference; dots as strokes of a single path.

use super::paper::hex;
use super::path::PathData;
use super::style::{Ink, Mark, OUTLINE_PT, Shape};
use super::units::pt;
use plotters::style::Color;

/// Whether the mark is drawn as a stroke with round ends rather than by reference.
pub fn is_dot(mark: Mark) -> bool {
    mark.shape == Shape::Dot
}

/// All dots of a cloud as one element.
pub fn dots(mark: Mark, places: &[(i32, i32)]) -> String {
    let mut path = PathData::default();
    for place in places {
        path.dot(*place);
    }
    format!(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" stroke-opacity=\"0.6\"/>\n",
        path.text(),
        colour(mark.ink),
        2 * mark.radius
    )
}

/// The definition of the mark with number `number`, centred at the origin.
pub fn definition(mark: Mark, number: usize) -> String {
    let ink = colour(mark.ink);
    let stroked = matches!(mark.shape, Shape::Plus | Shape::Cross);
    let fill = match (stroked, mark.filled) {
        (true, _) => "none".to_string(),
        (false, true) => ink.clone(),
        (false, false) => colour(Ink::White),
    };
    let width = pt(if stroked { 0.9 } else { OUTLINE_PT }).ceil();
    format!(
        "<path id=\"m{number}\" d=\"{}\" fill=\"{fill}\" stroke=\"{ink}\" stroke-width=\"{width}\"/>\n",
        path(mark)
    )
}

fn colour(ink: Ink) -> String {
    hex(ink.rgb().to_backend_color())
}

/// Path data about the origin; shapes are scaled so that all cover about the same area as the circle.
fn path(mark: Mark) -> String {
    let r = f64::from(mark.radius);
    match mark.shape {
        Shape::Circle | Shape::Dot => {
            let (r, d) = (mark.radius, 2 * mark.radius);
            format!("M-{r} 0a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0-{d} 0z")
        }
        Shape::Square => closed(
            r * 0.89,
            &[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)],
        ),
        Shape::Diamond => closed(
            r * 1.22,
            &[(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)],
        ),
        Shape::Triangle => closed(r * 1.25, &[(0.0, -1.0), (0.95, 0.65), (-0.95, 0.65)]),
        Shape::Wedge => closed(r * 1.25, &[(0.0, 1.0), (0.95, -0.65), (-0.95, -0.65)]),
        Shape::Plus => strokes(
            r * 1.1,
            &[[(-1.0, 0.0), (1.0, 0.0)], [(0.0, -1.0), (0.0, 1.0)]],
        ),
        Shape::Cross => strokes(
            r * 0.85,
            &[[(-1.0, -1.0), (1.0, 1.0)], [(-1.0, 1.0), (1.0, -1.0)]],
        ),
    }
}

/// A point of a mark of size one.
type Point = (f64, f64);

fn scaled(size: f64, (x, y): Point) -> (i32, i32) {
    ((x * size).round() as i32, (y * size).round() as i32)
}

fn closed(size: f64, corners: &[Point]) -> String {
    let mut path = PathData::default();
    for corner in corners {
        path.to(scaled(size, *corner));
    }
    path.close();
    path.text().to_string()
}

fn strokes(size: f64, lines: &[[Point; 2]]) -> String {
    let stroke = |[from, to]: &[Point; 2]| {
        let mut path = PathData::default();
        path.to(scaled(size, *from));
        path.to(scaled(size, *to));
        path.text().to_string()
    };
    lines.iter().map(stroke).collect()
}
