//! What does not show beside another term whose size bends along its own argument goes.

use super::{Found, Search};
use crate::fit::Fitted;
use crate::form::Beside;
use crate::statistic::deviate;

impl Search<'_> {
    /// Leaves out the terms, the weakest first, that no longer show beside another one whose size bends along its own argument: where that has
    /// another form than the library knows, a second term takes up the difference.
    pub(super) fn leave_out_bends(&self, found: &mut Found) {
        loop {
            let mut order: Vec<usize> = (0..found.accepted.len()).collect();
            order.sort_by(|a, b| found.accepted[*a].gain.total_cmp(&found.accepted[*b].gain));
            let model = found.model.clone();
            let bent = self.bent(&model);
            let bend = order.into_iter().find_map(|place| {
                let without = self.without(found, found.accepted[place].term);
                let accepted = &found.accepted[place];
                let amplitudes = self.setting.problem.terms()[accepted.term].amplitudes;
                let shows = |gain: f64| deviate(2.0 * gain, amplitudes) >= accepted.critical;
                let is_bend = !shows(model.log_likelihood - without.log_likelihood)
                    || !self.shows_beside_bends(&bent, &without, shows);
                is_bend.then_some((place, without))
            });
            let Some((place, without)) = bend else {
                return;
            };
            found.accepted.remove(place);
            found.model = without;
        }
    }

    /// Whether a model gains enough over one with a term less, where the size of any other term may bend in both.
    fn shows_beside_bends(
        &self,
        bent: &[(usize, f64)],
        without: &Fitted,
        is_enough: impl Fn(f64) -> bool,
    ) -> bool {
        let others = bent.iter();
        let mut others = others.filter(|(term, _)| without.values(*term).is_some());
        let beside = Beside::new(self.setting, without);
        others.all(|(term, with)| is_enough(with - self.bent_by(&beside, without, *term)))
    }

    /// The terms of a model, each with the log-likelihood where its size may bend.
    fn bent(&self, model: &Fitted) -> Vec<(usize, f64)> {
        if model.point.terms.len() < 2 {
            return Vec::new();
        }
        let beside = Beside::new(self.setting, model);
        let terms = model.point.terms.iter().map(|(term, _)| *term);
        terms
            .map(|term| (term, self.bent_by(&beside, model, term)))
            .collect()
    }

    fn bent_by(&self, beside: &Beside, model: &Fitted, term: usize) -> f64 {
        let columns = self.setting.problem.bends(&model.point, term);
        model.log_likelihood + beside.gain(&columns)
    }
}
