//! The empirical corrections: how the force depends on columns for which the library has no effect.

use super::residuals::{factor, label};
use super::{HALF_MM, Shown, TEXT_MM};
use crate::plot::{Axis, Dash, Figure, Ink, Layer, Panel, Series, Stroke};
use pipeline_findings::Unexplained;

/// Most panels: so many fit on a page with their caption. `findings.json` has all.
const MOST_PANELS: usize = 8;

/// The figure; none where no correction was fitted.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let fitted: Vec<&Unexplained> = shown
        .found
        .unexplained
        .iter()
        .filter(|u| u.curve.len() > 1)
        .take(MOST_PANELS)
        .collect();
    if fitted.is_empty() {
        return None;
    }
    let in_a_row = fitted.len().min(2);
    let title = format!("Empirical corrections, {}", shown.found.campaign);
    let width = if in_a_row == 1 { HALF_MM } else { TEXT_MM };
    let rows = fitted.len().div_ceil(in_a_row) as f64;
    let mut figure = Figure::new(&title, width, 6.0 + 42.0 * rows);
    if fitted.len() > 1 {
        figure = figure.grid(in_a_row);
    }
    for unexplained in &fitted {
        figure = figure.with(panel(unexplained, shown.unit()));
    }
    let caption = "*Empirical.* The correction that the column would need; its cause is unknown, and it applies to no other campaign.";
    Some((caption.to_owned(), figure))
}

fn panel(unexplained: &Unexplained, unit: &str) -> Panel {
    let y = if unexplained.shape == "gain" {
        "Share of the force".to_owned()
    } else {
        format!("Correction ({unit})")
    };
    let factor = factor(&unexplained.column);
    let points = unexplained.curve.iter().map(|(x, y)| (factor * x, *y));
    let stroke = Stroke::new(Ink::Vermilion, Dash::Dashed);
    Panel::new(
        Axis::new(&label(&unexplained.column)),
        Axis::new(&y).including(0.0),
    )
    .title("EMPIRICAL")
    .with(Layer::zero())
    .with(Series::line("", points.collect(), stroke))
}
