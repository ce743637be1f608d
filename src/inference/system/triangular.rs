//! Solving with a lower triangular factor.

use super::kernels::dot;
use crate::gram::Square;

/// L^-1 b; 0 where there is no pivot.
pub(crate) fn forward(lower: &Square, b: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    for i in 0..b.len() {
        let pivot = lower.at(i, i);
        if pivot > 0.0 {
            let known = dot(&lower.a[i * lower.n..i * lower.n + i], &x[..i]);
            x[i] = (b[i] - known) / pivot;
        }
    }
    x
}

/// L^-T b; 0 where there is no pivot.
pub(crate) fn back_substitute(lower: &Square, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let pivot = lower.at(i, i);
        if pivot > 0.0 {
            let known: f64 = (i + 1..n).map(|k| lower.at(k, i) * x[k]).sum();
            x[i] = (b[i] - known) / pivot;
        }
    }
    x
}

/// (L L')^-1 of a factor without missing pivots.
pub(super) fn inverse_of(lower: &Square) -> Square {
    let n = lower.n;
    // L^-1, by columns: row j of `inverse` is its column j.
    let mut inverse = Square::zeros(n);
    for j in 0..n {
        let column = &mut inverse.a[j * n..(j + 1) * n];
        column[j] = 1.0 / lower.at(j, j);
        for i in j + 1..n {
            let known: f64 = (j..i).map(|k| lower.at(i, k) * column[k]).sum();
            column[i] = -known / lower.at(i, i);
        }
    }
    let mut product = Square::zeros(n);
    for i in 0..n {
        for j in 0..=i {
            let columns = [i, j].map(|k| &inverse.a[k * n + i..(k + 1) * n]);
            let value = dot(columns[0], columns[1]);
            *product.at_mut(i, j) = value;
            *product.at_mut(j, i) = value;
        }
    }
    product
}
