//! Measured against predicted force, each reading predicted by the fit that has not seen its specimen, and what is left over.

use crate::config::Config;
use crate::report::figures::formatting::specimen_names;
use crate::report::figures::looks::of_specimen;
use crate::report::input::GroupInput;
use crate::report::plot::{Axis, DOUBLE_MM, Figure, Layer, Panel, Series};
use crate::stages::compare::{NEW, NEW_LOSO};
use std::collections::BTreeMap;

/// The figure; with one specimen only, the predictions are those of the fit itself.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(&'static str, String, Figure)> {
    let by_model = &group.predictions.by_model;
    let unseen = by_model.get(NEW_LOSO);
    let predicted = unseen.or_else(|| by_model.get(NEW))?;
    let mut by_specimen: BTreeMap<(u64, &str), Vec<(f64, f64)>> = BTreeMap::new();
    for (row, force) in group.predictions.rows.iter().zip(predicted) {
        if force.is_finite() {
            let key = (
                (1e4 * row.rest_length_m).round() as u64,
                row.specimen.as_str(),
            );
            by_specimen
                .entry(key)
                .or_default()
                .push((*force, row.force_n));
        }
    }
    let mut agreement = Panel::new(
        Axis::new("Predicted force (N)"),
        Axis::new("Measured force (N)"),
    )
    .same_range()
    .with(Layer::identity(""));
    let mut left_over = Panel::new(
        Axis::new("Predicted force (N)"),
        Axis::new("Measured − predicted (N)"),
    )
    .with(Layer::zero());
    let specimens: Vec<(&str, f64)> = by_specimen
        .keys()
        .map(|(tenths_of_mm, id)| (*id, 1e-4 * *tenths_of_mm as f64))
        .collect();
    let names = specimen_names(&specimens);
    for (k, (name, points)) in names.iter().zip(by_specimen.values()).enumerate() {
        let mark = of_specimen(k, 1.0);
        agreement = agreement.with(Series::marks(name, points.clone(), mark));
        let residuals = points.iter().map(|(p, m)| (*p, m - p)).collect();
        left_over = left_over.with(Series::marks(name, residuals, mark));
    }
    let title = format!(
        "Measured against predicted force, {}",
        group.fit.group.campaign
    );
    let figure = Figure::new(&title, DOUBLE_MM, 82.0)
        .grid(2)
        .shared_legend()
        .with(agreement)
        .with(left_over);
    let how = if unseen.is_some() {
        "Every reading is predicted by the fit that has not seen its specimen."
    } else {
        "The predictions are those of the fit itself: there is no second specimen that could be left out."
    };
    let left_out = predicted.iter().filter(|f| !f.is_finite()).count();
    let missing = if left_out > 0 {
        format!(" Not shown: {left_out} readings of specimens that no fit left out.")
    } else {
        String::new()
    };
    let caption = format!(
        "Measured against predicted force (A) and the difference (B), by resting length. {how}{missing}"
    );
    Some(("predicted", caption, figure))
}
