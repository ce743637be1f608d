//! Whether an addition is chosen again in resamples of the specimens (of the sessions, where there are hardly any specimens).

use super::super::data::Data;
use super::super::folds::folds;
use super::super::linear::{Linear, Stand};
use super::super::model::Model;
use super::super::search::{EVIDENCE, PREFERENCE, Search, State, rss};
use super::super::term::{Empirical, Scope, What};
use super::held_out::refit;
use crate::base::random::Stream;
use std::collections::{BTreeMap, BTreeSet};

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
    let of = data.specimen_of_session();
    let on_all = |c: &usize| {
        let other = &search.candidates[*c];
        other.scope == Scope::Whole && !without.chosen.contains(c)
    };
    let rivals: Vec<usize> = (0..search.candidates.len())
        .filter(on_all)
        .filter(|c| {
            *c != candidate && !class.contains(c) && search.candidates[*c].id() != term.id()
        })
        .collect();
    let share = |c: &usize| match search.candidates[*c].what {
        _ if term.has_evidence() => EVIDENCE,
        What::Empirical(Empirical::Gain(_)) | What::Effect { .. } => PREFERENCE.1,
        What::Empirical(_) => PREFERENCE.0,
    };
    let whole = linear.stand(&linear.all_sessions(), &[]);
    let scale = |c: usize, fitted: &State| {
        let linear = whole.gain(c).fall;
        if linear > 0.0 {
            (rss(without) - rss(fitted)).max(0.0) / linear
        } else {
            1.0
        }
    };
    let own = whole.gain(candidate).fall;
    let falls: Vec<(f64, usize)> = rivals
        .iter()
        .map(|c| (share(c) * whole.gain(*c).fall, *c))
        .collect();
    let contradicted = falls.iter().any(|(fall, _)| *fall > own);
    let (mut own_scale, mut scales) = (1.0, BTreeMap::new());
    if contradicted {
        let least = CONTENDS.0 * own.min(rss(without) - rss(with));
        let mut contenders: Vec<(f64, usize)> =
            falls.into_iter().filter(|(f, _)| *f > least).collect();
        contenders.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        own_scale = scale(candidate, with);
        scales.extend(contenders.into_iter().take(CONTENDS.1).map(|(_, c)| {
            let chosen = without.chosen.iter().copied().chain([c]).collect();
            (c, scale(c, &search.state(chosen, Some(&without.fitted))))
        }));
    }
    let wins = |stand: &Stand| {
        let own = own_scale * stand.gain(candidate).fall;
        let needs = |c: &usize| share(c) * scales.get(c).unwrap_or(&1.0) * stand.gain(*c).fall;
        own > 0.0 && rivals.iter().all(|c| needs(c) <= own)
    };
    let seen = |group: &[usize]| group.iter().collect::<BTreeSet<_>>().len();
    if seen(&data.session) < FEWEST {
        // That there is structure is asked elsewhere. Folds of one session ask for its name, and an empirical dependence has none.
        if term.id().is_none() {
            return 1.0;
        }
        return in_folds(search, without, &wins);
    }
    let by_specimen = seen(&data.specimen) >= FEWEST;
    let lists: Vec<Vec<f64>> = if by_specimen {
        let counts = resamples(data, seed).into_iter();
        counts
            .map(|count| of.iter().map(|k| count[*k]).collect())
            .collect()
    } else {
        drawn(&data.session, data.sessions.len(), seed)
    };
    let again = lists.into_iter().filter_map(|mut weights| {
        // What one part shows cannot be seen without that part.
        for (s, weight) in weights.iter_mut().enumerate() {
            if matches!(term.scope, Scope::Session(_) | Scope::Specimen(_))
                && term.acts_on[s].is_some()
            {
                *weight = weight.max(1.0);
            }
        }
        wins(&linear.stand(&weights, &[])).then_some(())
    });
    again.count() as f64 / RESAMPLES as f64
}

/// The same where there are too few sessions to be drawn: in which part of the folds (a log or a set length left out at a time).
fn in_folds(search: &Search, without: &State, wins: &dyn Fn(&Stand) -> bool) -> f64 {
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
        wins(&linear.stand(&linear.all_sessions(), &[]))
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
