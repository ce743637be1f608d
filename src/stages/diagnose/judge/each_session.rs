//! An effect with a value for every session: judged by itself, because such values can take up any misfit.

use super::super::data::Data;
use super::super::findings::Rejected;
use super::super::folds::{Fold, Tally};
use super::super::search::{Search, State, relative_fall};
use super::super::term::Scope;
use super::held_out::{more_than_its_error, squared_errors};
use super::{Judgement, acts_on, judge, name};
use crate::numerics::cholesky::Cholesky;
use crate::numerics::matrix::Matrix;

/// A held-out error that is larger by less than this is not larger.
const NOT_WORSE: f64 = 1.03;

/// Share of the variance of the sessions' values above which they are no error of the sessions.
const MISFIT: f64 = 0.5;

/// The same with an effect that has a value for every session, if all of it passes and the error on specimens that took no part is not
/// larger for it: such values can take up any misfit of the base model that goes with the set length.
pub fn with_each_session(
    search: &Search,
    state: State,
    judgements: Vec<Judgement>,
    folds: &[Fold],
    seed: u64,
) -> (State, Vec<Judgement>, Option<Rejected>) {
    let Some(larger) = search.with_each_session(&state) else {
        return (state, judgements, None);
    };
    let judged: Vec<Judgement> = (0..larger.chosen.len())
        .map(|k| judge(search, &larger, k, folds, seed))
        .collect();
    let (mut before, mut after, mut worse) = (Tally::default(), Tally::default(), 0);
    for fold in folds {
        let train = search.data.select(&fold.train);
        let held = search.data.select(&fold.held_out);
        let b = squared_errors(search, &state, &train, &held);
        let a = squared_errors(search, &larger, &train, &held);
        (before, after) = (before.plus(b.0), after.plus(a.0));
        let increase: Vec<f64> = a.2.iter().zip(&b.2).map(|(a, b)| a - b).collect();
        worse += usize::from(more_than_its_error(&increase, &held));
    }
    let (before, after) = (before.rmse(), after.rmse());
    // Values that were drawn for the sessions say nothing of others, and what they leave of the coefficients is less sure: a little
    // larger by chance is not worse.
    let worse = after > NOT_WORSE * before && 2 * worse > folds.len();
    let fails = judged.iter().find_map(|j| j.fails.clone());
    let misfit = larger
        .chosen
        .iter()
        .zip(&larger.fitted.terms)
        .find_map(|(c, (values, _))| {
            let each = search.candidates[*c].scope == Scope::EachSession;
            each.then(|| goes_with_contraction(search.data, values))
        });
    let why = match fails {
        Some(why) => why,
        None if misfit.unwrap_or(0.0) > MISFIT => {
            let share = 100.0 * misfit.unwrap_or(0.0);
            format!(
                "{share:.0}% of its variance goes with the set contraction: a misfit of the surface, not of the sessions"
            )
        }
        None if worse => {
            format!("the error on held-out specimens would go from {before:.1} N to {after:.1} N")
        }
        None => return (larger, judged, None),
    };
    let term = larger
        .chosen
        .iter()
        .map(|c| &search.candidates[*c])
        .find(|t| t.scope == Scope::EachSession);
    let rejected = term.map(|t| Rejected {
        form: t.form().map(|f| f.name.to_owned()),
        id: name(t, search.data),
        acts_on: acts_on(t, search.data),
        share: relative_fall(&state, &larger),
        why,
    });
    (state, judgements, rejected)
}

/// The share of the variance of the sessions' values that a parabola over the set contraction explains.
fn goes_with_contraction(data: &Data, values: &[f64]) -> f64 {
    let mut contraction: Vec<Option<f64>> = vec![None; data.sessions.len()];
    for (s, c) in data.session.iter().zip(&data.conditions) {
        contraction[*s] =
            Some((c.rest_length_m - c.length_m) / (c.rest_length_m - c.contracted_length_m));
    }
    let points: Vec<(f64, f64)> = contraction
        .iter()
        .zip(values)
        .filter_map(|(x, y)| Some(((*x)?, *y)))
        .collect();
    let n = points.len() as f64;
    let centre = points.iter().map(|p| p.1).sum::<f64>() / n;
    let total: f64 = points.iter().map(|p| (p.1 - centre) * (p.1 - centre)).sum();
    let mut gram = Matrix::zeros(3, 3);
    let mut right = vec![0.0; 3];
    for (x, y) in &points {
        let row = [1.0, *x, x * x];
        for a in 0..3 {
            right[a] += row[a] * (y - centre);
            for b in 0..3 {
                gram[(a, b)] += row[a] * row[b];
            }
        }
    }
    let explained: f64 = Cholesky::new(&gram)
        .forward(&right)
        .iter()
        .map(|z| z * z)
        .sum();
    if total > 0.0 { explained / total } else { 0.0 }
}
