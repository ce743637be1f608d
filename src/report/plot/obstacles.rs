//! What a legend must not cover, and where inside a panel there is room for it.

use super::chart::Chart;
use super::label::Label;
use super::layer::{Layer, Place};
use super::style::SMALL_PT;
use super::units::{Rect, mm};

/// Distance between the places at which curves are sampled, in millimetres.
const GRAIN_MM: f64 = 0.5;
/// Room that is left around a legend, in millimetres.
const MARGIN_MM: f64 = 1.0;

/// The first free corner or edge for a box of the given size, else `None`.
pub fn free_spot(chart: &Chart, layers: &[Layer], size: (f64, f64)) -> Option<Rect> {
    let covered = covered(chart, layers);
    candidates(chart.rect, size)
        .into_iter()
        .find(|r| r.left >= chart.rect.left && r.top >= chart.rect.top && is_free(r, &covered))
}

/// The corner or edge that covers least.
pub fn emptiest_spot(chart: &Chart, layers: &[Layer], size: (f64, f64)) -> Rect {
    let covered = covered(chart, layers);
    let count = |r: &Rect| {
        covered
            .iter()
            .filter(|p| r.near(**p, mm(MARGIN_MM)))
            .count()
    };
    let spots = candidates(chart.rect, size);
    spots.into_iter().min_by_key(count).unwrap_or(chart.rect)
}

fn is_free(rect: &Rect, covered: &[(f64, f64)]) -> bool {
    !covered.iter().any(|p| rect.near(*p, mm(MARGIN_MM)))
}

/// Corners first, then the middles of the edges.
fn candidates(plot: Rect, (width, height): (f64, f64)) -> Vec<Rect> {
    let inset = mm(MARGIN_MM);
    let left = plot.left + inset;
    let right = plot.right - inset - width;
    let center = (plot.left + plot.right - width) / 2.0;
    let (top, bottom) = (plot.top, plot.bottom - inset - height);
    let middle = (plot.top + plot.bottom - height) / 2.0;
    let spots = [
        (right, top),
        (left, top),
        (right, bottom),
        (left, bottom),
        (center, top),
        (center, bottom),
        (right, middle),
        (left, middle),
    ];
    spots
        .map(|(x, y)| Rect::sized(x, y, width, height))
        .into_iter()
        .collect()
}

/// Places on the paper where the layers leave ink that matters.
fn covered(chart: &Chart, layers: &[Layer]) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    for layer in layers {
        match layer {
            Layer::Series(series) => {
                let visible = series.points.iter().filter(|p| chart.window.contains(**p));
                places.extend(visible.map(|p| chart.map(*p)));
                if series.line.is_some() {
                    along(chart, &series.points, &mut places);
                }
                for ((x, _), (low, high)) in series.points.iter().zip(&series.y_errors) {
                    along(chart, &[(*x, *low), (*x, *high)], &mut places);
                }
            }
            Layer::Band { points, .. } => {
                for (x, low, high) in points {
                    along(chart, &[(*x, *low), (*x, *high)], &mut places);
                }
            }
            Layer::Identity { .. } => along(chart, &chart.identity(), &mut places),
            Layer::Text { text, place, .. } => text_box(chart, text, *place, &mut places),
            Layer::Windows { spans, .. } => {
                for (from, to) in spans {
                    upright(chart, *from, &mut places);
                    upright(chart, *to, &mut places);
                }
            }
            Layer::Steps { at, .. } => at.iter().for_each(|x| upright(chart, *x, &mut places)),
            Layer::Level { .. } => {}
        }
    }
    places
}

/// Places along a vertical line over the full height.
fn upright(chart: &Chart, x: f64, places: &mut Vec<(f64, f64)>) {
    let (low, high) = chart.window.y;
    along(chart, &[(x, low), (x, high)], places);
}

/// Places along the visible part of a curve.
fn along(chart: &Chart, points: &[(f64, f64)], places: &mut Vec<(f64, f64)>) {
    for piece in chart.window.curve(points) {
        for pair in piece.windows(2) {
            let (a, b) = (chart.map(pair[0]), chart.map(pair[1]));
            let length = (b.0 - a.0).abs().max((b.1 - a.1).abs());
            let steps = (length / mm(GRAIN_MM)).ceil().max(1.0);
            places.extend((0..=steps as usize).map(|k| {
                let t = k as f64 / steps;
                (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1))
            }));
        }
    }
}

/// Places over the length of a text, to both sides, whatever its anchor.
fn text_box(chart: &Chart, text: &str, place: Place, places: &mut Vec<(f64, f64)>) {
    let (x, y) = chart.place(place);
    let width = Label::new(text, SMALL_PT).width;
    let steps = (2.0 * width / mm(1.0)).ceil() as usize;
    places.extend((0..=steps).map(|k| (x - width + k as f64 * mm(1.0), y)));
}
