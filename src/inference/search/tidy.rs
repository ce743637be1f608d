//! Deletions and swaps among the terms of a model, and what does as well in the place of each.

use super::candidates::scaled;
use super::{FITTED, Found, Instead, Search, WORTH_A_SWAP, Way};
use crate::fit::Fitted;
use crate::problem::Point;
use crate::screen::Screen;
use crate::statistic::deviate;
use std::cmp::Ordering;

impl Search<'_> {
    /// Deletions and swaps, and the alternatives to every term.
    pub(super) fn tidy(&self, found: &mut Found, way: Way) {
        let mut place = 0;
        let mut swaps = found.accepted.len();
        while place < found.accepted.len() {
            let term = found.accepted[place].term;
            let without = self.without(found, term);
            let gain = found.model.log_likelihood - without.log_likelihood;
            let amplitudes = self.setting.problem.terms()[term].amplitudes;
            let is_improbable = deviate(2.0 * gain, amplitudes) >= found.accepted[place].critical;
            // What has come to its bound beside later terms has no estimate.
            if !is_improbable || !self.is_inside(&found.model, term) {
                found.accepted.remove(place);
                found.model = without;
                place = 0;
                continue;
            }
            found.accepted[place].gain = gain;
            let mut others = self.instead_of(&found.model, &without, term, gain, way);
            let critical = found.accepted[place].critical;
            others.retain(|(t, f)| self.beyond_scatter(f, *t, &without) >= critical);
            let better = self.better(&others, &found.model, term, way);
            if let (Some((other, fit)), true) = (better, swaps > 0) {
                swaps -= 1;
                found.accepted[place].term = *other;
                found.model = self.estimated(fit);
                place = 0;
                continue;
            }
            found.accepted[place].in_its_place = self.alike(others, &found.model, term);
            place += 1;
        }
    }

    fn is_named(&self, term: usize) -> bool {
        self.setting.problem.terms()[term].named
    }

    /// Fits of other terms in the place of one, also of those that no tangent shows.
    fn instead_of(
        &self,
        model: &Fitted,
        without: &Fitted,
        term: usize,
        gain: f64,
        way: Way,
    ) -> Vec<(usize, Fitted)> {
        let mut others = if self.decision.thorough {
            self.others(model, without, term, gain)
        } else {
            Vec::new()
        };
        // What no tangent shows has alternatives that none shows either.
        if self.decision.thorough && !(self.is_named(term) && self.shows(without, term)) {
            let own = self.worth(model, term, way) - self.decision.alike;
            let way_of_names = Way {
                named_only: true,
                ..way
            };
            let far = self.fits_far(without, way_of_names, own);
            let far = far
                .into_iter()
                .filter(|(f, t)| *t != term && self.worth(f, *t, way) > own);
            others.extend(far.map(|(f, t)| (t, f)));
        }
        others
    }

    /// The best of the fits with another term in the place of one, if that is worth a swap.
    fn better<'f>(
        &self,
        others: &'f [(usize, Fitted)],
        model: &Fitted,
        term: usize,
        way: Way,
    ) -> Option<(&'f usize, &'f Fitted)> {
        let own = self.worth(model, term, way);
        // What is simpler gives way only where they are not alike.
        let least = |other: usize| match self.simplicity(term).cmp(&self.simplicity(other)) {
            Ordering::Greater => self.decision.alike,
            Ordering::Less => -self.decision.alike,
            Ordering::Equal => WORTH_A_SWAP,
        };
        let better = others
            .iter()
            .map(|(t, f)| (self.worth(f, *t, way), t, f))
            .filter(|(worth, t, _)| *worth > own + least(**t))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        better.map(|(_, other, fit)| (other, fit))
    }

    /// Those of the fits with a term of another kind in the place of one that do as well.
    fn alike(&self, others: Vec<(usize, Fitted)>, model: &Fitted, term: usize) -> Vec<Instead> {
        let kind = self.setting.problem.terms()[term].kind;
        others
            .into_iter()
            .filter(|(t, f)| {
                self.setting.problem.terms()[*t].kind != kind
                    && f.log_likelihood > model.log_likelihood - self.decision.alike
            })
            .map(|(term, f)| Instead {
                term,
                log_likelihood: f.log_likelihood - model.log_likelihood,
                point: f.point,
            })
            .collect()
    }

    /// Fits of the terms that would explain nearly as much in the place of one, the best form of each kind.
    fn others(
        &self,
        model: &Fitted,
        without: &Fitted,
        term: usize,
        gain: f64,
    ) -> Vec<(usize, Fitted)> {
        let problem = self.setting.problem;
        let screen = Screen::new(self.setting, without);
        let mut kinds = Vec::new();
        let mut fits = Vec::new();
        for s in screen.shown(3 * Screen::refined_in_draws()) {
            let direction = &screen.directions[s.direction];
            let other = &problem.terms()[direction.term];
            let behind = 2.0 * gain - s.likelihood_ratio;
            let same = direction.term == term || model.values(direction.term).is_some();
            if same
                || other.decoy
                || kinds.contains(&other.kind)
                || behind > 4.0 * self.decision.alike + 0.3 * gain
            {
                continue;
            }
            if fits.len() >= 2 * FITTED {
                break;
            }
            kinds.push(other.kind);
            let start = scaled(&direction.start, &s.estimate);
            let alike = model.log_likelihood - self.decision.alike;
            let fit = self.exchanged(model, term, (direction.term, start), alike);
            let is_alike = fit.log_likelihood > alike;
            if is_alike && self.is_inside(&fit, direction.term) {
                fits.push((direction.term, fit));
            }
        }
        fits
    }

    /// A model with another term in the place of one, as far as it is of use: where it comes to a log-likelihood of `least`.
    fn exchanged(
        &self,
        model: &Fitted,
        term: usize,
        other: (usize, Vec<f64>),
        least: f64,
    ) -> Fitted {
        let mut from: Point = model.point.clone();
        from.terms.retain(|(t, _)| *t != term);
        from.terms.push(other);
        self.setting.compare(&from, &self.starts(model), least)
    }

    /// Whether a term can be told from the fixed effects of a model by its tangent.
    fn shows(&self, model: &Fitted, term: usize) -> bool {
        let directions = self.setting.problem.directions_of(&model.point, term);
        !Screen::of(self.setting, model, directions)
            .shown(0)
            .is_empty()
    }
}
