//! A term comes in while another gives way: alone neither would. What came in first may have taken up what two others explain together, as when the
//! bending of a bracket stands for a frame that yields and an insertion that is elsewhere than drawn.

use super::candidates::scaled;
use super::step::Next;
use super::{Found, Search, Way};
use crate::fit::Fitted;
use crate::screen::Screen;
use crate::statistic::upper_tail;

/// How many terms are tried in the place of each.
const IN_ITS_PLACE: usize = 4;

/// A model with a further term, and another in the place of one.
struct Pair {
    fitted: Fitted,
    worth: f64,
    /// What is in the place of those that were found.
    terms: Vec<usize>,
    /// What comes in.
    further: usize,
}

impl Search<'_> {
    /// The best of the models with a further term and another in the place of one, both with names; none where none is improbable enough beside the
    /// model. What gave way is replaced among those found.
    pub(super) fn pair(
        &self,
        found: &mut Found,
        draws: &[f64],
        limit: f64,
        way: Way,
    ) -> Option<Next> {
        let base = found.model.log_likelihood;
        let way = Way {
            named_only: true,
            ..way
        };
        let models = self.with_another(found, way);
        let pairs = models.iter().flat_map(|(terms, model)| {
            let screen = self.screen(self.setting, model, way);
            let shown = screen.shown(2 * Screen::refined_in_draws());
            let fits = self.fits(&screen, model, &shown, &[], limit);
            fits.into_iter().map(|(fitted, further)| Pair {
                worth: self.worth(&fitted, further, way),
                fitted,
                terms: terms.clone(),
                further,
            })
        });
        let is_inside = |fitted: &Fitted| {
            let mut terms = fitted.point.terms.iter();
            terms.all(|(t, _)| self.is_inside(fitted, *t))
        };
        let best = pairs
            .filter(|p| self.statistic(&p.fitted, p.further, base) >= limit && is_inside(&p.fitted))
            .max_by(|a, b| a.worth.total_cmp(&b.worth))?;
        for (accepted, term) in found.accepted.iter_mut().zip(best.terms) {
            accepted.term = term;
        }
        let fitted = self.estimated(&best.fitted);
        Some(Next {
            p: upper_tail(draws, self.statistic(&fitted, best.further, base)),
            critical: limit,
            fitted,
            term: best.further,
        })
    }

    /// The models with another term in the place of each that was found, those that show most, with their terms.
    fn with_another(&self, found: &Found, way: Way) -> Vec<(Vec<usize>, Fitted)> {
        let own: Vec<usize> = found.accepted.iter().map(|a| a.term).collect();
        let mut models = Vec::new();
        for (place, term) in own.iter().enumerate() {
            let without = self.left_out(&found.model, *term);
            let screen = self.screen(self.setting, &without, way);
            let mut others = Vec::new();
            for s in &screen.shown(2 * Screen::refined_in_draws()) {
                let direction = &screen.directions[s.direction];
                let other = direction.term;
                let is_new = !own.contains(&other) && !others.contains(&other);
                if !is_new || self.is_decoy(other) || others.len() >= IN_ITS_PLACE {
                    continue;
                }
                others.push(other);
                let mut from = without.point.clone();
                let start = scaled(&direction.start, &s.estimate);
                from.terms.push((other, start));
                let starts = self.starts(&without);
                let fitted = self.setting.compare(&from, &starts, f64::NEG_INFINITY);
                let mut terms = own.clone();
                terms[place] = other;
                models.push((terms, fitted));
            }
        }
        models
    }
}
