//! Of further readings, those by which the variance of predictions falls most.

use super::Unseen;
use crate::gram::Square;
use crate::system::{add_times, dot};

impl Unseen<'_> {
    /// Of further readings like those at `candidates`, each in groups that were never seen: the ones by which the variance of the predictions at
    /// `targets` that is due to coefficients, amplitudes and common columns falls most on average, one after the other, each with its
    /// fall. A reading q with variance v changes the covariance C of these parameters by -C q q'C/(v + q'C q).
    pub fn best_additions(
        &self,
        candidates: &[usize],
        targets: &[usize],
        count: usize,
    ) -> Vec<(usize, f64)> {
        let p = self.root.n;
        let mut sought = Square::zeros(p);
        for &i in targets {
            let q = self.parameters(i);
            for (j, x) in q.iter().enumerate() {
                let row = &mut sought.a[j * p..(j + 1) * p];
                add_times(row, x / targets.len() as f64, &q);
            }
        }
        let rows: Vec<(usize, Vec<f64>, f64)> = candidates
            .iter()
            .map(|&i| (i, self.parameters(i), self.variance_in_new_groups(i)))
            .collect();
        let mut covariance = Square::identity(p);
        let times = |matrix: &Square, x: &[f64]| -> Vec<f64> {
            let rows = matrix.a.chunks_exact(p);
            rows.map(|row| dot(row, x)).collect()
        };
        let mut best = Vec::with_capacity(count);
        for _ in 0..count.min(rows.len()) {
            let gains = rows.iter().map(|(i, q, v)| {
                let moved = times(&covariance, q);
                let total = v + dot(q, &moved);
                let fall = dot(&moved, &times(&sought, &moved)) / total;
                (*i, fall, moved, total)
            });
            let Some((i, fall, moved, total)) = gains.max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            for (j, x) in moved.iter().enumerate() {
                add_times(&mut covariance.a[j * p..(j + 1) * p], -x / total, &moved);
            }
            best.push((i, fall));
        }
        best
    }
}
