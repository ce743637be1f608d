//! What repeated readings show: the error that no model explains.

use super::data::Data;
use super::findings::Question;
use crate::numerics::distributions::f_upper_tail;

/// Name of the question whether the residual differs between set points by more than readings of one set point do.
pub const SET_POINT: &str = "set_point";
/// Residuals of up to so many times the scatter of repeats are no matter of this question: mountings and zeros differ a little from
/// session to session.
const MISFIT: f64 = 2.0;
/// Fewest pairs of repeated readings.
const FEWEST: usize = 10;

/// The question of misfit: mean square of the residual against that of repeats, as an F of which so much is allowed ([`MISFIT`]). A residual
/// whose sign changes from specimen to specimen may depend on no column and yet be no noise. None without repeats.
pub fn between_set_points(data: &Data, residuals: &[f64]) -> Option<Question> {
    let (sd, pairs) = repeats(data, residuals)?;
    let readings = residuals.len() as f64;
    let mean_square = residuals.iter().map(|r| r * r).sum::<f64>() / readings;
    let ratio = mean_square / (sd * sd).max(f64::MIN_POSITIVE);
    let p = f_upper_tail(ratio / (MISFIT * MISFIT), readings, pairs as f64);
    Some(Question {
        column: SET_POINT.to_owned(),
        blocks: format!("nothing: F, beyond {MISFIT} times the scatter of repeats"),
        share: (1.0 - 1.0 / ratio).max(0.0),
        p,
        p_adjusted: p,
    })
}

/// Standard deviation of a reading about its neighbours in pressure from other logs of the same session and direction, N.
pub fn noise_floor(data: &Data, residuals: &[f64]) -> Option<f64> {
    repeats(data, residuals).map(|(sd, _)| sd)
}

/// The same with the number of pairs.
fn repeats(data: &Data, residuals: &[f64]) -> Option<(f64, usize)> {
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
    let pairs = squares.len();
    (pairs >= FEWEST).then(|| ((squares.iter().sum::<f64>() / pairs as f64).sqrt(), pairs))
}
