//! The model with and without a part of its base, side by side.

use super::super::base::Base;
use super::super::between;
use super::super::findings::Reading;
use super::super::folds::Tally;
use super::super::linear::Linear;
use super::super::model::{MOST_TERMS, Model};
use super::super::search::Search;
use super::super::term::{Scope, Term};
use super::super::words::with_unit;
use super::super::{WORTH_ASKING, Work, errors, train_error};
use std::collections::BTreeSet;

/// A reading of the data whose held-out error is larger by less than this is as good.
pub(super) const AS_GOOD: f64 = 1.05;

/// Effects beside those that were found in the readings of the base.
const MOST_MORE: usize = 2;

/// Candidates whose held-out error is looked at for each.
const MOST_TRIED: usize = 5;

/// Base with and without its dependence on the resting length, each without effects, with those found, and with the one effect beside
/// which the dependence is needed least: neither is kept out of habit.
pub(super) fn readings_of_the_base(work: &Work, search: &Search) -> Vec<Reading> {
    let Some(reduced) = work.base.without_length_law() else {
        return Vec::new();
    };
    let bases: [(&Base, &str); 2] = [
        (work.base, "F_620 depends on l_rest"),
        (&reduced, "F_620 constant"),
    ];
    let physical: Vec<Term> = work
        .best
        .chosen
        .iter()
        .map(|c| work.candidates[*c].clone())
        .filter(|t| t.id().is_some())
        .collect();
    let mut sets = vec![Vec::new()];
    if !physical.is_empty() {
        sets.push(physical.clone());
    }
    if work.questions.iter().any(|q| q.p_adjusted < WORTH_ASKING) {
        for _ in 0..MOST_MORE {
            let from = sets.last().cloned().unwrap_or_default();
            let Some(more) = beside_no_law(work, search, &reduced, &from) else {
                break;
            };
            sets.push(more);
        }
    }
    let both = |terms: &Vec<Term>| {
        bases.map(|(base, words)| reading(work, search, base, words, terms.clone()))
    };
    sets.iter().flat_map(both).collect()
}

/// Some effects and one more, beside which a constant F_620 has the smallest held-out error, if that is clearly smaller than without it.
fn beside_no_law(
    work: &Work,
    search: &Search,
    reduced: &Base,
    physical: &[Term],
) -> Option<Vec<Term>> {
    let whole = |t: &&Term| {
        t.scope == Scope::Whole && t.id().is_some() && !between::is_between(work.base, t)
    };
    let found: BTreeSet<Option<&str>> = physical.iter().map(Term::id).collect();
    let with =
        |more: Option<&Term>| -> Vec<Term> { physical.iter().chain(more).cloned().collect() };
    let error = |terms: Vec<Term>| {
        reading(work, search, reduced, "", terms)
            .errors
            .rmse_heldout
    };
    let mut seen = BTreeSet::new();
    let candidates =
        work.candidates.iter().filter(whole).filter(|t| {
            !found.contains(&t.id()) && seen.insert((t.id(), t.form().map(|f| f.name)))
        });
    // The error of every candidate would take long; the best by the trace are enough.
    let model = Model {
        base: reduced,
        data: search.data,
        terms: physical.to_vec(),
    };
    let fitted = model.fit(None, 1);
    let candidates: Vec<Term> = candidates.cloned().collect();
    let linear = Linear::new(&model, &fitted, fitted.scatter, &candidates);
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|a, b| {
        stand
            .gain(*b)
            .fall
            .total_cmp(&stand.gain(*a).fall)
            .then(a.cmp(b))
    });
    let best = order
        .into_iter()
        .take(MOST_TRIED)
        .map(|k| &candidates[k])
        .map(|t| (error(with(Some(t))), t))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 * AS_GOOD < error(with(None)) && physical.len() < MOST_TERMS)
        .then(|| with(Some(best.1)))
}

pub(super) fn reading(
    work: &Work,
    search: &Search,
    base: &Base,
    words: &str,
    terms: Vec<Term>,
) -> Reading {
    let model = Model {
        base,
        data: search.data,
        terms: terms.clone(),
    };
    let fitted = model.fit(None, 1);
    let mut tally = Tally::default();
    for fold in work.folds {
        let train = work
            .all
            .select(&fold.train)
            .thinned(work.options.most_readings);
        let held = work.all.select(&fold.held_out);
        let here = Model {
            base,
            data: &train,
            terms: terms.clone(),
        };
        let fit = here.fit(Some(&fitted), 1);
        let there = Model {
            base,
            data: &held,
            terms: terms.clone(),
        };
        tally = tally.plus(Tally::of(
            &held.force,
            &there.predict(&fit, false),
            &there.predict_with_own_strength(&fit),
        ));
    }
    let numbers = terms.iter().zip(&fitted.terms).filter_map(|(t, (a, _))| {
        let form = t.form()?;
        (a.len() == 1).then(|| {
            let value = form.amplitude.absent + a[0];
            format!(
                "{} = {}",
                form.amplitude.name,
                with_unit(value, form.amplitude.unit)
            )
        })
    });
    let free = base.coefficients.iter().filter(|c| c.free).count();
    let ids: Vec<String> = terms.iter().filter_map(Term::words).collect();
    Reading {
        model: if terms.is_empty() {
            format!("{words}, no effects")
        } else {
            format!("{words}, with {}", ids.join(" and "))
        },
        parameters: free + terms.iter().map(Term::parameters).sum::<usize>(),
        errors: errors(train_error(&model, &fitted), tally),
        numbers: numbers.collect(),
    }
}
