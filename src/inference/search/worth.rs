//! Which of some fits is preferred: by the log-likelihood, less what further amplitudes have to be worth and what unusual sizes cost.

use super::{Search, Way};
use crate::fit::Fitted;

impl Search<'_> {
    /// The log-likelihood of a fit, less what the amplitudes of a term have to be worth and what unusual sizes cost.
    pub(super) fn worth(&self, fitted: &Fitted, term: usize, way: Way) -> f64 {
        self.weighed(fitted) - self.of_further_amplitudes(term, way)
    }

    /// What the amplitudes of a term beyond its first have to be worth.
    pub(super) fn of_further_amplitudes(&self, term: usize, way: Way) -> f64 {
        let amplitudes = self.setting.problem.terms()[term].amplitudes;
        way.of_amplitude * amplitudes.saturating_sub(1) as f64
    }

    /// The log-likelihood of a fit with the prior of the sizes of its terms: normal, with the usual size as standard deviation.
    pub(super) fn weighed(&self, fitted: &Fitted) -> f64 {
        let terms = self.setting.problem.terms();
        let cost = |(term, values): &(usize, Vec<f64>)| -> f64 {
            let own = &terms[*term];
            let amplitudes = values.iter().take(own.amplitudes);
            amplitudes
                .map(|a| 0.5 * (a / own.usual) * (a / own.usual))
                .sum()
        };
        fitted.log_likelihood - fitted.point.terms.iter().map(cost).sum::<f64>()
    }

    /// The simplest of the fits that are alike to the best, by the last term of each, and of these the best.
    pub(super) fn preferred(&self, fits: &[(Fitted, usize)], way: Way) -> Option<(Fitted, usize)> {
        let worth = |(f, t): &(Fitted, usize)| self.worth(f, *t, way);
        let best_of = |a: &&(Fitted, usize), b: &&(Fitted, usize)| worth(a).total_cmp(&worth(b));
        let best = fits.iter().max_by(best_of)?;
        let alike = |f: &&(Fitted, usize)| worth(f) > worth(best) - self.decision.alike;
        let simpler = |a: &&(Fitted, usize), b: &&(Fitted, usize)| {
            let by_simplicity = self.simplicity(a.1).cmp(&self.simplicity(b.1));
            by_simplicity.then(best_of(a, b))
        };
        fits.iter().filter(alike).max_by(simpler).cloned()
    }

    /// Of terms that explain alike, one with a name is simpler than one without, and one that acts on all readings than one that acts on some.
    pub(super) fn simplicity(&self, term: usize) -> (bool, bool) {
        let term = &self.setting.problem.terms()[term];
        (term.named, term.whole)
    }
}
