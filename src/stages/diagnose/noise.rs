//! What repeated readings show: the error that no model explains.

use super::data::Data;

/// Standard deviation of a reading about its neighbours in pressure from other logs of the same session and direction, N.
pub fn noise_floor(data: &Data, residuals: &[f64]) -> Option<f64> {
    let mut keyed: Vec<(usize, i64, f64, usize)> = (0..data.len())
        .map(|i| {
            (
                data.session[i],
                data.conditions[i].direction as i64,
                data.conditions[i].pressure_kpa,
                i,
            )
        })
        .collect();
    keyed.sort_by(|a, b| {
        a.0.cmp(&b.0)
            .then(a.1.cmp(&b.1))
            .then(a.2.total_cmp(&b.2))
            .then(a.3.cmp(&b.3))
    });
    let near = |w: &[(usize, i64, f64, usize)]| {
        let (a, b) = (&w[0], &w[1]);
        a.0 == b.0 && a.1 == b.1 && (a.2 - b.2).abs() < 15.0 && data.log[a.3] != data.log[b.3]
    };
    let squares: Vec<f64> = keyed
        .windows(2)
        .filter(|w| near(w))
        .map(|w| {
            let d = residuals[w[0].3] - residuals[w[1].3];
            0.5 * d * d
        })
        .collect();
    (squares.len() >= 10).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}
