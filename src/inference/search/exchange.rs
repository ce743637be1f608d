//! The model built anew with every choice of forms of what was found: the first form to come in may have led the others to another optimum.

use super::candidates::scaled;
use super::{Found, Search, WORTH_A_SWAP, Way};
use crate::fit::Fitted;
use crate::screen::Screen;

/// Most choices of forms that are built anew.
const MOST_CHOICES: usize = 8;

impl Search<'_> {
    /// Builds the model anew with every choice of forms of what was found, and takes the best, if it gains.
    pub(super) fn exchange(&self, found: &mut Found, way: Way) {
        let problem = self.setting.problem;
        let worth = |fit: &Fitted| {
            let terms = fit.point.terms.iter().map(|(t, _)| *t);
            self.weighed(fit)
                - terms
                    .map(|t| self.of_further_amplitudes(t, way))
                    .sum::<f64>()
        };
        let mut best: Option<(Vec<usize>, Fitted)> = None;
        for choice in self.choices(found) {
            let Some(fit) = self.rebuilt(&choice) else {
                continue;
            };
            let least = best
                .as_ref()
                .map_or(worth(&found.model) + WORTH_A_SWAP, |(_, best)| worth(best));
            let inside = fit
                .point
                .terms
                .iter()
                .all(|(t, _)| self.is_inside(&fit, *t));
            if inside && worth(&fit) > least {
                best = Some((choice, fit));
            }
        }
        let Some((choice, fit)) = best else {
            return;
        };
        for accepted in &mut found.accepted {
            let kind = problem.terms()[accepted.term].kind;
            let chosen = choice.iter().find(|t| problem.terms()[**t].kind == kind);
            accepted.term = chosen.copied().unwrap_or(accepted.term);
        }
        found.model = self.estimated(&fit);
    }

    /// Every choice of one form for each kind that was found, in the order in which the kinds came in.
    fn choices(&self, found: &Found) -> Vec<Vec<usize>> {
        let terms = self.setting.problem.terms();
        let mut choices: Vec<Vec<usize>> = vec![Vec::new()];
        for accepted in &found.accepted {
            let kind = terms[accepted.term].kind;
            let forms: Vec<usize> = (0..terms.len())
                .filter(|t| terms[*t].kind == kind)
                .collect();
            // Of what has no name, or would be one too many, the form that came in.
            let is_named = terms[accepted.term].named;
            let forms = if !is_named || choices.len() * forms.len() > MOST_CHOICES {
                vec![accepted.term]
            } else {
                forms
            };
            let with = |c: &Vec<usize>| -> Vec<Vec<usize>> {
                let added = forms
                    .iter()
                    .map(|f| c.iter().copied().chain([*f]).collect());
                added.collect()
            };
            choices = choices.iter().flat_map(with).collect();
        }
        choices
    }

    /// A model of some terms that come in one after the other, each from what its direction shows; none where one of them shows nothing.
    fn rebuilt(&self, terms: &[usize]) -> Option<Fitted> {
        let usual = self.setting.usual();
        let anywhere = f64::NEG_INFINITY;
        let mut model = usual.compare(&self.setting.problem.start(), &usual.fresh()[..1], anywhere);
        for term in terms {
            let directions = self.setting.problem.directions_of(&model.point, *term);
            let screen = Screen::of(self.setting, &model, directions);
            let shown = screen.shown(0).into_iter().next()?;
            let direction = &screen.directions[shown.direction];
            let mut from = model.point.clone();
            from.terms
                .push((*term, scaled(&direction.start, &shown.estimate)));
            drop(screen);
            model = self.setting.compare_afresh(&from, anywhere);
        }
        Some(model)
    }
}
