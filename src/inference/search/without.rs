//! The model without one of its terms: no worse than what the search came by on its way.

use super::{Found, Search};
use crate::fit::Fitted;
use crate::problem::Point;

/// A model without one of its terms.
#[derive(Clone, Debug)]
pub(super) struct LeftOut {
    of: Point,
    term: usize,
    rest: Fitted,
}

impl Search<'_> {
    /// A model with one of its terms left out.
    pub(super) fn left_out(&self, model: &Fitted, term: usize) -> Fitted {
        let mut from: Point = model.point.clone();
        from.terms.retain(|(t, _)| *t != term);
        self.setting.fit(&from, &self.starts(model))
    }

    /// The model without one of its terms, which is asked for again where nothing has changed.
    pub(super) fn without(&self, found: &mut Found, term: usize) -> Fitted {
        let of = &found.model.point;
        let known = found.left_out.iter();
        if let Some(known) = known.rev().find(|l| l.term == term && l.of == *of) {
            return known.rest.clone();
        }
        let rest = self.refitted_without(found, term);
        found.left_out.push(LeftOut {
            of: of.clone(),
            term,
            rest: rest.clone(),
        });
        rest
    }

    /// The model without one of its terms: no worse than the models on the way to it that have none but its other terms.
    fn refitted_without(&self, found: &Found, term: usize) -> Fitted {
        let refitted = self.left_out(&found.model, term);
        let others = &refitted.point.terms;
        let is_other = |t: usize| others.iter().any(|(o, _)| *o == t);
        let is_within = |stage: &&Fitted| stage.point.terms.iter().all(|(t, _)| is_other(*t));
        let within = found.stages.iter().filter(is_within);
        let best = within.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood));
        let Some(stage) = best.filter(|s| s.log_likelihood > refitted.log_likelihood) else {
            return refitted;
        };
        let mut from = stage.point.clone();
        let more = others.iter().filter(|(t, _)| stage.values(*t).is_none());
        from.terms.extend(more.cloned());
        if from.terms.len() == stage.point.terms.len() {
            return stage.clone();
        }
        let starts = std::slice::from_ref(&stage.variances);
        let again = self.setting.fit(&from, starts);
        if again.log_likelihood > refitted.log_likelihood {
            again
        } else {
            refitted
        }
    }
}
