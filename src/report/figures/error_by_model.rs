//! The error of every model on the same readings, at a glance.

use crate::config::Config;
use crate::report::input::GroupInput;
use crate::report::plot::{Axis, Figure, Ink, Legend, Mark, Panel, SINGLE_MM, Series, Shape};

/// The figure: RMSE by model, for specimens that the model has not seen.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(&'static str, String, Figure)> {
    let comparisons = &group.comparison.comparisons;
    let mut errors: Vec<(&str, f64, bool)> = comparisons
        .iter()
        .filter(|c| c.split == "loso")
        .filter_map(|c| Some((c.title.as_str(), c.rmse?, c.n_excluded > 0)))
        .collect();
    if errors.len() < 2 {
        return None;
    }
    errors.sort_by(|a, b| b.1.total_cmp(&a.1));
    let names: Vec<&str> = errors.iter().map(|e| e.0).collect();
    let marks = |partial: bool| -> Vec<(f64, f64)> {
        let of = errors.iter().enumerate().filter(|(_, e)| e.2 == partial);
        of.map(|(k, e)| (e.1, k as f64)).collect()
    };
    let mut panel = Panel::new(
        Axis::new("RMSE (N)").including(0.0),
        Axis::categories("", &names),
    )
    .legend(Legend::Above);
    panel = panel.with(Series::marks(
        "all readings",
        marks(false),
        Mark::filled(Shape::Circle, Ink::Blue).wide(2.0),
    ));
    if !marks(true).is_empty() {
        let mark = Mark::open(Shape::Circle, Ink::Vermilion).wide(2.0);
        panel = panel.with(Series::marks("those that it answers", marks(true), mark));
    }
    let title = format!("Error of every model, {}", group.fit.group.campaign);
    let caption = "Root-mean-square error of every model on specimens that it has not seen: published models as published, the new model \
        fitted to the other specimens."
        .to_owned();
    Some((
        "models",
        caption,
        Figure::new(&title, 1.3 * SINGLE_MM, 68.0).with(panel),
    ))
}
