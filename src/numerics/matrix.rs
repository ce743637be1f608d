//! A small dense matrix, and the few vector operations that least squares needs.
//!
//! Column-major, because Householder QR and Jacobians both work a column (one parameter, all observations) at a time. Only what
//! the fitter uses is here; it is not a linear-algebra library.

use std::ops::{Index, IndexMut};

/// A dense matrix of `rows` x `cols`, stored column after column.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self {
            rows,
            cols,
            data: vec![0.0; rows * cols],
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// All entries, column after column.
    pub fn data(&self) -> &[f64] {
        &self.data
    }

    /// Column `j`, a slice of `rows` entries.
    ///
    /// # Panics
    /// If `j >= cols`.
    pub fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Column `j` for writing.
    ///
    /// # Panics
    /// If `j >= cols`.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Column `from` for reading beside column `to` for writing.
    ///
    /// # Panics
    /// Unless `from < to < cols`.
    pub fn column_pair(&mut self, from: usize, to: usize) -> (&[f64], &mut [f64]) {
        assert!(from < to, "the read column stands left of the written one");
        let (left, right) = self.data.split_at_mut(to * self.rows);
        (
            &left[from * self.rows..(from + 1) * self.rows],
            &mut right[..self.rows],
        )
    }

    /// Exchanges two columns.
    pub fn swap_columns(&mut self, a: usize, b: usize) {
        for i in 0..self.rows {
            self.data.swap(a * self.rows + i, b * self.rows + i);
        }
    }

    /// The matrix of the columns named by `indices`, in that order: `rows` x `indices.len()`.
    pub fn select_columns(&self, indices: &[usize]) -> Self {
        let mut selected = Self::zeros(self.rows, indices.len());
        for (to, &from) in indices.iter().enumerate() {
            selected.column_mut(to).copy_from_slice(self.column(from));
        }
        selected
    }

    /// Multiplies row `i` by `factors[i]`; `factors` has one entry a row.
    pub fn scale_rows(&mut self, factors: &[f64]) {
        for j in 0..self.cols {
            for (entry, factor) in self.column_mut(j).iter_mut().zip(factors) {
                *entry *= factor;
            }
        }
    }

    /// `A x`: `rows` entries from `cols` of them.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.rows];
        for (j, &factor) in x.iter().enumerate() {
            add_scaled(&mut product, factor, self.column(j));
        }
        product
    }

    /// `A^T x`: `cols` entries from `rows` of them.
    pub fn transpose_multiply(&self, x: &[f64]) -> Vec<f64> {
        (0..self.cols).map(|j| dot(self.column(j), x)).collect()
    }

    /// Euclidean norms of the columns.
    pub fn column_norms(&self) -> Vec<f64> {
        (0..self.cols).map(|j| norm(self.column(j))).collect()
    }

    /// Brings every column to unit length; returns the lengths, with 1 for columns of zeros.
    pub fn normalise_columns(&mut self) -> Vec<f64> {
        let mut lengths = self.column_norms();
        for (j, length) in lengths.iter_mut().enumerate() {
            if *length == 0.0 {
                *length = 1.0;
            }
            for entry in self.column_mut(j) {
                *entry /= *length;
            }
        }
        lengths
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;
    fn index(&self, (row, col): (usize, usize)) -> &f64 {
        &self.data[col * self.rows + row]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (row, col): (usize, usize)) -> &mut f64 {
        &mut self.data[col * self.rows + row]
    }
}

/// Scalar product, summed in index order.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (x, y)| sum + x * y)
}

/// Euclidean norm that neither overflows nor underflows on the way; NaN or infinite if an entry is.
pub fn norm(x: &[f64]) -> f64 {
    let plain = dot(x, x);
    if plain > 1e-280 && plain < 1e280 {
        return plain.sqrt();
    }
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return plain.sqrt();
    }
    let scaled = x
        .iter()
        .fold(0.0, |sum, v| sum + (v / largest) * (v / largest));
    largest * scaled.sqrt()
}

/// `target += factor * x`.
pub fn add_scaled(target: &mut [f64], factor: f64, x: &[f64]) {
    for (slot, value) in target.iter_mut().zip(x) {
        *slot += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_definition() {
        let mut a = Matrix::zeros(2, 3);
        for i in 0..2 {
            for j in 0..3 {
                a[(i, j)] = (3 * i + j) as f64;
            }
        }
        assert_eq!(a.multiply(&[1.0, 2.0, 3.0]), [8.0, 26.0]);
        assert_eq!(a.transpose_multiply(&[1.0, 2.0]), [6.0, 9.0, 12.0]);
        a.swap_columns(0, 2);
        assert_eq!(a.select_columns(&[2]).data(), [0.0, 3.0]);
        a.scale_rows(&[1.0, 10.0]);
        assert_eq!(a.data(), [2.0, 50.0, 1.0, 40.0, 0.0, 30.0]);
        let mut b = a.select_columns(&[2]);
        assert_eq!(b.normalise_columns(), [30.0]);
        assert_eq!(b.data(), [0.0, 1.0]);
    }

    #[test]
    fn norm_survives_extreme_scales() {
        assert!((norm(&[3e200, 4e200]) / 5e200 - 1.0).abs() < 1e-15);
        assert!((norm(&[3e-200, 4e-200]) / 5e-200 - 1.0).abs() < 1e-15);
        assert_eq!(norm(&[]), 0.0);
        assert!(norm(&[1.0, f64::NAN]).is_nan());
        assert_eq!(norm(&[1.0, f64::INFINITY]), f64::INFINITY);
    }
}
