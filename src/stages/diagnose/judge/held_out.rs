//! Whether an addition lowers the error on readings that took no part.

use super::super::data::Data;
use super::super::folds::{Fold, Tally};
use super::super::model::{Fitted, Model};
use super::super::search::{Search, State};
use super::super::term::{Scope, Term};
use std::collections::BTreeSet;

/// In which part of the folds the held-out error falls by more than a standard error, and the errors.
pub(super) fn helps(
    search: &Search,
    with: &State,
    without: &State,
    folds: &[Fold],
) -> (f64, Tally, Tally) {
    let (mut helped, mut counted) = (0, 0);
    let (mut before, mut after) = (Tally::default(), Tally::default());
    for fold in folds {
        let train = search.data.select(&fold.train);
        let held = search.data.select(&predictable(search, with, fold));
        if held.is_empty() || train.is_empty() {
            continue;
        }
        let b = squared_errors(search, without, &train, &held);
        let a = squared_errors(search, with, &train, &held);
        before = before.plus(b.0);
        after = after.plus(a.0);
        let better = |x: &[f64], y: &[f64]| {
            let gains: Vec<f64> = x.iter().zip(y).map(|(x, y)| x - y).collect();
            more_than_its_error(&gains, &held)
        };
        counted += 1;
        helped += usize::from(better(&b.1, &a.1) || better(&b.2, &a.2));
    }
    let part = if counted > 0 {
        f64::from(helped as u32) / f64::from(counted as u32)
    } else {
        0.0
    };
    (part, before, after)
}

/// Folds that leave every session in: a third of its logs (of its readings, where it has fewer than three) at a time.
pub(super) fn log_folds(data: &Data) -> Vec<Fold> {
    let mut logs: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); data.sessions.len()];
    for i in 0..data.len() {
        logs[data.session[i]].insert(data.log[i]);
    }
    let many = logs.iter().filter(|l| !l.is_empty()).all(|l| l.len() >= 3);
    let part = |i: usize| {
        if many {
            logs[data.session[i]]
                .iter()
                .position(|l| *l == data.log[i])
                .unwrap_or(0)
                % 3
        } else {
            i % 3
        }
    };
    (0..3)
        .map(|k| Fold {
            unit: format!("third {}", k + 1),
            train: (0..data.len()).filter(|i| part(*i) != k).collect(),
            held_out: (0..data.len()).filter(|i| part(*i) == k).collect(),
        })
        .collect()
}

/// The held-out readings of a fold, less those of a session or specimen that has a value of its own in the model which the fold's other
/// readings say nothing of.
fn predictable(search: &Search, state: &State, fold: &Fold) -> Vec<usize> {
    let data = search.data;
    let seen: BTreeSet<usize> = fold.train.iter().map(|i| data.session[*i]).collect();
    let parts: Vec<&Term> = state
        .chosen
        .iter()
        .map(|c| &search.candidates[*c])
        .filter(|t| matches!(t.scope, Scope::Session(_) | Scope::Specimen(_)))
        .collect();
    let hidden = |i: &usize| {
        parts.iter().any(|t| {
            t.acts_on[data.session[*i]].is_some() && !seen.iter().any(|s| t.acts_on[*s].is_some())
        })
    };
    fold.held_out
        .iter()
        .copied()
        .filter(|i| !hidden(i))
        .collect()
}

/// The tally and the squared error of each held-out reading: with the held-out specimen's own strength, and with the mean one. An effect
/// that acts alike on all readings of a specimen (resting length) shows in the second only.
pub(super) fn squared_errors(
    search: &Search,
    state: &State,
    train: &Data,
    held: &Data,
) -> (Tally, Vec<f64>, Vec<f64>) {
    let terms: Vec<Term> = state
        .chosen
        .iter()
        .map(|c| search.candidates[*c].clone())
        .collect();
    let fitted = refit(search, terms.clone(), &state.fitted, train);
    let there = Model {
        base: search.base,
        data: held,
        terms,
    };
    let predicted = there.predict(&fitted, true);
    let own = there.predict_with_own_strength(&fitted);
    let squares = |f: &[f64]| -> Vec<f64> {
        let pairs = held.force.iter().zip(f);
        pairs.map(|(y, f)| (y - f) * (y - f)).collect()
    };
    (
        Tally::of(&held.force, &predicted, &own),
        squares(&own),
        squares(&predicted),
    )
}

/// The same terms fitted to other readings; specimens that are not among them have the mean strength.
pub fn refit(search: &Search, terms: Vec<Term>, from: &Fitted, train: &Data) -> Fitted {
    let model = Model {
        base: search.base,
        data: train,
        terms,
    };
    model.fit(Some(from), 0)
}

/// Whether the mean gain over sessions (over logs, where there are fewer than three sessions) exceeds its standard error.
pub(super) fn more_than_its_error(gains: &[f64], held: &Data) -> bool {
    let sessions: BTreeSet<usize> = held.session.iter().copied().collect();
    let group = if sessions.len() >= 3 {
        &held.session
    } else {
        &held.log
    };
    let groups: BTreeSet<usize> = group.iter().copied().collect();
    let sums: Vec<f64> = groups
        .iter()
        .map(|g| {
            gains
                .iter()
                .zip(group)
                .filter(|(_, h)| *h == g)
                .map(|(x, _)| x)
                .sum()
        })
        .collect();
    let n = sums.len() as f64;
    let mean = sums.iter().sum::<f64>() / n;
    if sums.len() < 2 {
        return mean > 0.0;
    }
    let variance = sums.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    mean > (variance / n).sqrt()
}
