//! What is left to explain: a cubic over the knee angle in the residual, held out by fold.

use crate::numerics::matrix::{Matrix, dot};
use crate::numerics::qr::PivotedQr;
use std::collections::BTreeSet;

/// Powers of the angle, 0 and 1 included.
const TERMS: usize = 4;

/// The residuals (N.m) less the curve that those of all other folds have over the angle (rad).
pub fn left(angles_rad: &[f64], residuals: &[f64], folds: &[usize]) -> Vec<f64> {
    let row = |angle: f64| -> [f64; TERMS] {
        let x = angle / std::f64::consts::FRAC_PI_2;
        [1.0, x, x * x, x * x * x]
    };
    let all: BTreeSet<usize> = folds.iter().copied().collect();
    let mut left = residuals.to_vec();
    for out in all {
        let kept: Vec<usize> = (0..folds.len()).filter(|k| folds[*k] != out).collect();
        if kept.len() <= TERMS {
            continue;
        }
        let mut design = Matrix::zeros(kept.len(), TERMS);
        for (i, k) in kept.iter().enumerate() {
            for (j, x) in row(angles_rad[*k]).into_iter().enumerate() {
                design[(i, j)] = x;
            }
        }
        let wanted: Vec<f64> = kept.iter().map(|k| residuals[*k]).collect();
        let curve = PivotedQr::new(design).solve_least_squares(&wanted, TERMS);
        for k in (0..folds.len()).filter(|k| folds[*k] == out) {
            left[k] -= dot(&row(angles_rad[k]), &curve);
        }
    }
    left
}
