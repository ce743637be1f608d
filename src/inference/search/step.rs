//! One step forward: the strongest candidate beside a model comes in, or none is improbable enough.

use super::{Accepted, Decision, Drawn, Found, Search, WORTH_A_SWAP, Way};
use crate::fit::Fitted;
use crate::form::Beside;
use crate::screen::{Normal, Screen, Shown};
use crate::statistic::{critical, deviate, likelihood_ratio, upper_tail};

/// A candidate whose probability under the draws from the null lies in this range, as a multiple of the level, is tested against draws from its own
/// model as well; beyond it they could not change the answer, because the distribution of the maximum follows from the design far more than from
/// the model.
const CLOSE: (f64, f64) = (0.2, 4.0);

/// A statistic this many times the critical one, to which none of the draws comes, needs no draws of its own either: there may be too few to show so
/// small a probability.
const CLEAR: f64 = 2.0;

/// A decision that the draws leave open gets up to this many times as many: with 199 of them an answer at the level of 2% would hang on one or two,
/// and another seed would give another.
const MORE_DRAWS: usize = 10;

/// How often a better optimum of the model without a further term is taken up.
const MOST_BETTER: usize = 3;

/// The strongest candidate beside a model, fitted.
pub(super) struct Next {
    pub(super) fitted: Fitted,
    pub(super) term: usize,
    pub(super) p: f64,
    pub(super) critical: f64,
}

/// What a step of the search came to.
enum Step {
    /// A term came in.
    Accepted(Box<Next>),
    /// No term, but a better optimum of the model without one.
    BetterBase,
    /// Nothing.
    Nothing,
}

impl Search<'_> {
    /// Terms come in until none is improbable enough, or there are so many.
    pub(super) fn forward(&self, found: &mut Found, normal: &Normal, way: Way, most: usize) {
        let mut better = 0;
        while found.accepted.len() < most {
            let next = match self.next(found, normal, way) {
                Step::Accepted(next) => *next,
                Step::BetterBase if better < MOST_BETTER => {
                    better += 1;
                    continue;
                }
                Step::BetterBase | Step::Nothing => break,
            };
            found.accepted.push(Accepted {
                term: next.term,
                p: next.p,
                critical: next.critical,
                gain: next.fitted.log_likelihood - found.model.log_likelihood,
                in_its_place: Vec::new(),
            });
            found
                .stages
                .push(std::mem::replace(&mut found.model, next.fitted));
        }
    }

    /// The candidate that comes in next, or none. A model to which a better null belongs replaces it.
    fn next(&self, found: &mut Found, normal: &Normal, way: Way) -> Step {
        let model = found.model.clone();
        let screen = self.screen(self.setting, &model, way);
        let is_first = found.accepted.is_empty();
        let mut shown = screen.shown(2 * Screen::refined_in_draws());
        shown.retain(|s| self.may_come(&model, screen.directions[s.direction].term, way));
        let first = strongest(&shown);
        let (mut draws, own) = self.draws_beside(found, &screen, normal, way, first);
        let limit = critical(&draws, self.decision.level);
        let fits = self.fits_beside((&model, is_first), (&screen, &shown), limit, way);
        let Some((fitted, term)) = self.preferred(&fits, way) else {
            return self.in_pairs(found, &draws, limit, way);
        };
        let fitted = self.estimated(&fitted);
        let without = self.left_out(&fitted, term);
        let is_better = without.log_likelihood > model.log_likelihood + WORTH_A_SWAP;
        if is_better {
            if found.accepted.is_empty() {
                found.null = without.clone();
            }
            found.model = without;
        }
        let statistic = self.statistic(&fitted, term, found.model.log_likelihood);
        let statistic = statistic.min(self.beyond_scatter(&fitted, term, &found.model));
        if own {
            draws = self.until_sure(draws, &screen, normal, statistic);
        }
        let limit = critical(&draws, self.decision.level);
        if statistic >= limit {
            Step::Accepted(Box::new(Next {
                p: upper_tail(&draws, statistic),
                critical: limit,
                fitted,
                term,
            }))
        } else if is_better {
            Step::BetterBase
        } else {
            self.in_pairs(found, &draws, limit, way)
        }
    }

    /// Where no term shows: one that comes in while another gives way, if that is tried.
    fn in_pairs(&self, found: &mut Found, draws: &[f64], limit: f64, way: Way) -> Step {
        let pair = way
            .in_pairs
            .then(|| self.pair(found, draws, limit, way))
            .flatten();
        pair.map_or(Step::Nothing, |next| Step::Accepted(Box::new(next)))
    }

    /// The draws that decide on the strongest candidate: those from the null, or from the model itself where these could change the answer; more of them
    /// where they leave it open. And whether they are from the model itself.
    fn draws_beside(
        &self,
        found: &mut Found,
        screen: &Screen,
        normal: &Normal,
        way: Way,
        first: f64,
    ) -> (Vec<f64>, bool) {
        let close = (CLOSE.0 * self.decision.level, CLOSE.1 * self.decision.level);
        let p = upper_tail(&found.draws, first);
        let is_far = first >= CLEAR * found.critical;
        let is_clear = p <= close.0 || is_far && p <= upper_tail(&found.draws, f64::INFINITY);
        let is_first = found.accepted.is_empty();
        let redrawn = match way.drawn {
            // Draws of more groups than there are here have lighter tails: they decide what is clear, no more.
            Drawn::IfDoubtful => first >= found.critical && !is_far,
            Drawn::IfClose => !is_first && !is_clear && p < close.1,
            Drawn::Always => !is_first && !is_clear,
        };
        if redrawn {
            let begun = if self.decision.thorough {
                screen.draws(self.decision.draws, normal)
            } else {
                Vec::new()
            };
            return (self.until_sure(begun, screen, normal, first), true);
        }
        // Draws that were given are of another model.
        let own = is_first && !matches!(way.drawn, Drawn::IfDoubtful);
        if own {
            let begun = std::mem::take(&mut found.draws);
            found.draws = self.until_sure(begun, screen, normal, first);
            found.critical = critical(&found.draws, self.decision.level);
        }
        (found.draws.clone(), own)
    }

    /// Draws until it is sure on which side of the critical value a value lies, or there are too many.
    fn until_sure(
        &self,
        begun: Vec<f64>,
        screen: &Screen,
        normal: &Normal,
        value: f64,
    ) -> Vec<f64> {
        let Decision { level, draws, .. } = self.decision;
        screen.draws_to_decide(begun, MORE_DRAWS * draws, normal, level, value)
    }

    /// Whether a term may come in beside a model: not first, if it is of the kind that does not.
    pub(super) fn may_come(&self, model: &Fitted, term: usize, way: Way) -> bool {
        let kind = self.setting.problem.terms()[term].kind;
        !model.point.terms.is_empty() || way.not_first != Some(kind)
    }

    /// The candidates that are worth a comparison, fitted in full: those that would be accepted, if there are any.
    fn fits_beside(
        &self,
        (model, is_first): (&Fitted, bool),
        (screen, shown): (&Screen, &[Shown]),
        limit: f64,
        way: Way,
    ) -> Vec<(Fitted, usize)> {
        let shows = |f: &(Fitted, usize)| {
            self.may_come(model, f.1, way) && self.beyond_scatter(&f.0, f.1, model) >= limit
        };
        let mut fits = self.fits_tried(model);
        fits.retain(shows);
        if strongest(shown) >= limit {
            let others = self.fits(screen, model, shown, &fits, limit);
            fits.extend(others);
        }
        if self.decision.thorough && (is_first || fits.is_empty()) {
            fits.extend(self.fits_afresh(model, way).into_iter().filter(shows));
        }
        let passes =
            |(f, t): &(Fitted, usize)| self.statistic(f, *t, model.log_likelihood) >= limit;
        if self.decision.thorough {
            let least = self.least_of_use(&fits, model, limit, way);
            fits.extend(self.fits_far(model, way, least));
        }
        // What would not be accepted keeps nothing out.
        if fits.iter().any(passes) {
            fits.retain(passes);
        }
        fits
    }

    /// What a fit gains by a term where its size may scatter among the groups between which it tells differences, as much as it does beside the term
    /// (differences between are measured by the variance within), on the scale of [`deviate`]: infinite where it tells none.
    pub(super) fn beyond_scatter(&self, fitted: &Fitted, term: usize, below: &Fitted) -> f64 {
        let columns = self.setting.problem.scatters(&fitted.point, term);
        if columns.is_empty() {
            return f64::INFINITY;
        }
        let (gain, sd) = Beside::new(self.setting, fitted).scatter(&columns);
        let with = fitted.log_likelihood + gain;
        let known = Beside::new(self.setting, below).gain_at(&columns, sd);
        let without = below.log_likelihood + known;
        let amplitudes = self.setting.problem.terms()[term].amplitudes;
        deviate(2.0 * (with - without), amplitudes)
    }

    /// What a fit gains by a term, on the scale of [`deviate`].
    pub(super) fn statistic(&self, fitted: &Fitted, term: usize, below: f64) -> f64 {
        let amplitudes = self.setting.problem.terms()[term].amplitudes;
        deviate(2.0 * (fitted.log_likelihood - below), amplitudes)
    }

    /// The log-likelihood that a further fit must come to beside those that are known: to be accepted, and to be preferred.
    fn least_of_use(&self, fits: &[(Fitted, usize)], model: &Fitted, limit: f64, way: Way) -> f64 {
        let base = model.log_likelihood;
        let accepted = fits
            .iter()
            .filter(|(f, t)| self.statistic(f, *t, base) >= limit);
        let least = base + 0.5 * likelihood_ratio(limit, 1) - WORTH_A_SWAP;
        accepted.fold(least, |least, (f, t)| {
            least.max(self.worth(f, *t, way) - self.decision.alike)
        })
    }
}

/// What the strongest of some candidates promises, on the scale of [`deviate`].
fn strongest(shown: &[Shown]) -> f64 {
    shown.first().map_or(f64::NEG_INFINITY, Shown::deviate)
}
