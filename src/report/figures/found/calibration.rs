//! Whether the predictive distribution is right: histogram of the probability integral transform of the held-out readings.

use super::{HALF_MM, Shown};
use crate::plot::{Axis, Dash, Figure, Ink, Layer, Panel, Stroke};
use crate::wording::number::percent;

/// The figure; none where nothing was held out.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let found = shown.found;
    let bins = found.pit.len();
    if bins == 0 {
        return None;
    }
    let flat = 1.0 / bins as f64;
    let highest = found.pit.iter().copied().fold(2.0 * flat, f64::max);
    let mut panel = Panel::new(
        Axis::new("Probability integral transform").fixed(0.0, 1.0),
        Axis::new("Share of the readings").fixed(0.0, 1.1 * highest),
    );
    for (k, share) in found.pit.iter().enumerate() {
        let ends = [
            k as f64 * flat + 0.03 * flat,
            (k + 1) as f64 * flat - 0.03 * flat,
        ];
        panel = panel.with(Layer::band(
            "",
            ends.map(|x| (x, 0.0, *share)).to_vec(),
            Ink::Blue,
        ));
    }
    panel = panel.with(Layer::Level {
        name: String::new(),
        at: flat,
        stroke: Stroke::hair(Ink::Black, Dash::Dashed),
    });
    let inside = match (found.inside_50, found.inside_95) {
        (Some(half), Some(most)) => format!(
            " {} lie inside their 50% interval, {} inside their 95% interval.",
            percent(half),
            percent(most)
        ),
        _ => String::new(),
    };
    let caption = format!(
        "Where the held-out readings lie in their predictive distribution: flat where it is right (dashed), a hump where it is too wide, \
         a bowl where it is too narrow.{inside}"
    );
    let title = format!("Probability integral transform, {}", found.campaign);
    Some((caption, Figure::new(&title, HALF_MM, 42.0).with(panel)))
}
