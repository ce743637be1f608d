//! The held-out error, with the whole search inside each fold.
//!
//! Where the owner of the data held sessions out, they are the one fold. Else each specimen is left out in turn (each session below three
//! specimens, each log below three sessions); coefficients, effects and their sizes are found anew without it.

use super::data::Data;
use std::collections::BTreeSet;

/// Readings that are searched, and readings that are predicted.
#[derive(Clone, Debug)]
pub struct Fold {
    /// What is held out, in words.
    pub unit: String,
    /// Places of the readings that are searched.
    pub train: Vec<usize>,
    /// Places of the readings that are predicted.
    pub held_out: Vec<usize>,
}

/// The folds of a campaign, and how they are called; `kept_out` marks readings that their owner held out.
pub fn folds(data: &Data, kept_out: &[bool]) -> (Vec<Fold>, &'static str) {
    let train: Vec<usize> = (0..data.len()).filter(|i| !kept_out[*i]).collect();
    let kept: Vec<usize> = (0..data.len()).filter(|i| kept_out[*i]).collect();
    if !kept.is_empty() {
        let specimens: BTreeSet<usize> = kept.iter().map(|i| data.specimen[*i]).collect();
        let unit = |k: usize| Fold {
            unit: data.specimens[k].clone(),
            train: train.clone(),
            held_out: kept
                .iter()
                .copied()
                .filter(|i| data.specimen[*i] == k)
                .collect(),
        };
        return (specimens.into_iter().map(unit).collect(), "holdout");
    }
    let specimens = by(&train, &data.specimen, |k| data.specimens[k].clone());
    if specimens.len() >= 3 {
        return (specimens, "leave-one-specimen-out");
    }
    let sessions = by(&train, &data.session, |k| data.sessions[k].clone());
    if sessions.len() >= 3 {
        return (sessions, "leave-one-session-out");
    }
    let logs = by(&train, &data.log, |k| format!("log {}", k + 1));
    if logs.len() >= 3 {
        return (logs, "leave-one-log-out");
    }
    let lengths: BTreeSet<u64> = train
        .iter()
        .map(|i| data.conditions[*i].length_m.to_bits())
        .collect();
    let lengths: Vec<u64> = lengths.into_iter().collect();
    let of_length: Vec<usize> = (0..data.len())
        .map(|i| {
            lengths
                .iter()
                .position(|l| *l == data.conditions[i].length_m.to_bits())
                .unwrap_or(0)
        })
        .collect();
    (
        by(&train, &of_length, |k| {
            format!("length {:.1} mm", 1e3 * f64::from_bits(lengths[k]))
        }),
        "leave-one-length-out",
    )
}

fn by(train: &[usize], group: &[usize], name: impl Fn(usize) -> String) -> Vec<Fold> {
    let groups: BTreeSet<usize> = train.iter().map(|i| group[*i]).collect();
    let fold = |k: usize| Fold {
        unit: name(k),
        train: train.iter().copied().filter(|i| group[*i] != k).collect(),
        held_out: train.iter().copied().filter(|i| group[*i] == k).collect(),
    };
    groups.into_iter().map(fold).collect()
}

/// Squared errors summed, and the largest.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Sum of squares, N^2.
    pub squares: f64,
    /// Sum of squares with each specimen's own strength, N^2.
    pub own_strength: f64,
    /// Largest absolute error, N.
    pub largest: f64,
    /// Readings.
    pub n: usize,
}

impl Tally {
    /// The errors of predictions: with mean strengths, and with each specimen's own.
    pub fn of(measured: &[f64], predicted: &[f64], own: &[f64]) -> Self {
        let mut tally = Self {
            n: measured.len(),
            ..Self::default()
        };
        for ((y, f), g) in measured.iter().zip(predicted).zip(own) {
            tally.squares += (y - f) * (y - f);
            tally.own_strength += (y - g) * (y - g);
            tally.largest = tally.largest.max((y - f).abs());
        }
        tally
    }

    /// With another one.
    pub fn plus(self, other: Self) -> Self {
        Self {
            squares: self.squares + other.squares,
            own_strength: self.own_strength + other.own_strength,
            largest: self.largest.max(other.largest),
            n: self.n + other.n,
        }
    }

    /// Root of the mean square, N.
    pub fn rmse(self) -> f64 {
        (self.squares / self.n.max(1) as f64).sqrt()
    }

    /// The same with each specimen's own strength, N.
    pub fn rmse_own_strength(self) -> f64 {
        (self.own_strength / self.n.max(1) as f64).sqrt()
    }
}
