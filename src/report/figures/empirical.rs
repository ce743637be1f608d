//! The empirical corrections: how the force depends on columns for which the library has no effect.

use crate::config::Config;
use crate::report::figures::asked::{factor, label};
use crate::report::figures::words::{listed, verbatim};
use crate::report::input::GroupInput;
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel, SINGLE_MM, Series, Stroke};
use crate::stages::diagnose::findings::Unexplained;

/// Panels beyond these are left out, so that the figure fits on a page with its caption.
const MOST_PANELS: usize = 8;

/// The figure; none where no correction was fitted.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let found = &group.diagnosis.as_ref()?.findings;
    let mut fitted: Vec<&Unexplained> = found
        .unexplained
        .iter()
        .filter(|u| u.curve.len() > 1)
        .collect();
    if fitted.is_empty() {
        return None;
    }
    let columns = fitted.iter().map(|u| label(&u.column));
    let untold: Vec<String> = columns.skip(MOST_PANELS).map(|c| verbatim(&c)).collect();
    fitted.truncate(MOST_PANELS);
    let in_a_row = fitted.len().min(2);
    let title = format!("Empirical corrections, {}", group.fit.group.campaign);
    let width = if in_a_row == 1 {
        SINGLE_MM
    } else {
        1.9 * SINGLE_MM
    };
    let rows = fitted.len().div_ceil(in_a_row) as f64;
    let mut figure = Figure::new(&title, width, 6.0 + 46.0 * rows);
    if fitted.len() > 1 {
        figure = figure.grid(in_a_row);
    }
    for unexplained in &fitted {
        figure = figure.with(panel(unexplained));
    }
    let untold = if untold.is_empty() {
        String::new()
    } else {
        format!(" Not shown: {}.", listed(&untold))
    };
    let caption = format!(
        "*Empirical.* The correction that the column would need, of no known cause and for no other campaign.{untold}"
    );
    Some((caption, figure))
}

fn panel(unexplained: &Unexplained) -> Panel {
    let y = if unexplained.shape == "gain" {
        "Share of the force"
    } else {
        "Correction (N)"
    };
    let factor = factor(&unexplained.column);
    let points = unexplained.curve.iter().map(|(x, y)| (factor * x, *y));
    let stroke = Stroke::new(Ink::Vermilion, Dash::Dashed);
    Panel::new(
        Axis::new(&label(&unexplained.column)),
        Axis::new(y).including(0.0),
    )
    .title("EMPIRICAL")
    .with(Layer::zero())
    .with(Series::line("", points.collect(), stroke))
}
