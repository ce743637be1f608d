//! What is left to explain: a cubic over a column in the residual, held out by fold.

use crate::numerics::matrix::{Matrix, dot};
use crate::numerics::qr::PivotedQr;
use std::collections::BTreeSet;

/// Powers of the column, 0 and 1 included.
const TERMS: usize = 4;
/// Points of a curve that is shown.
const SHOWN: usize = 13;

/// The residuals (N.m) less the curve that those of all other folds have over a column.
pub fn left(values: &[f64], residuals: &[f64], folds: &[usize]) -> Vec<f64> {
    let scale = Scale::of(values);
    let all: BTreeSet<usize> = folds.iter().copied().collect();
    let mut left = residuals.to_vec();
    for out in all {
        let kept: Vec<usize> = (0..folds.len()).filter(|k| folds[*k] != out).collect();
        let Some(curve) = scale.fitted(values, residuals, &kept) else {
            continue;
        };
        for k in (0..folds.len()).filter(|k| folds[*k] == out) {
            left[k] -= dot(&scale.row(values[k]), &curve);
        }
    }
    left
}

/// The curve of all residuals over a column: value, N.m.
pub fn curve(values: &[f64], residuals: &[f64]) -> Vec<(f64, f64)> {
    let scale = Scale::of(values);
    let all: Vec<usize> = (0..values.len()).collect();
    let Some(curve) = scale.fitted(values, residuals, &all) else {
        return Vec::new();
    };
    let at = |k: usize| {
        let share = k as f64 / (SHOWN - 1) as f64;
        scale.low + share * (scale.high - scale.low)
    };
    let shown = (0..SHOWN).map(at);
    shown.map(|x| (x, dot(&scale.row(x), &curve))).collect()
}

struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    fn of(values: &[f64]) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { low, high }
    }

    fn row(&self, value: f64) -> [f64; TERMS] {
        let x = 2.0 * (value - self.low) / (self.high - self.low) - 1.0;
        [1.0, x, x * x, x * x * x]
    }

    fn fitted(&self, values: &[f64], residuals: &[f64], kept: &[usize]) -> Option<Vec<f64>> {
        if kept.len() <= TERMS || self.high <= self.low {
            return None;
        }
        let mut design = Matrix::zeros(kept.len(), TERMS);
        for (i, k) in kept.iter().enumerate() {
            for (j, x) in self.row(values[*k]).into_iter().enumerate() {
                design[(i, j)] = x;
            }
        }
        let wanted: Vec<f64> = kept.iter().map(|k| residuals[*k]).collect();
        Some(PivotedQr::new(design).solve_least_squares(&wanted, TERMS))
    }
}
