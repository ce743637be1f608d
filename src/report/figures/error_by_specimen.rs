//! The error of the new model on each specimen by the fit that has not seen it, beside the best published models.

use crate::figures::formatting::{largest, specimen_names};
use crate::figures::looks::of_model;
use crate::input::GroupInput;
use crate::plot::{Axis, Dash, Figure, Ink, Layer, Legend, Panel, SINGLE_MM, Series, Stroke};
use pipeline_compare::{Comparison, NEW, SpecimenComparison};
use pipeline_config::Config;

/// The published coefficients of the new model, which are always shown.
const PUBLISHED: &str = "new_published";
/// How many other models are shown.
const OTHERS: usize = 3;
/// Specimens beyond these are left out, so that the figure fits on a page with its caption.
const MOST_SPECIMENS: usize = 22;
/// Distance between the marks of two models in the band of a specimen, in bands.
const SHIFT: f64 = 0.14;

/// The figure, for groups whose specimens were left out one by one.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let by_specimen = &group.comparison.by_specimen;
    let left_out = |c: &Comparison| c.model == NEW && c.split == "loso" && c.rmse.is_some();
    let unseen = by_specimen.iter().filter(|s| left_out(&s.comparison));
    let unseen: Vec<&SpecimenComparison> = unseen.collect();
    if unseen.len() < 2 {
        return None;
    }
    let errors: Vec<f64> = unseen
        .iter()
        .map(|s| s.comparison.rmse.unwrap_or(0.0))
        .collect();
    let all: Vec<(&str, f64)> = unseen
        .iter()
        .map(|s| (s.specimen.as_str(), s.rest_length_m))
        .collect();
    // Of all of them, so that a length that others share does not stand alone for one.
    let names = specimen_names(&all);
    let shown = largest(&errors, MOST_SPECIMENS);
    let specimens: Vec<(&str, f64)> = shown.iter().map(|k| all[*k]).collect();
    let names: Vec<&str> = shown.iter().map(|k| names[*k].as_str()).collect();
    let mut panel = Panel::new(
        Axis::new("RMSE (N)").including(0.0),
        Axis::categories("l_{rest}", &names),
    )
    .legend(Legend::Above);
    for k in 1..specimens.len() {
        panel = panel.with(border(k));
    }
    let (models, partial) = models(group);
    for (order, line) in models.iter().enumerate() {
        let look = of_model(&line.model, &line.title, order);
        // One below the other, so that equal errors do not hide each other.
        let shift = SHIFT * (0.5 * (models.len() - 1) as f64 - order as f64);
        let points: Vec<(f64, f64)> = by_specimen
            .iter()
            .filter(|s| s.comparison.model == line.model)
            .filter_map(|s| {
                let place = specimens.iter().position(|(id, _)| *id == s.specimen)?;
                Some((s.comparison.rmse?, place as f64 + shift))
            })
            .collect();
        panel = panel.with(Series::marks(&look.name, points, look.mark.wide(1.7)));
    }
    let title = format!("Error by specimen, {}", group.fit.group.campaign);
    let height = 26.0 + 7.0 * specimens.len() as f64;
    let figure = Figure::new(&title, 1.3 * SINGLE_MM, height).with(panel);
    Some((caption(partial, specimens.len(), unseen.len()), figure))
}

/// A thin line below a specimen's band.
fn border(place: usize) -> Layer {
    Layer::Level {
        name: String::new(),
        at: place as f64 - 0.5,
        stroke: Stroke::hair(Ink::Grey, Dash::Dotted),
    }
}

/// The new model, its published coefficients, and the best of the others, of which those that answer everything come first; and whether
/// one of these has no answer for some readings.
fn models(group: &GroupInput) -> (Vec<&Comparison>, bool) {
    let all = group.comparison.comparisons.iter();
    let all: Vec<&Comparison> = all
        .filter(|c| c.split == "all" && c.rmse.is_some())
        .collect();
    let mut others: Vec<&Comparison> = all
        .iter()
        .copied()
        .filter(|c| !c.fitted_here && c.model != PUBLISHED)
        .collect();
    others.sort_by(|a, b| {
        let partial = (a.n_excluded > 0).cmp(&(b.n_excluded > 0));
        let rmse = |c: &Comparison| c.rmse.unwrap_or(f64::INFINITY);
        partial.then(rmse(a).total_cmp(&rmse(b)))
    });
    others.truncate(OTHERS);
    let first = [NEW, PUBLISHED]
        .into_iter()
        .filter_map(|id| all.iter().copied().find(|c| c.model == id));
    let chosen: Vec<&Comparison> = first.chain(others).collect();
    let partial = chosen.iter().any(|c| c.n_excluded > 0);
    (chosen, partial)
}

fn caption(partial: bool, shown: usize, all: usize) -> String {
    let partial = if partial {
        " A model that does not cover all readings is judged on the others."
    } else {
        ""
    };
    let others = if shown < all {
        format!(
            " Shown are the {shown} of {all} specimens with the largest error of the new model; `tables/comparison_by_length.csv` has all."
        )
    } else {
        String::new()
    };
    format!(
        "Root-mean-square error on each specimen, by resting length: the new model fitted to the other specimens, its published \
         coefficients, and the best of the other published models.{partial}{others}"
    )
}
