//! Multifrontal elimination, a node at a time: the rows of its own columns, their Cholesky factor, what it leaves to its parent; and at the root the
//! factor of what is left of fixed effects and response.

use super::kernels::{add_times, dot};
use super::triangular::forward;
use super::{Eliminated, Variances};
use crate::gram::{Gram, Square};
use crate::tree::Tree;
use multiversion::multiversion;

/// A pivot below this part of its diagonal is none: the column is spanned by those before it.
const NO_PIVOT: f64 = 1e-11;

/// Rows of a node's own columns in the system: scaled sums less what the groups below take off. Columns of the path, fixed effects, response.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn own_rows(
    tree: &Tree,
    gram: &Gram,
    variances: &Variances,
    node: usize,
    off: Option<&Square>,
) -> Square {
    let (above, width) = (tree.above(node), tree.width(node));
    let n = above + width + gram.fixed + 1;
    let mut rows = Square {
        n,
        a: vec![0.0; width * n],
    };
    for (class, noise) in variances.noise.iter().enumerate() {
        if let Some((sums, beside)) = gram.total(node, class) {
            let factor = 1.0 / (noise * noise);
            let (shared, apart) = (sums.n, gram.apart);
            for (k, row) in rows.a.chunks_exact_mut(n).enumerate() {
                let own = above + k;
                let from = &sums.a[own * shared..(own + 1) * shared];
                add_times(&mut row[..shared], factor, from);
                let from = &beside[own * apart..(own + 1) * apart];
                add_times(&mut row[shared..], factor, from);
            }
        }
    }
    let of = tree.path_components(node).iter();
    let mut scale: Vec<f64> = of.map(|c| variances.components[*c]).collect();
    scale.resize(n, 1.0);
    for k in 0..width {
        let row = &mut rows.a[k * n..(k + 1) * n];
        for (x, s) in row.iter_mut().zip(&scale) {
            *x *= scale[above + k] * s;
        }
        if let Some(off) = off {
            let (before, behind) = row.split_at_mut(above + k);
            for (j, x) in before.iter_mut().enumerate() {
                *x -= off.at(j, above + k);
            }
            let line = &off.a[(above + k) * n + above + k..(above + k + 1) * n];
            for (x, y) in behind.iter_mut().zip(line) {
                *x -= y;
            }
        }
    }
    rows
}

/// Eliminates a node's own columns, to which 1 is added on the diagonal (the prior precision).
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn eliminate(own: &Square, first: usize, width: usize) -> Eliminated {
    let n = own.n;
    let stride = n - width;
    let mut lower = Square::zeros(width);
    let mut rest = vec![0.0; width * stride];
    for k in 0..width {
        let mut pivot = own.at(k, first + k) + 1.0;
        for l in 0..k {
            pivot -= lower.at(k, l) * lower.at(k, l);
        }
        let root = pivot.max(f64::MIN_POSITIVE).sqrt();
        *lower.at_mut(k, k) = root;
        for m in k + 1..width {
            let mut x = own.at(k, first + m);
            for l in 0..k {
                x -= lower.at(m, l) * lower.at(k, l);
            }
            *lower.at_mut(m, k) = x / root;
        }
        let (done, row) = rest.split_at_mut(k * stride);
        let row = &mut row[..stride];
        row[..first].copy_from_slice(&own.a[k * n..k * n + first]);
        row[first..].copy_from_slice(&own.a[k * n + first + width..(k + 1) * n]);
        for l in 0..k {
            add_times(row, -lower.at(k, l), &done[l * stride..(l + 1) * stride]);
        }
        let inverse = 1.0 / root;
        for slot in row {
            *slot *= inverse;
        }
    }
    Eliminated {
        idle: false,
        lower,
        rest,
    }
}

/// Adds a matrix of which the upper triangle counts, without a node's own rows and columns.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_without_own(to: &mut Square, from: Option<&Square>, first: usize, width: usize) {
    let Some(from) = from else { return };
    for i in 0..to.n {
        let row = if i < first { i } else { i + width };
        let line = &from.a[row * from.n..(row + 1) * from.n];
        let slots = &mut to.a[i * to.n..(i + 1) * to.n];
        if i < first {
            add_times(&mut slots[i..first], 1.0, &line[i..first]);
            add_times(&mut slots[first..], 1.0, &line[first + width..]);
        } else {
            add_times(&mut slots[i..], 1.0, &line[row..]);
        }
    }
}

/// The sums of fixed effects and response, less what the random effects take off.
pub(super) fn left_of_fixed(
    tree: &Tree,
    gram: &Gram,
    variances: &Variances,
    off: Option<&Square>,
) -> Square {
    let n = gram.fixed + 1;
    let first = tree.width(0);
    let mut left = Square::zeros(n);
    for i in 0..n {
        for j in i..n {
            let noise = variances.noise.iter().enumerate();
            let sum: f64 = noise
                .filter_map(|(class, s)| Some((gram.total(0, class)?, s)))
                .map(|((sums, beside), s)| {
                    let product = match (first + j).checked_sub(sums.n) {
                        None => sums.at(first + i, first + j),
                        Some(k) => beside[(first + i) * gram.apart + k],
                    };
                    product / (s * s)
                })
                .sum();
            let value = sum - off.map_or(0.0, |o| o.at(i, j));
            *left.at_mut(i, j) = value;
            *left.at_mut(j, i) = value;
        }
    }
    left
}

/// Factor of X'V^-1 X, L^-1 X'V^-1 y and y'P y, from what is left at the root.
pub(super) fn finish(front: &Square, p: usize) -> (Square, Vec<f64>, f64) {
    let mut lower = Square::zeros(p);
    for j in 0..p {
        let mut pivot = front.at(j, j);
        for k in 0..j {
            pivot -= lower.at(j, k) * lower.at(j, k);
        }
        if pivot <= NO_PIVOT * front.at(j, j) || pivot <= 0.0 {
            continue;
        }
        let root = pivot.sqrt();
        *lower.at_mut(j, j) = root;
        for i in j + 1..p {
            let mut x = front.at(i, j);
            for k in 0..j {
                x -= lower.at(i, k) * lower.at(j, k);
            }
            *lower.at_mut(i, j) = x / root;
        }
    }
    let right: Vec<f64> = (0..p).map(|i| front.at(i, p)).collect();
    let half = forward(&lower, &right);
    let quadratic = front.at(p, p) - dot(&half, &half);
    (lower, half, quadratic)
}
