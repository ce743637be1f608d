//! Whether an addition is chosen again in resamples of the specimens.

use super::super::data::Data;
use super::super::linear::Linear;
use super::super::search::{EVIDENCE, PREFERENCE, Search, State, rss};
use super::super::term::{Empirical, Scope, What};
use crate::base::random::Stream;
use std::collections::{BTreeMap, BTreeSet};

const RESAMPLES: usize = 40;
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
        let own = own_scale * stand.gain(candidate).fall;
        let needs = |c: &usize| share(c) * scales.get(c).unwrap_or(&1.0) * stand.gain(*c).fall;
        again += usize::from(own > 0.0 && rivals.iter().all(|c| needs(c) <= own));
    }
    again as f64 / RESAMPLES as f64
}

/// Specimens drawn with replacement: how often each, one list a resample.
pub(super) fn resamples(data: &Data, seed: u64) -> Vec<Vec<f64>> {
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
