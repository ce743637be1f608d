//! What a Jacobian says about its parameters: the covariance factor `(J^T J)^-1`, and which of them it does not determine.
//!
//! Columns are brought to unit length before the rank is decided, so that units do not matter. A parameter is not identified if
//! it takes part in a combination that leaves every row unchanged, that is, if its row of the null space is not zero.
//!
//! Source: Golub and Van Loan, *Matrix Computations*, 4th ed. 2013, section 5.5.

use super::matrix::{Matrix, norm};
use super::qr::PivotedQr;

/// A share in a direction of the null space below this is rounding.
const NULL_SHARE: f64 = 1e-8;

/// The covariance factor and the parameters without one.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// `(J^T J)^-1`, `n` x `n`; NaN in the rows and columns of parameters that are held or not identified.
    pub covariance_factor: Matrix,
    /// Indices of the free parameters that the rows do not determine, ascending.
    pub unidentified: Vec<usize>,
}

/// Analyses the columns `free` of `jacobian` (`m` x `n`); the other parameters are held.
pub fn identify(jacobian: &Matrix, free: &[usize]) -> Identification {
    let n = jacobian.cols();
    let mut scaled = jacobian.select_columns(free);
    let lengths = scaled.normalise_columns();
    let qr = PivotedQr::new(scaled);
    let rank = qr.rank(qr.default_tolerance());
    let null = qr.null_space(rank);
    let lost: Vec<bool> = (0..free.len())
        .map(|k| (0..null.cols()).any(|c| null[(k, c)].abs() > NULL_SHARE * norm(null.column(c))))
        .collect();
    let factor = qr.covariance_factor(rank);
    let mut covariance_factor = Matrix::zeros(n, n);
    for j in 0..n {
        covariance_factor.column_mut(j).fill(f64::NAN);
    }
    for (a, &row) in free.iter().enumerate() {
        for (b, &col) in free.iter().enumerate() {
            if !lost[a] && !lost[b] {
                covariance_factor[(row, col)] = factor[(a, b)] / lengths[a] / lengths[b];
            }
        }
    }
    Identification {
        covariance_factor,
        unidentified: (0..free.len())
            .filter(|&k| lost[k])
            .map(|k| free[k])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns 1, x, 2e6 (a multiple of the first), 0.
    fn deficient() -> Matrix {
        let mut j = Matrix::zeros(5, 4);
        for i in 0..5 {
            j[(i, 0)] = 1.0;
            j[(i, 1)] = i as f64;
            j[(i, 2)] = 2e6;
        }
        j
    }

    #[test]
    fn only_the_parameters_of_the_null_space_are_lost() {
        let found = identify(&deficient(), &[0, 1, 2, 3]);
        assert_eq!(found.unidentified, [0, 2, 3]);
        assert!((found.covariance_factor[(1, 1)] - 0.1).abs() < 1e-14);
        assert!(found.covariance_factor[(0, 1)].is_nan());
    }

    #[test]
    fn held_parameters_make_the_others_identified() {
        let found = identify(&deficient(), &[1, 2]);
        assert!(found.unidentified.is_empty());
        let expected = 0.6 / 4e12;
        assert!((found.covariance_factor[(2, 2)] / expected - 1.0).abs() < 1e-13);
        assert!(found.covariance_factor[(0, 0)].is_nan());
    }
}
