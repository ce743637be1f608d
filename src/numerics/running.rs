//! What a cloud of points does on the whole: running medians, medians of clusters, and the normal quantile plot.

use super::distributions::normal_quantile;
use super::statistics::{median, quantile};
use std::ops::Range;

/// Medians of `x` and `y` over windows of `window` points that follow each other by `x`, half a window apart; one window over all of
/// fewer points. A window takes in every point with the `x` of its first or last one: which of several readings at one place are
/// counted must not depend on their order. No two medians have the same `x`. Points that are not finite in both are left out.
///
/// # Panics
/// If the slices differ in length.
pub fn running_median(x: &[f64], y: &[f64], window: usize) -> Vec<(f64, f64)> {
    let points = sorted(x, y);
    let window = window.clamp(1, points.len().max(1));
    let stride = (window / 2).max(1);
    let last = points.len().saturating_sub(window);
    let mut starts: Vec<usize> = (0..=last).step_by(stride).collect();
    if starts.last() != Some(&last) {
        starts.push(last);
    }
    starts.retain(|_| !points.is_empty());
    let whole = |start: usize| {
        let (first, last) = (points[start].0, points[start + window - 1].0);
        let from = points.partition_point(|p| p.0 < first);
        from..points.partition_point(|p| p.0 <= last)
    };
    let mut windows: Vec<Range<usize>> = starts.into_iter().map(whole).collect();
    windows.dedup();
    let mut medians: Vec<(f64, f64)> = windows.into_iter().map(|w| centre(&points[w])).collect();
    medians.dedup_by(|b, a| b.0 == a.0);
    medians
}

/// The median of `x` and `y` in every cluster: points whose `x` follow each other by no more than `gap`. By rising `x`; points that are not
/// finite in both are left out. `None` where a cluster is wider than four gaps, for then `x` does not cluster.
///
/// # Panics
/// If the slices differ in length.
pub fn medians_by_cluster(x: &[f64], y: &[f64], gap: f64) -> Option<Vec<(f64, f64)>> {
    let points = sorted(x, y);
    let clusters = points.chunk_by(|a, b| b.0 - a.0 <= gap);
    clusters
        .map(|c| (c[c.len() - 1].0 - c[0].0 <= 4.0 * gap).then(|| centre(c)))
        .collect()
}

fn sorted(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    assert_eq!(x.len(), y.len(), "one y for each x");
    let pairs = x.iter().copied().zip(y.iter().copied());
    let mut points: Vec<(f64, f64)> = pairs
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points
}

fn centre(points: &[(f64, f64)]) -> (f64, f64) {
    let x: Vec<f64> = points.iter().map(|p| p.0).collect();
    let y: Vec<f64> = points.iter().map(|p| p.1).collect();
    (median(&x), median(&y))
}

/// Values against the quantiles that they would have if they were normal.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalPlot {
    /// Standard normal quantile and value, by rising value.
    pub points: Vec<(f64, f64)>,
    /// Value at quantile 0 of the line through the quartiles, which a few stray values do not turn.
    pub intercept: f64,
    /// Its slope: the standard deviation that the middle half would have.
    pub slope: f64,
}

/// The normal quantile plot of finite values, at the probabilities `(i - 3/8)/(n + 1/4)` (Blom, *Statistical Estimates and Transformed
/// Beta-Variables*, 1958). `None` of fewer than two different values.
pub fn normal_plot(values: &[f64]) -> Option<NormalPlot> {
    let mut values: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    if values.first() == values.last() {
        return None;
    }
    let n = values.len() as f64;
    let place = |i: usize| normal_quantile((i as f64 + 0.625) / (n + 0.25));
    let (low, high) = (quantile(&values, 0.25), quantile(&values, 0.75));
    let slope = (high - low) / (2.0 * normal_quantile(0.75));
    Some(NormalPlot {
        intercept: 0.5 * (low + high),
        slope,
        points: values
            .iter()
            .enumerate()
            .map(|(i, v)| (place(i), *v))
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_running_median_follows_a_line_and_passes_over_a_stray_point() {
        let x: Vec<f64> = (0..101).rev().map(f64::from).collect();
        let y: Vec<f64> = x
            .iter()
            .map(|x| if *x == 40.0 { 1e6 } else { 2.0 * x })
            .collect();
        let medians = running_median(&x, &y, 11);
        assert_eq!(medians.first(), Some(&(5.0, 10.0)));
        assert_eq!(medians.last(), Some(&(95.0, 190.0)));
        assert!(medians.iter().all(|(x, y)| (y - 2.0 * x).abs() <= 2.0));
    }

    #[test]
    fn few_points_are_one_window_and_none_are_none() {
        assert_eq!(running_median(&[1.0, 3.0], &[4.0, 8.0], 9), [(2.0, 6.0)]);
        assert!(running_median(&[f64::NAN], &[1.0], 9).is_empty());
        assert!(running_median(&[], &[], 9).is_empty());
    }

    #[test]
    fn readings_at_one_place_are_counted_together() {
        let x = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0];
        let y = [9.0, 1.0, 5.0, 2.0, 8.0, 5.0, 5.0, 5.0];
        assert_eq!(running_median(&x, &y, 2), [(0.0, 5.0), (1.5, 5.0)]);
    }

    #[test]
    fn clusters_get_one_median_each() {
        let x = [2.0, 1.0, 2.01, 1.0, 1.99];
        let y = [5.0, 1.0, 7.0, 3.0, 60.0];
        let medians = medians_by_cluster(&x, &y, 0.05).unwrap();
        assert_eq!(medians, [(1.0, 2.0), (2.0, 7.0)]);
        let even: Vec<f64> = (0..50).map(f64::from).collect();
        assert_eq!(medians_by_cluster(&even, &even, 1.0), None);
    }

    #[test]
    fn normal_values_stand_on_the_line() {
        let values: Vec<f64> = (0..999)
            .map(|i| 3.0 + 2.0 * normal_quantile((f64::from(i) + 0.625) / 999.25))
            .collect();
        let plot = normal_plot(&values).unwrap();
        assert!((plot.intercept - 3.0).abs() < 1e-9 && (plot.slope - 2.0).abs() < 5e-3);
        let off = |(q, v): &(f64, f64)| (v - 3.0 - 2.0 * q).abs();
        assert!(plot.points.iter().all(|p| off(p) < 1e-9));
        assert_eq!(normal_plot(&[1.0, 1.0]), None);
    }
}
