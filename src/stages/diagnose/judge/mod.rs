//! Which of the chosen additions may be believed, and what is said of each.
//!
//! An addition stays only if its t is significant after correction for all candidates, if the criterion still wants it, if its size lies
//! inside its physical bounds, if it lowers the error on readings that took no part by more than that improvement's standard error
//! in most folds ([`held_out`]), and if it is chosen again in nine of ten resamples of the specimens ([`again`]).

mod again;
mod each_session;
mod held_out;

pub use each_session::with_each_session;

use super::between;
use super::candidates::choices;
use super::data::{Data, PLACEBO, ZERO_UNKNOWN};
use super::findings::Rejected;
use super::folds::Fold;
use super::linear::Linear;
use super::model::{Fitted, Model, Place};
use super::search::{Search, State, relative_fall, rss, sorted};
use super::term::{Scope, Term, What};
use super::uncertainty::{Uncertainty, uncertainties};
use crate::numerics::distributions::f_upper_tail;
use again::{chosen_again, resamples};
use held_out::{helps, log_folds};
use std::collections::BTreeSet;

/// Largest corrected p of an addition: on all readings, and in a fold, which has fewer.
pub const SIGNIFICANT: (f64, f64) = (0.05, 0.05);

/// Least part of the resamples in which it is chosen again.
pub const CHOSEN_AGAIN: f64 = 0.9;

/// Least part of the folds in which it helps.
pub const HELPS: f64 = 0.5;

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

/// The model with the most evidence of which every addition passes: of some models, and of what is left of each when what fails was
/// removed. Without the last step a worse model would pass where the best one has one addition too many.
pub fn judged(
    search: &Search,
    states: &[State],
    folds: &[Fold],
    seed: u64,
) -> (State, Vec<Judgement>, Vec<Rejected>) {
    let null = search.state(Vec::new(), None);
    let mut open: Vec<State> = states.to_vec();
    let mut seen: BTreeSet<Vec<usize>> = open.iter().map(|s| sorted(&s.chosen)).collect();
    let mut rejected: Vec<Rejected> = Vec::new();
    let evidence = |s: &State| search.criterion_gain(&null, s);
    loop {
        open.retain(|s| !s.chosen.is_empty());
        // The first of equals: `max_by` would take the last.
        let best = (0..open.len()).rev();
        let best = best.max_by(|a, b| evidence(&open[*a]).total_cmp(&evidence(&open[*b])));
        let Some(best) = best else {
            return (null, Vec::new(), rejected);
        };
        let state = open.remove(best);
        match until_one_fails(search, &state, folds, seed) {
            Ok(judgements) => return (state, judgements, rejected),
            Err((k, failed)) => {
                // What is said of it in the smallest model says most.
                rejected.retain(|q| q.id != failed.id || q.acts_on != failed.acts_on);
                rejected.push(failed);
                let mut chosen = state.chosen;
                chosen.remove(k);
                if seen.insert(sorted(&chosen)) {
                    open.push(search.state(chosen, None));
                }
            }
        }
    }
}

/// Judges every addition of a model, or up to the first that fails: its place, and why.
fn until_one_fails(
    search: &Search,
    state: &State,
    folds: &[Fold],
    seed: u64,
) -> Result<Vec<Judgement>, (usize, Rejected)> {
    let mut judgements = Vec::new();
    // The last one in is the likeliest to fail, and one failure is enough.
    for k in (0..state.chosen.len()).rev() {
        let judgement = judge(search, state, k, folds, seed);
        if let Some(why) = judgement.fails {
            let term = &search.candidates[state.chosen[k]];
            let failed = Rejected {
                form: term.form().map(|f| f.name.to_owned()),
                id: name(term, search.data),
                acts_on: acts_on(term, search.data),
                share: judgement.share,
                why,
            };
            return Err((k, failed));
        }
        judgements.insert(0, judgement);
    }
    Ok(judgements)
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
        chosen_again(search, state, &without, candidate, &judgement.class, seed)
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
    if name(term, search.data) == PLACEBO {
        Some("a shuffled copy of a column: chance".to_owned())
    } else if j.p_adjusted.is_nan() || j.p_adjusted > search.significance {
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
            "chosen again in {:.0}% of the resamples only",
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
        let (large, small) = (rss(state), rss(without));
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
        Scope::Levels(k) if data.extras[k].name == ZERO_UNKNOWN => {
            "the sessions whose zero is not known".to_owned()
        }
        Scope::Levels(k) => format!(
            "the levels of {}, each relative to the first",
            data.extras[k].name
        ),
    }
}
