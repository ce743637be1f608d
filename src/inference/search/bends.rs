//! What does not show beside another term whose size bends along its own argument goes.

use super::{Found, Search};
use crate::fit::Fitted;
use crate::form;
use crate::statistic::deviate;

impl Search<'_> {
    /// Leaves out the terms, the weakest first, that no longer show beside another one whose size bends along its own argument: where that has
    /// another form than the library knows, a second term takes up the difference.
    pub(super) fn leave_out_bends(&self, found: &mut Found) {
        loop {
            let mut order: Vec<usize> = (0..found.accepted.len()).collect();
            order.sort_by(|a, b| found.accepted[*a].gain.total_cmp(&found.accepted[*b].gain));
            let bend = order.into_iter().find_map(|place| {
                let term = found.accepted[place].term;
                let without = self.without(found, term);
                let accepted = &found.accepted[place];
                let least = self.least_beside_bends(&found.model, &without);
                let amplitudes = self.setting.problem.terms()[accepted.term].amplitudes;
                let is_bend = deviate(2.0 * least, amplitudes) < accepted.critical;
                is_bend.then_some((place, without))
            });
            let Some((place, without)) = bend else {
                return;
            };
            found.accepted.remove(place);
            found.model = without;
        }
    }

    /// The least that a model gains over one with a term less, where the size of any other term may bend in both.
    fn least_beside_bends(&self, model: &Fitted, without: &Fitted) -> f64 {
        let bent = |fitted: &Fitted, term: usize| {
            let columns = self.setting.problem.bends(&fitted.point, term);
            fitted.log_likelihood + form::gain(self.setting, fitted, &columns)
        };
        let others = without.point.terms.iter();
        let gains = others.map(|(t, _)| bent(model, *t) - bent(without, *t));
        gains.fold(model.log_likelihood - without.log_likelihood, f64::min)
    }
}
