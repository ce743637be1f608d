//! Householder QR with column pivoting: `A P = Q R`, and what follows from it.
//!
//! Orthogonal transformations never square the condition number, which is why the fitter, the covariance and the leverages all
//! start here and not from the normal equations. Pivoting puts the numerical rank on show: the diagonal of `R` falls, and a fall
//! to rounding level means that a column is a combination of the ones before it.
//!
//! Sources: Golub and Van Loan, *Matrix Computations*, 4th ed. 2013, algorithms 5.1.1 and 5.4.1; Businger and Golub 1965.

use super::matrix::{Matrix, add_scaled, dot, norm};

/// The factorisation `A P = Q R` of a matrix of any shape (`m` x `n`), with `Q` kept as Householder vectors.
#[derive(Clone, Debug)]
pub struct PivotedQr {
    /// `R` on and above the diagonal, the Householder vectors (first entry 1, not stored) below it.
    factors: Matrix,
    /// Factor of each reflection `I - tau v v^T`.
    tau: Vec<f64>,
    /// Column of `A` that stands at each place of `A P`.
    permutation: Vec<usize>,
}

impl PivotedQr {
    /// Factorises `a`, taking at each step the remaining column of the largest norm (the first of equals).
    pub fn new(a: Matrix) -> Self {
        let steps = a.rows().min(a.cols());
        let mut qr = Self {
            permutation: (0..a.cols()).collect(),
            tau: Vec::with_capacity(steps),
            factors: a,
        };
        for k in 0..steps {
            qr.bring_largest_column_to(k);
            qr.eliminate(k);
        }
        qr
    }

    fn bring_largest_column_to(&mut self, k: usize) {
        let mut best = (k, -1.0);
        for j in k..self.factors.cols() {
            let length = norm(&self.factors.column(j)[k..]);
            if length > best.1 {
                best = (j, length);
            }
        }
        self.factors.swap_columns(k, best.0);
        self.permutation.swap(k, best.0);
    }

    /// Reflects column `k` onto its first `k + 1` entries and carries the others along.
    fn eliminate(&mut self, k: usize) {
        let column = &mut self.factors.column_mut(k)[k..];
        let length = norm(column);
        if length == 0.0 {
            self.tau.push(0.0);
            return;
        }
        let beta = if column[0] > 0.0 { -length } else { length };
        let head = column[0] - beta;
        for entry in &mut column[1..] {
            *entry /= head;
        }
        column[0] = beta;
        let tau = -head / beta;
        self.tau.push(tau);
        for j in k + 1..self.factors.cols() {
            let (v, target) = self.factors.column_pair(k, j);
            reflect(&v[k + 1..], tau, &mut target[k..]);
        }
    }

    /// Column of `A` at each place of `A P`.
    pub fn permutation(&self) -> &[usize] {
        &self.permutation
    }

    /// The upper triangle `R`, `min(m, n)` x `n`.
    pub fn r(&self) -> Matrix {
        let steps = self.tau.len();
        let mut r = Matrix::zeros(steps, self.factors.cols());
        for j in 0..r.cols() {
            for i in 0..steps.min(j + 1) {
                r[(i, j)] = self.factors[(i, j)];
            }
        }
        r
    }

    /// Number of diagonal entries of `R` above `tolerance` times the first: the numerical rank.
    ///
    /// Meaningful for columns of comparable scale; scale them first. See [`PivotedQr::default_tolerance`].
    pub fn rank(&self, tolerance: f64) -> usize {
        let largest = self.factors.data().first().map_or(0.0, |v| v.abs());
        (0..self.tau.len())
            .take_while(|&k| self.factors[(k, k)].abs() > tolerance * largest)
            .count()
    }

    /// `max(m, n)` times the machine epsilon: what rounding alone leaves on the diagonal of a singular matrix.
    pub fn default_tolerance(&self) -> f64 {
        self.factors.rows().max(self.factors.cols()) as f64 * f64::EPSILON
    }

    /// Replaces `b` (`m` entries) by `Q^T b`.
    pub fn apply_q_transposed(&self, b: &mut [f64]) {
        for (k, &tau) in self.tau.iter().enumerate() {
            reflect(&self.factors.column(k)[k + 1..], tau, &mut b[k..]);
        }
    }

    /// Replaces `b` (`m` entries) by `Q b`.
    pub fn apply_q(&self, b: &mut [f64]) {
        for (k, &tau) in self.tau.iter().enumerate().rev() {
            reflect(&self.factors.column(k)[k + 1..], tau, &mut b[k..]);
        }
    }

    /// Solves `R11 z = c` for the leading `rank` columns and puts `z` back into the order of `A`; dropped columns get zero.
    ///
    /// With `c = Q^T b` this is the basic least-squares solution.
    pub fn solve_r(&self, c: &[f64], rank: usize) -> Vec<f64> {
        let z = self.back_substitute(&c[..rank]);
        let mut x = vec![0.0; self.factors.cols()];
        for (&place, value) in self.permutation.iter().zip(z) {
            x[place] = value;
        }
        x
    }

    /// The basic solution of `min ||b - A x||` (`b` has `m` entries), using the leading `rank` pivot columns.
    pub fn solve_least_squares(&self, b: &[f64], rank: usize) -> Vec<f64> {
        let mut c = b.to_vec();
        self.apply_q_transposed(&mut c);
        self.solve_r(&c, rank)
    }

    /// Solves `R11^T w = (P^T v)` for the leading `rank` pivot columns; `v` has `n` entries in the order of `A`.
    pub fn solve_r_transposed(&self, v: &[f64], rank: usize) -> Vec<f64> {
        let mut w: Vec<f64> = Vec::with_capacity(rank);
        for k in 0..rank {
            let known = dot(&self.factors.column(k)[..k], &w);
            w.push((v[self.permutation[k]] - known) / self.factors[(k, k)]);
        }
        w
    }

    /// `R11^-1 c` in pivot order, `c.len()` being the rank used.
    fn back_substitute(&self, c: &[f64]) -> Vec<f64> {
        let mut z = c.to_vec();
        for k in (0..z.len()).rev() {
            z[k] /= self.factors[(k, k)];
            let solved = z[k];
            add_scaled(&mut z[..k], -solved, &self.factors.column(k)[..k]);
        }
        z
    }

    /// `R11^-1`, `rank` x `rank`, in pivot order.
    pub fn r_inverse(&self, rank: usize) -> Matrix {
        let mut inverse = Matrix::zeros(rank, rank);
        for j in 0..rank {
            let mut unit = vec![0.0; rank];
            unit[j] = 1.0;
            inverse
                .column_mut(j)
                .copy_from_slice(&self.back_substitute(&unit));
        }
        inverse
    }

    /// `(A^T A)^-1 = P R^-1 R^-T P^T` in the order of `A`, `n` x `n`; rows and columns beyond `rank` are zero.
    pub fn covariance_factor(&self, rank: usize) -> Matrix {
        let n = self.factors.cols();
        let inverse = self.r_inverse(rank);
        let mut factor = Matrix::zeros(n, n);
        for a in 0..rank {
            for b in 0..rank {
                let product =
                    (a.max(b)..rank).fold(0.0, |s, k| s + inverse[(a, k)] * inverse[(b, k)]);
                factor[(self.permutation[a], self.permutation[b])] = product;
            }
        }
        factor
    }

    /// Leverages: the diagonal of the hat matrix `Q1 Q1^T`, `m` entries between 0 and 1 that add up to `rank`.
    pub fn leverages(&self, rank: usize) -> Vec<f64> {
        let m = self.factors.rows();
        let mut leverages = vec![0.0; m];
        for k in 0..rank {
            let mut q = vec![0.0; m];
            q[k] = 1.0;
            self.apply_q(&mut q);
            for (h, value) in leverages.iter_mut().zip(&q) {
                *h += value * value;
            }
        }
        leverages
    }

    /// A basis of the null space, one row a column of `A` and one column a dropped pivot: `P [-R11^-1 R12; I]`.
    pub fn null_space(&self, rank: usize) -> Matrix {
        let n = self.factors.cols();
        let mut basis = Matrix::zeros(n, n - rank);
        for dropped in rank..n {
            let head = self.back_substitute(&self.factors.column(dropped)[..rank]);
            for (k, value) in head.iter().enumerate() {
                basis[(self.permutation[k], dropped - rank)] = -value;
            }
            basis[(self.permutation[dropped], dropped - rank)] = 1.0;
        }
        basis
    }
}

/// Applies `I - tau v v^T` to `target`, where `v = (1, tail)`.
fn reflect(tail: &[f64], tau: f64, target: &mut [f64]) {
    let factor = tau * (target[0] + dot(tail, &target[1..]));
    target[0] -= factor;
    add_scaled(&mut target[1..], -factor, tail);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Vandermonde matrix with a column scale: full rank, but not trivially so.
    fn example(rows: usize) -> Matrix {
        let mut a = Matrix::zeros(rows, 3);
        for i in 0..rows {
            let x = i as f64 / rows as f64 - 0.3;
            a[(i, 0)] = 1.0;
            a[(i, 1)] = x;
            a[(i, 2)] = 5.0 * x * x;
        }
        a
    }

    fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() < tolerance)
    }

    #[test]
    fn q_times_r_reproduces_the_matrix() {
        for rows in [2, 3, 9] {
            let a = example(rows);
            let qr = PivotedQr::new(a.clone());
            let r = qr.r();
            for j in 0..3 {
                let mut column = r.column(j).to_vec();
                column.resize(rows, 0.0);
                qr.apply_q(&mut column);
                assert!(close(&column, a.column(qr.permutation()[j]), 1e-14));
            }
            let diagonal: Vec<f64> = (0..rows.min(3)).map(|k| r[(k, k)].abs()).collect();
            assert!(diagonal.windows(2).all(|w| w[0] >= w[1]));
        }
    }

    #[test]
    fn least_squares_recovers_exact_coefficients_and_an_orthogonal_residual() {
        let a = example(12);
        let qr = PivotedQr::new(a.clone());
        let mut b = a.multiply(&[2.0, -3.0, 0.5]);
        assert!(close(
            &qr.solve_least_squares(&b, 3),
            &[2.0, -3.0, 0.5],
            1e-13
        ));
        b[4] += 1.0;
        let fitted = a.multiply(&qr.solve_least_squares(&b, 3));
        let residual: Vec<f64> = b.iter().zip(&fitted).map(|(y, f)| y - f).collect();
        assert!(close(&a.transpose_multiply(&residual), &[0.0; 3], 1e-13));
    }

    #[test]
    fn covariance_factor_inverts_the_normal_matrix() {
        let a = example(7);
        let factor = PivotedQr::new(a.clone()).covariance_factor(3);
        for j in 0..3 {
            let column = a.transpose_multiply(&a.multiply(factor.column(j)));
            let mut unit = [0.0; 3];
            unit[j] = 1.0;
            assert!(close(&column, &unit, 1e-12));
        }
    }

    #[test]
    fn leverages_of_a_straight_line_are_the_textbook_ones() {
        let mut a = Matrix::zeros(5, 2);
        for i in 0..5 {
            a[(i, 0)] = 1.0;
            a[(i, 1)] = i as f64;
        }
        let h = PivotedQr::new(a).leverages(2);
        assert!(close(&h, &[0.6, 0.3, 0.2, 0.3, 0.6], 1e-14));
    }

    #[test]
    fn rank_deficiency_is_seen_and_the_null_space_named() {
        let mut a = example(9);
        for i in 0..9 {
            a[(i, 2)] = 2.0 * a[(i, 0)];
        }
        let qr = PivotedQr::new(a.clone());
        let rank = qr.rank(qr.default_tolerance());
        assert_eq!(rank, 2);
        let basis = qr.null_space(rank);
        assert!(close(&a.multiply(basis.column(0)), &[0.0; 9], 1e-14));
        assert_eq!(basis[(1, 0)].abs(), 0.0);
        assert_eq!(PivotedQr::new(Matrix::zeros(4, 2)).rank(1e-12), 0);
    }
}
