//! From a search to what is believed: every guard, what zero logs decide, and what the folds find again.

use super::ZERO_OR_THRESHOLD;
use super::data::Data;
use super::findings::Rejected;
use super::folds::{self, Fold};
use super::held_out::HeldOut;
use super::judge::{self, Judgement};
use super::model::Place;
use super::search::{Search, State};
use super::term::Scope;
use super::uncertainty::uncertainties;

/// Effects that fewer of the folds found by themselves are not sure.
const HALF: f64 = 0.5;

/// What was found on all readings, and what the folds make of it.
pub(super) struct Found {
    pub best: State,
    pub judgements: Vec<Judgement>,
    pub rejected: Vec<Rejected>,
    pub held: HeldOut,
}

impl Found {
    /// Whether there are effects, none of which half of the folds found by themselves, and what they found instead does not predict better:
    /// an explanation of these readings and of no others.
    pub fn was_not_found_again(&self, search: &Search) -> bool {
        let seldom = |j: &Judgement| {
            let same = std::iter::once(j.candidate).chain(j.class.iter().copied());
            let ids: Vec<String> = same
                .filter_map(|c| search.candidates[c].id().map(str::to_owned))
                .collect();
            self.held.share_that_chose(&ids) < HALF
        };
        let physical = |j: &&Judgement| search.candidates[j.candidate].id().is_some();
        let mut effects = self.judgements.iter().filter(physical).peekable();
        effects.peek().is_some() && !self.held.falls() && effects.all(seldom)
    }

    /// Takes the effects away, and what was chosen beside them.
    pub fn drop_effects(&mut self, search: &Search) {
        for judgement in self.judgements.drain(..) {
            let term = &search.candidates[judgement.candidate];
            self.rejected.push(Rejected {
                id: judge::name(term, search.data),
                form: term.form().map(|f| f.name.to_owned()),
                acts_on: judge::acts_on(term, search.data),
                share: judgement.share,
                why: "few of the folds found it by themselves, and what they found does not lower the held-out error".to_owned(),
            });
        }
        self.best = search.state(Vec::new(), None);
    }
}

pub(super) type Believed = (State, Vec<Judgement>, Vec<Rejected>);

/// The bladder's threshold in the place of a zero of the pressure sensor that it cannot be told from, where the zero logs do not show that
/// zero: they are a measurement that the search has not seen.
pub(super) fn by_zero_logs(
    search: &Search,
    (mut state, mut judgements, rejected): Believed,
) -> Believed {
    let zero_logs = search.data.zero_pressures();
    let is = |c: usize, id: &str| {
        let term = &search.candidates[c];
        term.id() == Some(id) && term.scope == Scope::Whole
    };
    let Some(k) = state
        .chosen
        .iter()
        .position(|c| is(*c, ZERO_OR_THRESHOLD[0]))
    else {
        return (state, judgements, rejected);
    };
    let threshold = judgements[k]
        .class
        .iter()
        .position(|c| is(*c, ZERO_OR_THRESHOLD[1]));
    let model = search.model(&state.chosen);
    let place = model
        .layout()
        .iter()
        .position(|p| *p == Place::Amplitude(k, 0));
    let uncertain = uncertainties(&model, &state.fitted, state.effective, &[]);
    let (Some(threshold), Some(place), Some(highest)) = (threshold, place, zero_logs.last()) else {
        return (state, judgements, rejected);
    };
    let value = state.fitted.terms[k].0[0];
    if value - uncertain[place].half_width() > *highest {
        let judgement = &mut judgements[k];
        std::mem::swap(&mut judgement.class[threshold], &mut judgement.candidate);
        let other = judgement.candidate;
        let mut chosen = state.chosen.clone();
        chosen[k] = other;
        state = search.state(chosen, Some(&state.fitted));
    }
    (state, judgements, rejected)
}

/// The additions that pass every guard.
pub(super) fn believed(search: &Search, seed: u64) -> Believed {
    let inner = inner_folds(search.data);
    let (state, judgements, mut rejected) = judge::judged(search, &search.run(), &inner, seed);
    let (state, judgements, each) =
        judge::with_each_session(search, state, judgements, &inner, seed);
    rejected.extend(each);
    // What the sessions' own values hid can be seen beside them.
    let by_session = |c: &usize| search.candidates[*c].scope == Scope::EachSession;
    if state.chosen.iter().any(by_session) {
        let (further, more, failed) = judge::judged(search, &search.further(&state), &inner, seed);
        if further.chosen.len() > state.chosen.len() {
            rejected.extend(failed);
            return (further, more, rejected);
        }
    }
    (state, judgements, rejected)
}

/// Specimens left out one at a time (or sessions, logs): the folds in which a single addition is judged.
fn inner_folds(data: &Data) -> Vec<Fold> {
    folds::folds(data, &vec![false; data.len()]).0
}
