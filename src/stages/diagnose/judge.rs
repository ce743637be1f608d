//! Which of the chosen additions may be believed, and what is said of each.
//!
//! An addition stays only if its t is significant after correction for all candidates, if the criterion still wants it, if its size lies
//! inside its physical bounds, if it lowers the error on readings that took no part by more than that improvement's standard error
//! in most folds, and if it is chosen again in nine of ten resamples of the specimens.

use super::between;
use super::candidates::choices;
use super::data::Data;
use super::findings::Rejected;
use super::folds::{Fold, Tally};
use super::linear::Linear;
use super::model::{Fitted, Model, Place};
use super::search::{Search, State, relative_fall};
use super::term::{Empirical, Scope, Term, What};
use super::uncertainty::{Uncertainty, uncertainties};
use crate::base::random::Stream;
use crate::numerics::cholesky::Cholesky;
use crate::numerics::distributions::f_upper_tail;
use crate::numerics::matrix::Matrix;
use std::collections::BTreeSet;

/// Largest corrected p of an addition: on all readings, and in a fold, which has fewer.
pub const SIGNIFICANT: (f64, f64) = (0.05, 0.05);
/// Least part of the resamples in which it is chosen again.
pub const CHOSEN_AGAIN: f64 = 0.9;
/// Least part of the folds in which it helps.
pub const HELPS: f64 = 0.5;
/// A held-out error that is larger by less than this is not larger.
const NOT_WORSE: f64 = 1.03;
/// Share of the variance of the sessions' values above which they are no error of the sessions.
const MISFIT: f64 = 0.5;
const RESAMPLES: usize = 40;
/// Two traces with a larger cosine are one class.
pub const ALIKE: f64 = 0.9;

/// What is known of one chosen addition.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// Place in the list of candidates.
    pub candidate: usize,
    /// Its p, times the number of candidates.
    pub p_adjusted: f64,
    /// Gain in the criterion.
    pub criterion_gain: f64,
    /// Share of the sum of squares that only it explains.
    pub share: f64,
    /// Part of the resamples that choose it or one of its class.
    pub chosen_again: f64,
    /// Part of the folds in which it lowers the held-out error by more than a standard error.
    pub helps: f64,
    /// Held-out error without it and with it, own strengths, N.
    pub held_out: (f64, f64),
    /// Whether the held-out error over all folds falls, with own strengths or with mean ones.
    pub falls: bool,
    /// RMSE of training without it and with it, strengths included, N.
    pub train: (f64, f64),
    /// Candidates that it cannot be told from.
    pub class: Vec<usize>,
    /// Why it goes, if it does.
    pub fails: Option<String>,
}

/// The largest of some models, the best of their sizes, of which every addition passes; if there is none, what is left of the
/// first after what fails was removed, worst first.
pub fn judged(
    search: &Search,
    states: &[State],
    folds: &[Fold],
    seed: u64,
) -> (State, Vec<Judgement>, Vec<Rejected>) {
    let all_of = |state: &State| -> Vec<Judgement> {
        (0..state.chosen.len())
            .map(|k| judge(search, state, k, folds, seed))
            .collect()
    };
    let mut rejected: Vec<Rejected> = Vec::new();
    for state in states.iter().filter(|s| !s.chosen.is_empty()) {
        // The last one in is the likeliest to fail, and one failure is enough.
        let mut judgements = Vec::new();
        for k in (0..state.chosen.len()).rev() {
            let judgement = judge(search, state, k, folds, seed);
            let why = judgement.fails.clone();
            judgements.insert(0, judgement);
            if let Some(why) = why {
                let term = &search.candidates[state.chosen[k]];
                let failed = Rejected {
                    id: name(term, search.data),
                    acts_on: acts_on(term, search.data),
                    share: judgements[0].share,
                    why,
                };
                // What is said of it in the smallest model says most.
                rejected.retain(|q| q.id != failed.id || q.acts_on != failed.acts_on);
                rejected.push(failed);
                break;
            }
        }
        if judgements.iter().all(|j| j.fails.is_none()) {
            return (state.clone(), judgements, rejected);
        }
    }
    let Some(mut state) = states.first().cloned() else {
        return (search.state(Vec::new(), None), Vec::new(), rejected);
    };
    loop {
        let judgements = all_of(&state);
        let worst = judgements
            .iter()
            .enumerate()
            .filter(|(_, j)| j.fails.is_some())
            .min_by(|a, b| {
                // What acts on a part of the campaign goes first: it can imitate anything there.
                let whole = |j: &Judgement| search.candidates[j.candidate].scope == Scope::Whole;
                whole(a.1)
                    .cmp(&whole(b.1))
                    .then(a.1.share.total_cmp(&b.1.share))
            })
            .map(|(k, _)| k);
        let Some(k) = worst else {
            return (state, judgements, rejected);
        };
        let mut chosen = state.chosen.clone();
        chosen.remove(k);
        state = search.state(chosen, None);
    }
}

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
    let errors = |s: &State| {
        let parts = folds.iter().map(|f| {
            squared_errors(
                search,
                s,
                &search.data.select(&f.train),
                &search.data.select(&f.held_out),
            )
            .0
        });
        parts.fold(Tally::default(), Tally::plus)
    };
    let (before, after) = (errors(&state).rmse(), errors(&larger).rmse());
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
        None if after > NOT_WORSE * before => {
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

fn judge(search: &Search, state: &State, k: usize, folds: &[Fold], seed: u64) -> Judgement {
    let candidate = state.chosen[k];
    let term = &search.candidates[candidate];
    let mut others = state.chosen.clone();
    others.remove(k);
    let without = search.state(others, None);
    let model = search.model(&state.chosen);
    let between = between::is_between(term);
    let everyone = vec![1.0; search.data.specimens.len()];
    let p = if between {
        between::regression(search, &without.fitted, candidate, &everyone).map_or(1.0, |r| r.p)
    } else {
        probability(search, state, &without, &model, k)
    };
    let mut judgement = Judgement {
        candidate,
        p_adjusted: (p * if between { 2.0 } else { asked(search, term) }).min(1.0),
        criterion_gain: search.criterion_gain(&without, state),
        share: relative_fall(&without, state),
        chosen_again: 0.0,
        helps: 0.0,
        held_out: (f64::NAN, f64::NAN),
        falls: false,
        train: (without.fitted.sigma, state.fitted.sigma),
        class: Vec::new(),
        fails: None,
    };
    judgement.fails = failure_at_sight(search, &judgement, term, &state.fitted.terms[k].0, between);
    if judgement.fails.is_some() {
        return judgement;
    }
    let by_log;
    let used = if matches!(term.scope, Scope::Whole | Scope::From(_) | Scope::Levels(_)) {
        folds
    } else {
        by_log = log_folds(search.data);
        &by_log
    };
    let (helps, before, after) = helps(search, state, &without, used);
    judgement.held_out = (before.rmse_own_strength(), after.rmse_own_strength());
    judgement.falls = after.own_strength < before.own_strength || after.squares < before.squares;
    judgement.helps = if between {
        between::helps(search, &without.fitted, candidate)
    } else {
        helps
    };
    judgement.class = class(search, &without, candidate);
    judgement.chosen_again = if between {
        between::chosen_again(
            search,
            &without.fitted,
            candidate,
            &resamples(search.data, seed),
        )
    } else {
        chosen_again(search, &without, candidate, &judgement.class, seed)
    };
    judgement.fails = failure_outside(&judgement, between);
    judgement
}

/// What fails before anything is refitted.
fn failure_at_sight(
    search: &Search,
    j: &Judgement,
    term: &Term,
    amplitudes: &[f64],
    between: bool,
) -> Option<String> {
    let (low, high) = term.amplitude_bounds();
    let at_bound = amplitudes
        .iter()
        .any(|a| (*a <= low && low != 0.0) || *a >= high);
    if j.p_adjusted.is_nan() || j.p_adjusted > search.significance {
        Some(format!(
            "not significant: p = {:.2} after correction",
            j.p_adjusted
        ))
    } else if j.criterion_gain <= 0.0 && !between {
        Some("does not pay for its parameters".to_owned())
    } else if at_bound {
        Some("its size runs to a physical bound".to_owned())
    } else {
        None
    }
}

/// What fails on readings and specimens that took no part.
fn failure_outside(j: &Judgement, between: bool) -> Option<String> {
    if j.helps < HELPS {
        Some(format!(
            "lowers the held-out error in {:.0}% of the folds only",
            100.0 * j.helps
        ))
    } else if !j.falls && !between {
        Some("the held-out error over all folds does not fall".to_owned())
    } else if j.chosen_again < CHOSEN_AGAIN {
        Some(format!(
            "chosen again in {:.0}% of the resamples of the specimens only",
            100.0 * j.chosen_again
        ))
    } else {
        None
    }
}

/// Probability of the estimate by chance: of the t of one amplitude, or of the F of many.
fn probability(search: &Search, state: &State, without: &State, model: &Model, k: usize) -> f64 {
    let (amplitudes, second) = &state.fitted.terms[k];
    let layout = model.layout();
    if amplitudes.len() > 1 {
        let m = amplitudes.len() as f64;
        let freedom = (state.effective - layout.len() as f64).max(2.0);
        let (large, small) = (super::search::rss(state), super::search::rss(without));
        return f_upper_tail(
            ((small - large) / m).max(0.0) / (large / freedom),
            m,
            freedom,
        );
    }
    // A shape means nothing without an amplitude, so the amplitude is tested with the shape as found, and the coefficients of a
    // polynomial one at a time.
    let p_in = |fitted: &Fitted, place: Place, value: f64, held: Place| {
        let all: Vec<Uncertainty> = uncertainties(model, fitted, state.effective, &[held]);
        layout
            .iter()
            .position(|p| *p == place)
            .map_or(1.0, |i| all[i].p(value))
    };
    let p_of = |place: Place, value: f64, held: Place| p_in(&state.fitted, place, value, held);
    let mut first = p_of(Place::Amplitude(k, 0), amplitudes[0], Place::Shape(k));
    if first > search.significance / asked(search, &search.candidates[state.chosen[k]]) {
        // What differs between a few specimens can hardly be significant. What it does within them may be: the same with strengths
        // that are free. Two questions, so the smaller p counts twice.
        let free = model.fit_with_free_strengths(&state.fitted);
        let value = free.terms[k].0[0];
        let within = p_in(&free, Place::Amplitude(k, 0), value, Place::Shape(k));
        first = (2.0 * first.min(within)).min(1.0);
    }
    if matches!(search.candidates[state.chosen[k]].what, What::Empirical(_)) {
        (2.0 * first.min(p_of(Place::Shape(k), *second, Place::Amplitude(k, 0)))).min(1.0)
    } else {
        first
    }
}

/// How many things could have been found in its place: effects and empirical dependences, times the places of its scope.
fn asked(search: &Search, term: &Term) -> f64 {
    let kinds: BTreeSet<String> = search
        .candidates
        .iter()
        .map(|t| name(t, search.data))
        .collect();
    kinds.len() as f64 * choices(&term.scope, search.data)
}

/// The candidates that leave the same trace on the same readings.
fn class(search: &Search, without: &State, candidate: usize) -> Vec<usize> {
    let model = search.model(&without.chosen);
    let linear = Linear::new(
        &model,
        &without.fitted,
        without.fitted.scatter,
        search.candidates,
    );
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let term = &search.candidates[candidate];
    let same_place = |c: &usize| {
        let other = &search.candidates[*c];
        *c != candidate
            && other.acts_on == term.acts_on
            && other.id().is_some()
            && other.id() != term.id()
    };
    (0..search.candidates.len())
        .filter(same_place)
        .filter(|c| stand.cosine(candidate, *c).abs() > ALIKE)
        .collect()
}

/// In which part of the resamples of the specimens the candidate, or one of its class, explains most of what is left without it.
fn chosen_again(
    search: &Search,
    without: &State,
    candidate: usize,
    class: &[usize],
    seed: u64,
) -> f64 {
    let data = search.data;
    let model = search.model(&without.chosen);
    let linear = Linear::new(
        &model,
        &without.fitted,
        without.fitted.scatter,
        search.candidates,
    );
    let term = &search.candidates[candidate];
    let of = data.specimen_of_session();
    let whole = |c: &usize| {
        let other = &search.candidates[*c];
        other.scope == Scope::Whole && !without.chosen.contains(c)
    };
    let rivals: Vec<usize> = (0..search.candidates.len())
        .filter(whole)
        .filter(|c| {
            *c != candidate && !class.contains(c) && search.candidates[*c].id() != term.id()
        })
        .collect();
    let mut again = 0;
    for mut count in resamples(data, seed) {
        // What one part shows cannot be seen without that part.
        if let Scope::Specimen(k) = term.scope {
            count[k] = f64::max(count[k], 1.0);
        }
        if let Scope::Session(s) = term.scope {
            count[of[s]] = f64::max(count[of[s]], 1.0);
        }
        let weights: Vec<f64> = of.iter().map(|k| count[*k]).collect();
        let stand = linear.stand(&weights, &[]);
        let own = stand.gain(candidate).fall;
        let needs = |c: &usize| {
            let share = match search.candidates[*c].what {
                _ if term.has_evidence() => super::search::EVIDENCE,
                What::Empirical(Empirical::Gain(_)) | What::Effect { .. } => {
                    super::search::PREFERENCE.1
                }
                What::Empirical(_) => super::search::PREFERENCE.0,
            };
            share * stand.gain(*c).fall
        };
        again += usize::from(own > 0.0 && rivals.iter().all(|c| needs(c) <= own));
    }
    again as f64 / RESAMPLES as f64
}

/// Specimens drawn with replacement: how often each, one list a resample.
fn resamples(data: &Data, seed: u64) -> Vec<Vec<f64>> {
    let specimens: Vec<usize> = data
        .specimen
        .iter()
        .copied()
        .collect::<BTreeSet<usize>>()
        .into_iter()
        .collect();
    let mut stream = Stream::new(seed, &["resamples of specimens"]);
    (0..RESAMPLES)
        .map(|_| {
            let mut count = vec![0.0; data.specimens.len()];
            for _ in 0..specimens.len() {
                count[specimens[stream.below(specimens.len())]] += 1.0;
            }
            count
        })
        .collect()
}

/// Folds that leave every session in: a third of its logs (of its readings, where it has fewer than three) at a time.
fn log_folds(data: &Data) -> Vec<Fold> {
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

/// In which part of the folds the held-out error falls by more than a standard error, and the errors.
fn helps(search: &Search, with: &State, without: &State, folds: &[Fold]) -> (f64, Tally, Tally) {
    let (mut helped, mut counted) = (0, 0);
    let (mut before, mut after) = (Tally::default(), Tally::default());
    for fold in folds {
        let train = search.data.select(&fold.train);
        let held = search.data.select(&fold.held_out);
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

/// The tally and the squared error of each held-out reading: with the held-out specimen's own strength, and with the mean one. An effect
/// that acts alike on all readings of a specimen (resting length) shows in the second only.
fn squared_errors(
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
    let product: f64 = held.force.iter().zip(&predicted).map(|(y, f)| y * f).sum();
    let square: f64 = predicted.iter().map(|f| f * f).sum();
    let factor = if square > 0.0 { product / square } else { 1.0 };
    let squares = |factor: f64| {
        held.force
            .iter()
            .zip(&predicted)
            .map(|(y, f)| (y - factor * f) * (y - factor * f))
            .collect()
    };
    (
        Tally::of(&held.force, &predicted),
        squares(factor),
        squares(1.0),
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
fn more_than_its_error(gains: &[f64], held: &Data) -> bool {
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

/// Id of an effect, or the column of an empirical dependence.
pub fn name(term: &Term, data: &Data) -> String {
    match term.what {
        What::Empirical(e) => e.column(data),
        What::Effect { .. } => term.id().unwrap_or_default().to_owned(),
    }
}

/// Where a term acts, in words.
pub fn acts_on(term: &Term, data: &Data) -> String {
    match term.scope {
        Scope::Whole => "all readings".to_owned(),
        Scope::Session(s) => format!("session {}", data.sessions[s]),
        Scope::From(s) => format!("session {} and all after it", data.sessions[s]),
        Scope::Specimen(k) => format!("specimen {}", data.specimens[k]),
        Scope::EachSession => "every session, each with its own value".to_owned(),
        Scope::Levels(k) => format!(
            "the levels of {}, each with its own value",
            data.extras[k].name
        ),
    }
}
