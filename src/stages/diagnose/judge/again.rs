//! Whether an addition is chosen again in resamples of the specimens (of the sessions, where there are hardly any specimens).

use super::super::data::Data;
use super::super::folds::folds;
use super::super::linear::{Linear, Stand};
use super::super::model::Model;
use super::super::search::{EVIDENCE, PREFERENCE, Search, State, rss};
use super::super::term::{Empirical, Scope, Term, What};
use super::held_out::refit;
use crate::base::random::Stream;
use std::collections::BTreeSet;

const RESAMPLES: usize = 40;
/// Fewest specimens that are drawn; below, sessions are, and with fewer of these, folds are counted.
const FEWEST: usize = 3;
/// Rivals that explain this part of what the candidate does are fitted in full; and at most so many.
const CONTENDS: (f64, usize) = (0.7, 4);

/// In which part of the resamples of the specimens the candidate, or one of its class, explains most of what is left without it.
///
/// Resamples use the linearised model. A large effect is not linear: where a rival explains more of all readings there, although the
/// candidate does in the full fit (`with`), what each contender explains is scaled by what it explains when it is fitted in full.
pub(super) fn chosen_again(
    search: &Search,
    with: &State,
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
    let contest = Contest::new(search, &linear, with, without, candidate, class);
    let seen = |group: &[usize]| group.iter().collect::<BTreeSet<_>>().len();
    if seen(&data.session) < FEWEST {
        // That there is structure is asked elsewhere. Folds of one session ask for its name, and an empirical dependence has none.
        if term.id().is_none() {
            return 1.0;
        }
        return in_folds(search, without, &contest);
    }
    let of = data.specimen_of_session();
    let lists: Vec<Vec<f64>> = if seen(&data.specimen) >= FEWEST {
        let counts = resamples(data, seed).into_iter();
        counts
            .map(|count| of.iter().map(|k| count[*k]).collect())
            .collect()
    } else {
        drawn(&data.session, data.sessions.len(), seed)
    };
    let again = lists.into_iter().filter(|drawn| {
        let weights = with_its_own_part(drawn, term);
        contest.is_won(&linear.stand(&weights, &[]))
    });
    again.count() as f64 / RESAMPLES as f64
}

/// The weights of the sessions in a resample; those of the one part on which a term acts at least one, for what a part shows cannot be seen
/// without it.
fn with_its_own_part(drawn: &[f64], term: &Term) -> Vec<f64> {
    let of_part = matches!(term.scope, Scope::Session(_) | Scope::Specimen(_));
    let weight = |(s, weight): (usize, &f64)| {
        if of_part && term.acts_on[s].is_some() {
            weight.max(1.0)
        } else {
            *weight
        }
    };
    drawn.iter().enumerate().map(weight).collect()
}

/// A candidate and what could have been chosen in its place.
struct Contest {
    candidate: usize,
    /// What its linear fall is multiplied by.
    scale: f64,
    /// Every rival with the same.
    rivals: Vec<(usize, f64)>,
}

impl Contest {
    fn new(
        search: &Search,
        linear: &Linear,
        with: &State,
        without: &State,
        candidate: usize,
        class: &[usize],
    ) -> Self {
        let term = &search.candidates[candidate];
        let is_rival = |c: &usize| {
            let other = &search.candidates[*c];
            other.scope == Scope::Whole
                && !without.chosen.contains(c)
                && *c != candidate
                && !class.contains(c)
                && other.id() != term.id()
        };
        let preference = |c: usize| match search.candidates[c].what {
            _ if term.has_evidence() => EVIDENCE,
            What::Empirical(Empirical::Gain(_)) | What::Effect { .. } => PREFERENCE.1,
            What::Empirical(_) => PREFERENCE.0,
        };
        let rivals = (0..search.candidates.len()).filter(is_rival);
        let mut contest = Contest {
            candidate,
            scale: 1.0,
            rivals: rivals.map(|c| (c, preference(c))).collect(),
        };
        let whole = linear.stand(&linear.all_sessions(), &[]);
        if !contest.is_won(&whole) {
            contest.scale_by_full_fits(search, &whole, with, without);
        }
        contest
    }

    /// Scales the falls of the candidate and of those that contend by what they explain when they are fitted in full.
    fn scale_by_full_fits(
        &mut self,
        search: &Search,
        whole: &Stand,
        with: &State,
        without: &State,
    ) {
        let scale = |c: usize, fitted: &State| {
            let linear = whole.gain(c).fall;
            if linear > 0.0 {
                (rss(without) - rss(fitted)).max(0.0) / linear
            } else {
                1.0
            }
        };
        let own = whole.gain(self.candidate).fall;
        let least = CONTENDS.0 * own.min(rss(without) - rss(with));
        let fall = |(c, preference): (usize, f64)| preference * whole.gain(c).fall;
        let mut contenders: Vec<usize> = (0..self.rivals.len())
            .filter(|k| fall(self.rivals[*k]) > least)
            .collect();
        let by_fall = |a: &usize, b: &usize| {
            let [x, y] = [a, b].map(|k| fall(self.rivals[*k]));
            y.total_cmp(&x).then(a.cmp(b))
        };
        contenders.sort_by(by_fall);
        self.scale = scale(self.candidate, with);
        for k in contenders.into_iter().take(CONTENDS.1) {
            let c = self.rivals[k].0;
            let chosen = without.chosen.iter().copied().chain([c]).collect();
            self.rivals[k].1 *= scale(c, &search.state(chosen, Some(&without.fitted)));
        }
    }

    /// Whether the candidate explains most in a resample.
    fn is_won(&self, stand: &Stand) -> bool {
        let own = self.scale * stand.gain(self.candidate).fall;
        let needs = |(c, scale): &(usize, f64)| scale * stand.gain(*c).fall;
        own > 0.0 && self.rivals.iter().all(|rival| needs(rival) <= own)
    }
}

/// The same where there are too few sessions to be drawn: in which part of the folds (a log or a set length left out at a time).
fn in_folds(search: &Search, without: &State, contest: &Contest) -> f64 {
    let (folds, _) = folds(search.data, &vec![false; search.data.len()]);
    let again = folds.iter().filter(|fold| {
        let train = search.data.select(&fold.train);
        let terms = search.model(&without.chosen).terms;
        let fitted = refit(search, terms.clone(), &without.fitted, &train);
        let model = Model {
            base: search.base,
            data: &train,
            terms,
        };
        let linear = Linear::new(&model, &fitted, fitted.scatter, search.candidates);
        contest.is_won(&linear.stand(&linear.all_sessions(), &[]))
    });
    again.count() as f64 / folds.len().max(1) as f64
}

/// Specimens drawn with replacement: how often each, one list a resample.
pub(super) fn resamples(data: &Data, seed: u64) -> Vec<Vec<f64>> {
    drawn(&data.specimen, data.specimens.len(), seed)
}

/// Groups drawn with replacement from those that occur: how often each of `all`.
fn drawn(group: &[usize], all: usize, seed: u64) -> Vec<Vec<f64>> {
    let present: Vec<usize> = group
        .iter()
        .copied()
        .collect::<BTreeSet<usize>>()
        .into_iter()
        .collect();
    let mut stream = Stream::new(seed, &["resamples of specimens"]);
    (0..RESAMPLES)
        .map(|_| {
            let mut count = vec![0.0; all];
            for _ in 0..present.len() {
                count[present[stream.below(present.len())]] += 1.0;
            }
            count
        })
        .collect()
}
