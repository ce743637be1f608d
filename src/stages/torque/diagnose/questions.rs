//! Whether what a fit leaves depends on anything: every column asked, by flipping the signs of whole stretches.
//!
//! Where nothing is missing, what a stretch of angles leaves is as likely to have the other sign; flipping it keeps how alike its readings are, which
//! flipping (or shuffling) readings would not. What tests and actuators have of their own is taken off before.

use super::refit::{Reading, Sizes};
use super::search::Sample;
use crate::base::random::Stream;
use crate::numerics::matrix::{dot, norm};
use std::collections::BTreeSet;

/// Largest corrected probability.
const SIGNIFICANT: f64 = 0.05;
const FLIPS: usize = 999;
/// Powers of a column beside the constant.
const POWERS: usize = 5;

/// Whether what is left depends on a column.
#[derive(Clone, Debug)]
pub struct Question {
    /// Column.
    pub column: String,
    /// Share of the sum of squares that it explains.
    pub share: f64,
    /// Probability of as much by chance, corrected for the number of questions (Holm).
    pub p_adjusted: f64,
}

/// A column and its values, one a reading.
pub struct Asked {
    /// Name, as in files.
    pub column: String,
    /// Values.
    pub values: Vec<f64>,
}

/// The columns that vary within tests.
pub fn columns(readings: &[Reading], sizes: &Sizes, extras: &[(String, Vec<f64>)]) -> Vec<Asked> {
    let asked = |column: &str, of: &dyn Fn(&Reading) -> f64| Asked {
        column: column.to_owned(),
        values: readings.iter().map(of).collect(),
    };
    let mut all = vec![
        asked("angle", &|r| r.at.angle_rad.to_degrees()),
        asked("predicted_torque", &|r| sizes.predict(r).0),
        asked("sense_of_motion", &|r| r.at.sense),
        asked("order", &|r| r.at.order),
        asked("pressure", &|r| r.at.pressure_kpa),
    ];
    all.extend(extras.iter().map(|(column, values)| Asked {
        column: column.clone(),
        values: values.clone(),
    }));
    all.retain(|a| a.values.iter().all(|v| v.is_finite()) && varies_within_tests(a, readings));
    all
}

fn varies_within_tests(asked: &Asked, readings: &[Reading]) -> bool {
    let mut pairs = readings
        .windows(2)
        .zip(asked.values.windows(2))
        .filter(|(r, _)| r[0].test == r[1].test);
    pairs.any(|(_, v)| v[0] != v[1])
}

/// The answers, in the order of the columns, for a fit to a sample.
pub fn ask(sample: &Sample, sizes: &Sizes, asked: &[Asked]) -> Vec<Question> {
    let left = sample.conditional(sizes);
    let units: BTreeSet<usize> = sample.readings.iter().map(|r| r.unit).collect();
    let units: Vec<usize> = units.into_iter().collect();
    let place = |r: &Reading| units.binary_search(&r.unit).unwrap_or(0);
    let of_reading: Vec<usize> = sample.readings.iter().map(place).collect();
    let bases: Vec<Vec<Vec<f64>>> = asked.iter().map(|a| powers(&a.values)).collect();
    let share = |basis: &[Vec<f64>], left: &[f64]| {
        let along = basis.iter().map(|b| dot(b, left)).map(|x| x * x);
        along.sum::<f64>() / dot(left, left)
    };
    let shares: Vec<f64> = bases.iter().map(|b| share(b, &left)).collect();
    let mut as_large = vec![1.0; asked.len()];
    let mut stream = Stream::new(1, &["torque questions"]);
    for _ in 0..FLIPS {
        let signs: Vec<f64> = units.iter().map(|_| sign(&mut stream)).collect();
        let flipped = left
            .iter()
            .zip(&of_reading)
            .map(|(r, unit)| r * signs[*unit]);
        let flipped: Vec<f64> = flipped.collect();
        for (count, (basis, found)) in as_large.iter_mut().zip(bases.iter().zip(&shares)) {
            if share(basis, &flipped) >= *found - 1e-12 {
                *count += 1.0;
            }
        }
    }
    let p: Vec<f64> = as_large.iter().map(|c| c / (FLIPS + 1) as f64).collect();
    let adjusted = holm(&p);
    let question = |k: usize| Question {
        column: asked[k].column.clone(),
        share: shares[k],
        p_adjusted: adjusted[k],
    };
    (0..asked.len()).map(question).collect()
}

/// Whether an answer says that there is structure.
pub fn is_structure(question: &Question) -> bool {
    question.p_adjusted < SIGNIFICANT
}

fn sign(stream: &mut Stream) -> f64 {
    if stream.uniform() < 0.5 { -1.0 } else { 1.0 }
}

/// Orthonormal powers of a column, the constant among them.
fn powers(values: &[f64]) -> Vec<Vec<f64>> {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(*v), h.max(*v))
        });
    let scaled = |v: &f64| 2.0 * (v - low) / (high - low) - 1.0;
    let mut column = vec![1.0; values.len()];
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for _ in 0..=POWERS {
        let mut own = column.clone();
        super::nuisance::reduce(&mut own, &basis);
        let length = norm(&own);
        if length > 1e-6 * norm(&column) {
            own.iter_mut().for_each(|x| *x /= length);
            basis.push(own);
        }
        column
            .iter_mut()
            .zip(values)
            .for_each(|(x, v)| *x *= scaled(v));
    }
    basis
}

/// Holm's correction (*Scandinavian Journal of Statistics* 6, 1979).
fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let mut adjusted = vec![1.0; p.len()];
    let mut largest = 0.0_f64;
    for (rank, k) in order.into_iter().enumerate() {
        largest = largest.max((p.len() - rank) as f64 * p[k]).min(1.0);
        adjusted[k] = largest;
    }
    adjusted
}
