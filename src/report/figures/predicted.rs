//! Measured against predicted force, each reading predicted by the fit that has not seen its specimen, and what is left over.

use crate::figures::formatting::{largest, specimen_names};
use crate::figures::looks::{MOST_SPECIMENS, of_specimen};
use crate::input::GroupInput;
use crate::plot::{Axis, DOUBLE_MM, Figure, Ink, Layer, Mark, Panel, Series, Shape};
use pipeline_compare::{NEW, NEW_LOSO};
use pipeline_config::Config;
use std::collections::BTreeMap;

/// The figure; with one specimen only, the predictions are those of the fit itself.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let by_model = &group.predictions.by_model;
    let unseen = by_model.get(NEW_LOSO);
    let predicted = unseen.or_else(|| by_model.get(NEW))?;
    let clouds = Clouds::new(clouds(group, predicted));
    let agreement = Panel::new(
        Axis::new("Predicted force (N)"),
        Axis::new("Measured force (N)"),
    )
    .same_range()
    .with(Layer::identity(""));
    let left_over = Panel::new(
        Axis::new("Predicted force (N)"),
        Axis::new("Measured − predicted (N)"),
    )
    .with(Layer::zero());
    let title = format!(
        "Measured against predicted force, {}",
        group.fit.group.campaign
    );
    let figure = Figure::new(&title, DOUBLE_MM, 60.0)
        .grid(2)
        .shared_legend()
        .with(clouds.on(agreement, |point| point))
        .with(clouds.on(left_over, |(p, m)| (p, m - p)));
    let how = if unseen.is_some() {
        "Every reading is predicted by the fit without its specimen."
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
        "Measured against predicted force (A) and the difference (B), by resting length.{} {how}{missing}",
        clouds.caption()
    );
    Some((caption, figure))
}

/// Predicted and measured forces, N.
type Points = Vec<(f64, f64)>;

/// The points of every specimen, by resting length and id.
fn clouds(group: &GroupInput, predicted: &[f64]) -> Vec<(String, Points)> {
    let mut by_specimen: BTreeMap<(u64, &str), Points> = BTreeMap::new();
    for (row, force) in group.predictions.rows.iter().zip(predicted) {
        if force.is_finite() {
            let tenths_of_mm = (1e4 * row.rest_length_m).round() as u64;
            let key = (tenths_of_mm, row.specimen.as_str());
            let points = by_specimen.entry(key).or_default();
            points.push((*force, row.force_n));
        }
    }
    let specimens: Vec<(&str, f64)> = by_specimen
        .keys()
        .map(|(tenths_of_mm, id)| (*id, 1e-4 * *tenths_of_mm as f64))
        .collect();
    let names = specimen_names(&specimens);
    names.into_iter().zip(by_specimen.into_values()).collect()
}

/// The specimens with a mark of their own, and all the others. There are only so many marks that can be told apart, and whoever looks at this
/// figure looks for the specimens that are far off.
struct Clouds {
    named: Vec<(String, Points)>,
    others: Points,
    count_of_others: usize,
}

impl Clouds {
    fn new(all: Vec<(String, Points)>) -> Self {
        let errors: Vec<f64> = all.iter().map(|(_, points)| mean_square(points)).collect();
        let worst = largest(&errors, MOST_SPECIMENS);
        let count_of_others = all.len() - worst.len();
        let (mut named, mut others) = (Vec::new(), Vec::new());
        for (k, (name, points)) in all.into_iter().enumerate() {
            if worst.contains(&k) {
                named.push((name, points));
            } else {
                others.extend(points);
            }
        }
        Self {
            named,
            others,
            count_of_others,
        }
    }

    /// The panel with the points, each brought to where it stands there.
    fn on(&self, mut panel: Panel, place: impl Fn((f64, f64)) -> (f64, f64)) -> Panel {
        let placed = |points: &Points| points.iter().copied().map(&place).collect();
        let dot = Mark::filled(Shape::Dot, Ink::Grey);
        if self.count_of_others > 0 {
            panel = panel.with(Series::marks("", placed(&self.others), dot));
        }
        for (k, (name, points)) in self.named.iter().enumerate() {
            let mark = of_specimen(k, 1.0);
            panel = panel.with(Series::marks(name, placed(points), mark));
        }
        if self.count_of_others > 0 {
            let name = format!("and {} more", self.count_of_others);
            panel = panel.with(Series::marks(&name, Vec::new(), dot));
        }
        panel
    }

    fn caption(&self) -> String {
        if self.count_of_others == 0 {
            return String::new();
        }
        format!(
            " Of {} specimens the {} with the largest error are named; grey dots are the others.",
            self.named.len() + self.count_of_others,
            self.named.len()
        )
    }
}

fn mean_square(points: &Points) -> f64 {
    let squares = points.iter().map(|(p, m)| (m - p) * (m - p));
    squares.sum::<f64>() / points.len() as f64
}
