//! How well the parameters of a fitted model are known: by leaving out sessions, or specimens.
//!
//! Readings of a session share its set-up, so each session counts once: the interval is the jackknife over sessions (Efron 1982), in one
//! Gauss-Newton step each. Where a parameter draws its information from differences *between* specimens (the strengths being free, most of
//! it would be gone), each specimen counts once. A value that belongs to one session has no other sessions to be compared with, and its
//! interval is that of the effective number of its readings.

use super::data::Data;
use super::model::{Fitted, Model, Place, STRENGTH};
use super::term::Scope;
use crate::numerics::cholesky::Cholesky;
use crate::numerics::distributions::{student_t_quantile, student_t_two_sided};
use crate::numerics::matrix::Matrix;

/// A standard error with its degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Standard error.
    pub error: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Uncertainty {
    /// Half of the 95% interval.
    pub fn half_width(self) -> f64 {
        student_t_quantile(0.975, self.freedom) * self.error
    }

    /// Probability of a value this far from 0 by chance.
    pub fn p(self, value: f64) -> f64 {
        if self.error > 0.0 {
            student_t_two_sided(value / self.error, self.freedom)
        } else {
            1.0
        }
    }
}

/// The sums over one cluster.
struct Part {
    gram: Matrix,
    score: Vec<f64>,
}

/// Below this share of the information from within specimens, specimens are counted instead of sessions.
const WITHIN: f64 = 0.5;
/// Fewest clusters of a jackknife.
const FEWEST: usize = 4;

/// What stands for a parameter that is held.
const HELD: f64 = 1e30;

/// The uncertainty of every parameter of [`Model::layout`], those in `held` taken as known. `effective` is the effective number of
/// readings.
pub fn uncertainties(
    model: &Model,
    fitted: &Fitted,
    effective: f64,
    held: &[Place],
) -> Vec<Uncertainty> {
    let data = model.data;
    let layout = model.layout();
    let p = layout.len();
    let penalty = penalties(&layout, fitted, held);
    let parts = parts(model, fitted, &layout);
    let mut total = Matrix::zeros(p, p);
    for part in &parts {
        add(&mut total, &part.gram, 1.0);
    }
    let inverse = inverse(&total, &penalty);
    let weak: Vec<f64> = penalty
        .iter()
        .map(|x| if *x < HELD { x * 1e-6 } else { *x })
        .collect();
    let free = self::inverse(&total, &weak);
    let inflation = (data.len() as f64 / effective).max(1.0);
    let sessions: Vec<Vec<usize>> = (0..parts.len())
        .filter(|s| parts[*s].gram.data().iter().any(|x| *x != 0.0))
        .map(|s| vec![s])
        .collect();
    let of = data.specimen_of_session();
    let specimens: Vec<Vec<usize>> = (0..data.specimens.len())
        .map(|k| {
            sessions
                .iter()
                .flatten()
                .copied()
                .filter(|s| of[*s] == k)
                .collect::<Vec<usize>>()
        })
        .filter(|list| !list.is_empty())
        .collect();
    let by_session = jackknife(&total, &parts, &sessions, &penalty);
    let by_specimen = jackknife(&total, &parts, &specimens, &penalty);
    (0..p)
        .map(|k| {
            let by_readings = Uncertainty {
                error: fitted.sigma * (inverse[k] * inflation).max(0.0).sqrt(),
                freedom: (effective - p as f64).max(2.0),
            };
            let alone = match layout[k] {
                Place::Amplitude(t, _) | Place::Shape(t) => {
                    matches!(model.terms[t].scope, Scope::Session(_) | Scope::EachSession)
                }
                Place::Strength(_) => true,
                Place::Base(_) => false,
            };
            let within = inverse[k] / free[k].max(f64::MIN_POSITIVE);
            if alone {
                by_readings
            } else if within < WITHIN && specimens.len() >= FEWEST {
                wider(by_specimen[k], by_readings)
            } else if sessions.len() >= FEWEST {
                wider(by_session[k], by_readings)
            } else {
                by_readings
            }
        })
        .collect()
}

/// The wider of two: a jackknife over few clusters is small by chance as often as it is large.
fn wider(a: Uncertainty, b: Uncertainty) -> Uncertainty {
    if a.half_width() >= b.half_width() {
        a
    } else {
        b
    }
}

fn penalties(layout: &[Place], fitted: &Fitted, held: &[Place]) -> Vec<f64> {
    let ratio = (fitted.sigma / fitted.scatter) * (fitted.sigma / fitted.scatter);
    let of = |p: &Place| match p {
        p if held.contains(p) => HELD,
        Place::Strength(_) => ratio,
        _ => 0.0,
    };
    layout.iter().map(of).collect()
}

fn parts(model: &Model, fitted: &Fitted, layout: &[Place]) -> Vec<Part> {
    let data: &Data = model.data;
    let p = layout.len();
    let of = data.specimen_of_session();
    let mut parts: Vec<Part> = (0..data.sessions.len())
        .map(|_| Part {
            gram: Matrix::zeros(p, p),
            score: vec![0.0; p],
        })
        .collect();
    let slots: Vec<Vec<(usize, usize)>> = (0..data.sessions.len())
        .map(|s| {
            layout
                .iter()
                .enumerate()
                .filter_map(|(k, place)| Some((k, model.slot(*place, s, of[s])?)))
                .collect()
        })
        .collect();
    debug_assert!(STRENGTH < fitted.traces.len());
    for i in 0..data.len() {
        let s = data.session[i];
        let part = &mut parts[s];
        for (a, slot_a) in &slots[s] {
            let x = fitted.traces[*slot_a][i];
            part.score[*a] += x * fitted.residuals[i];
            for (b, slot_b) in &slots[s] {
                part.gram[(*a, *b)] += x * fitted.traces[*slot_b][i];
            }
        }
    }
    parts
}

fn add(target: &mut Matrix, part: &Matrix, factor: f64) {
    for j in 0..target.cols() {
        for i in 0..target.rows() {
            target[(i, j)] += factor * part[(i, j)];
        }
    }
}

/// The diagonal of the inverse.
fn inverse(gram: &Matrix, penalty: &[f64]) -> Vec<f64> {
    let mut penalised = gram.clone();
    for (k, w) in penalty.iter().enumerate() {
        penalised[(k, k)] += w;
    }
    let factor = Cholesky::new(&penalised);
    (0..penalty.len())
        .map(|k| {
            let mut unit = vec![0.0; penalty.len()];
            unit[k] = 1.0;
            factor.solve(&unit)[k]
        })
        .collect()
}

/// The jackknife over clusters of sessions.
fn jackknife(
    total: &Matrix,
    parts: &[Part],
    clusters: &[Vec<usize>],
    penalty: &[f64],
) -> Vec<Uncertainty> {
    let (p, g) = (penalty.len(), clusters.len() as f64);
    let moves: Vec<Vec<f64>> = clusters
        .iter()
        .map(|cluster| {
            let mut left = total.clone();
            let mut score = vec![0.0; p];
            for s in cluster {
                add(&mut left, &parts[*s].gram, -1.0);
                for (sum, x) in score.iter_mut().zip(&parts[*s].score) {
                    *sum -= x;
                }
            }
            for k in 0..p {
                left[(k, k)] += penalty[k];
            }
            Cholesky::new(&left).solve(&score)
        })
        .collect();
    (0..p)
        .map(|k| {
            let mean = moves.iter().map(|m| m[k]).sum::<f64>() / g;
            let squares: f64 = moves.iter().map(|m| (m[k] - mean) * (m[k] - mean)).sum();
            Uncertainty {
                error: ((g - 1.0) / g * squares).sqrt(),
                freedom: (g - 1.0).max(1.0),
            }
        })
        .collect()
}
