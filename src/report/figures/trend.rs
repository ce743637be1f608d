//! What panels of residuals share: the trend through a cloud, readings spread sideways, panels in rows.

use crate::plot::{Dash, Ink, Mark, Series, Shape, Stroke};
use pipeline_numerics::running::{medians_by_cluster, running_median};

/// Up to so many clusters of values get a median each, more values a running one.
const FEW_CLUSTERS: usize = 12;
/// Values that follow each other by less than this part of their range belong to a cluster.
const GAP: f64 = 0.015;

/// How many panels stand in a row, so that few places stay empty.
pub fn columns(panels: usize) -> usize {
    match panels {
        0..=4 => panels.max(1),
        5 | 6 | 9 => 3,
        _ => 4,
    }
}

/// Medians of clusters where the values cluster or stand for names (`names`), else running ones.
pub fn trend(values: &[f64], residuals: &[f64], names: bool) -> Series {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let gap = if names { 0.5 } else { GAP * (high - low) };
    let clusters = medians_by_cluster(values, residuals, gap);
    match clusters.filter(|c| names || c.len() <= FEW_CLUSTERS) {
        Some(medians) => {
            let mark = Mark::filled(Shape::Diamond, Ink::Vermilion).wide(1.6);
            Series::marks("median at this value", medians, mark)
        }
        None => {
            let window = (residuals.len() / 10).max(9);
            let medians = running_median(values, residuals, window);
            let stroke = Stroke {
                width_pt: 1.3,
                ..Stroke::new(Ink::Vermilion, Dash::Solid)
            };
            Series::line("running median", medians, stroke)
        }
    }
}

/// The values, spread by up to a quarter to both sides: by the golden ratio, so that neighbours stand apart and every run is the same.
pub fn spread(values: &[f64]) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let shift = |k: usize| 0.5 * ((k as f64 * GOLDEN).fract() - 0.5);
    values
        .iter()
        .enumerate()
        .map(|(k, v)| v + shift(k))
        .collect()
}
