//! Sums of products over rows, each in a fixed order: the innermost loops.
//!
//! What is marked `multiversion`, here and beside, is compiled for processors with AVX2 as well and chosen when the program runs. No sum is
//! reordered and no product fused with one, so that both give the same bits.

use crate::gram::Square;
use multiversion::multiversion;

/// Scalar product in four partial sums, in a fixed order.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = a4
        .remainder()
        .iter()
        .zip(b4.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in a4.zip(b4) {
        for (s, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *s += x * y;
        }
    }
    sums.iter().sum::<f64>() + tail
}

#[inline]
pub(crate) fn add_times(to: &mut [f64], factor: f64, from: &[f64]) {
    for (t, f) in to.iter_mut().zip(from) {
        *t += factor * f;
    }
}

/// Adds R'R, upper triangle, R of so many rows.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_products(to: &mut Square, r: &[f64], rows: usize) {
    let n = to.n;
    let blocks = rows / 4;
    for i in 0..n {
        let line = &mut to.a[i * n + i..(i + 1) * n];
        for block in 0..blocks {
            let row = |k: usize| &r[(4 * block + k) * n + i..(4 * block + k + 1) * n];
            add_four(line, [row(0), row(1), row(2), row(3)]);
        }
        for k in 4 * blocks..rows {
            let row = &r[k * n + i..(k + 1) * n];
            add_times(line, row[0], row);
        }
    }
}

/// Adds four rows, each times its first entry.
#[inline]
fn add_four(to: &mut [f64], rows: [&[f64]; 4]) {
    let factors = rows.map(|r| r[0]);
    let [a, b, c, d] = rows;
    for ((((t, a), b), c), d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *t += factors[0] * a + factors[1] * b + (factors[2] * c + factors[3] * d);
    }
}

/// Adds the rows of a matrix, each times a factor.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_combination(to: &mut [f64], factors: &[f64], rows: &[f64]) {
    let n = to.len();
    let (factors4, rows4) = (factors.chunks_exact(4), rows.chunks_exact(4 * n));
    let tail = factors4.remainder().iter();
    for (factor, row) in tail.zip(rows4.remainder().chunks_exact(n)) {
        add_times(to, *factor, row);
    }
    for (f, four) in factors4.zip(rows4) {
        let (a, rest) = four.split_at(n);
        let (b, rest) = rest.split_at(n);
        let (c, d) = rest.split_at(n);
        for ((((t, a), b), c), d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *t += f[0] * a + f[1] * b + (f[2] * c + f[3] * d);
        }
    }
}
