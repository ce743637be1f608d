//! Cholesky's factor of a matrix of products, for normal equations in which some columns may be superfluous.

use super::matrix::Matrix;

/// A factor L, A = L L', that passes over directions that the ones before them already span.
#[derive(Clone, Debug)]
pub struct Cholesky {
    lower: Matrix,
}

/// A pivot smaller than this part of its diagonal entry is none.
const NO_PIVOT: f64 = 1e-11;

impl Cholesky {
    /// The factor of a symmetric matrix that is not negative.
    pub fn new(gram: &Matrix) -> Self {
        let n = gram.rows();
        let mut lower = Matrix::zeros(n, n);
        for j in 0..n {
            let mut pivot = gram[(j, j)];
            for k in 0..j {
                pivot -= lower[(j, k)] * lower[(j, k)];
            }
            if pivot <= NO_PIVOT * gram[(j, j)] || pivot <= 0.0 {
                continue;
            }
            let root = pivot.sqrt();
            lower[(j, j)] = root;
            for i in j + 1..n {
                let mut x = gram[(i, j)];
                for k in 0..j {
                    x -= lower[(i, k)] * lower[(j, k)];
                }
                lower[(i, j)] = x / root;
            }
        }
        Self { lower }
    }

    /// L^-1 b; 0 where there is no pivot.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let n = b.len();
        let mut x = vec![0.0; n];
        for i in 0..n {
            if self.lower[(i, i)] == 0.0 {
                continue;
            }
            let known: f64 = x[..i]
                .iter()
                .enumerate()
                .map(|(k, v)| self.lower[(i, k)] * v)
                .sum();
            let sum = b[i] - known;
            x[i] = sum / self.lower[(i, i)];
        }
        x
    }

    /// L^-T b; 0 where there is no pivot.
    pub fn backward(&self, b: &[f64]) -> Vec<f64> {
        let n = b.len();
        let mut x = vec![0.0; n];
        for i in (0..n).rev() {
            if self.lower[(i, i)] == 0.0 {
                continue;
            }
            let after = x.iter().enumerate().skip(i + 1);
            let known: f64 = after.map(|(k, v)| self.lower[(k, i)] * v).sum();
            let sum = b[i] - known;
            x[i] = sum / self.lower[(i, i)];
        }
        x
    }

    /// Whether no direction was left out.
    pub fn is_definite(&self) -> bool {
        (0..self.lower.rows()).all(|j| self.lower[(j, j)] > 0.0)
    }

    /// L x.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        self.lower.multiply(x)
    }

    /// L' x.
    pub fn transpose_multiply(&self, x: &[f64]) -> Vec<f64> {
        self.lower.transpose_multiply(x)
    }

    /// The solution of A x = b; 0 in the directions without a pivot.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.backward(&self.forward(b))
    }
}
