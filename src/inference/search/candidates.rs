//! The candidates beside a model, fitted in full: from where their tangents lead, from the values of a model that is tried, from usual sizes, and
//! from far away.

use super::{FITTED, Search, Way};
use crate::fit::Fitted;
use crate::problem::Point;
use crate::screen::{Screen, Shown};
use crate::system::Variances;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A fit that keeps less than this share of what the linear model promised is made again from nothing.
const PROMISED: f64 = 0.8;

/// Of the starts of a term that are far away, how many are followed.
const FOLLOWED: usize = 2;

/// A start of a term far from nothing, and where it leads at a glance.
struct Far {
    term: usize,
    from: Point,
    led_to: Point,
    variances: Variances,
    log_likelihood: f64,
}

/// The starts that are followed: those of each term that lead to the largest likelihoods.
fn followed(mut starts: Vec<Far>) -> Vec<Far> {
    starts.sort_by(|a, b| b.log_likelihood.total_cmp(&a.log_likelihood));
    let mut counts = BTreeMap::new();
    starts.retain(|start| {
        let count = counts.entry(start.term).or_insert(0);
        *count += 1;
        *count <= FOLLOWED
    });
    starts
}

impl Search<'_> {
    /// The strongest candidates fitted in full, beyond those that are fitted already. One that ends at its bound, or does not show beyond its scatter,
    /// takes no other's place; where the strongest of a kind that tells groups apart does not, no other such one would.
    pub(super) fn fits(
        &self,
        screen: &Screen,
        model: &Fitted,
        shown: &[Shown],
        known: &[(Fitted, usize)],
        limit: f64,
    ) -> Vec<(Fitted, usize)> {
        let kind = |t: usize| self.setting.problem.terms()[t].kind;
        let mut scattered = Vec::new();
        let mut tried = 0;
        let mut fits: Vec<(Fitted, usize)> = Vec::new();
        let gain = |f: &Fitted| 2.0 * (f.log_likelihood - model.log_likelihood);
        let mut gained = known.iter().fold(0.0_f64, |m, (f, _)| m.max(gain(f)));
        for s in shown {
            if fits.len() >= FITTED || tried >= 2 * Screen::refined_in_draws() {
                break;
            }
            let term = screen.directions[s.direction].term;
            let acts_on_parts = || !self.setting.problem.scatters(&model.point, term).is_empty();
            if scattered.contains(&kind(term)) && acts_on_parts() {
                continue;
            }
            tried += 1;
            // What promises less than was gained already is left to the swaps, if it cannot be alike either.
            let alike = gained - 2.0 * self.decision.alike;
            if s.likelihood_ratio < alike.min(PROMISED * gained) {
                break;
            }
            let direction = &screen.directions[s.direction];
            let is_known = known.iter().any(|(_, t)| *t == direction.term);
            if is_known || self.is_decoy(direction.term) {
                continue;
            }
            let mut from = model.point.clone();
            from.terms
                .push((direction.term, scaled(&direction.start, &s.estimate)));
            let anywhere = f64::NEG_INFINITY;
            let fit = self.setting.compare(&from, &self.starts(model), anywhere);
            // The linear model promised more: the iteration has gone to another optimum.
            let again = (self.decision.thorough && gain(&fit) < PROMISED * s.likelihood_ratio)
                .then(|| self.setting.compare_afresh(&from, anywhere));
            let better = [Some(fit), again].into_iter().flatten();
            let better = better
                .filter(|f| self.is_inside(f, direction.term))
                .max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood));
            let Some(fit) = better else {
                continue;
            };
            if self.beyond_scatter(&fit, direction.term, model) < limit {
                scattered.push(kind(direction.term));
                tried -= 1;
                continue;
            }
            gained = gained.max(gain(&fit));
            fits.push((fit, direction.term));
        }
        fits
    }

    /// Fits of the terms of the model that is tried, of kinds that are not in the model.
    pub(super) fn fits_tried(&self, model: &Fitted) -> Vec<(Fitted, usize)> {
        let Some(tried) = self.tried else {
            return Vec::new();
        };
        let kind = |t: usize| self.setting.problem.terms()[t].kind;
        let known = |t: usize| model.point.terms.iter().any(|(k, _)| kind(*k) == kind(t));
        let starts = [tried.variances.clone(), model.variances.clone()];
        let new = tried.point.terms.iter().filter(|(t, _)| !known(*t));
        let fits = new.map(|(t, values)| {
            let mut from = model.point.clone();
            from.coefficients.clone_from(&tried.point.coefficients);
            from.terms.push((*t, values.clone()));
            (self.setting.compare(&from, &starts, f64::NEG_INFINITY), *t)
        });
        fits.filter(|(fit, t)| self.is_inside(fit, *t)).collect()
    }

    /// Fits of the terms that gain most beside a model whose components have their usual sizes: where a law is far off, scatter and misfit have
    /// taken the place of what it lacks, and the directions there no longer show it.
    pub(super) fn fits_afresh(&self, model: &Fitted, way: Way) -> Vec<(Fitted, usize)> {
        let usual = self.setting.usual();
        let mut from = self.setting.problem.start();
        from.terms.clone_from(&model.point.terms);
        let bare = usual.compare(&from, &usual.fresh()[..1], f64::NEG_INFINITY);
        let screen = self.screen(&usual, &bare, way);
        let shown = screen.shown(2 * FITTED);
        let mut kinds = Vec::new();
        let mut fits = Vec::new();
        for s in &shown {
            let direction = &screen.directions[s.direction];
            let kind = self.setting.problem.terms()[direction.term].kind;
            let is_out =
                self.is_decoy(direction.term) || !self.may_come(model, direction.term, way);
            if kinds.contains(&kind) || is_out {
                continue;
            }
            if fits.len() >= FITTED {
                break;
            }
            kinds.push(kind);
            let mut from = bare.point.clone();
            from.terms
                .push((direction.term, scaled(&direction.start, &s.estimate)));
            let fit = self.setting.compare_afresh(&from, f64::NEG_INFINITY);
            if self.is_inside(&fit, direction.term) {
                fits.push((fit, direction.term));
            }
        }
        fits
    }

    /// Fits of the terms that a tangent may not show, from amplitudes that are far from nothing; only those that come to a log-likelihood of
    /// `least`.
    pub(super) fn fits_far(&self, model: &Fitted, way: Way, least: f64) -> Vec<(Fitted, usize)> {
        let terms = self.setting.problem.terms();
        let kinds: Vec<usize> = model
            .point
            .terms
            .iter()
            .map(|(t, _)| terms[*t].kind)
            .collect();
        let may_come = |t: usize| {
            let is_new = !kinds.contains(&terms[t].kind) && self.may_come(model, t, way);
            is_new && (terms[t].named || !way.named_only)
        };
        let starts = self.setting.problem.far(&model.point).into_par_iter();
        let starts = starts.filter(|(t, _)| may_come(*t));
        let starts = starts.map(|(term, values)| self.glanced(model, term, values));
        let fits = followed(starts.collect()).into_par_iter();
        let fits = fits.map(|far| (self.fit_far(&far, least), far.term));
        let mut fits: Vec<(Fitted, usize)> = fits.collect();
        fits.retain(|(f, t)| f.log_likelihood >= least && self.is_inside(f, *t));
        fits
    }

    /// A start, and where it leads.
    fn glanced(&self, model: &Fitted, term: usize, values: Vec<f64>) -> Far {
        let mut from = model.point.clone();
        from.terms.push((term, values));
        let starts = std::slice::from_ref(&model.variances);
        let fit = self.setting.glance(&from, starts);
        Far {
            term,
            from,
            led_to: fit.point,
            variances: fit.variances,
            // What has none comes last.
            log_likelihood: fit.log_likelihood.max(f64::NEG_INFINITY),
        }
    }

    /// The fit from a start.
    fn fit_far(&self, far: &Far, least: f64) -> Fitted {
        let starts = std::slice::from_ref(&far.variances);
        let fit = self.setting.compare(&far.led_to, starts, least);
        if fit.converged || fit.log_likelihood < least || !self.is_inside(&fit, far.term) {
            return fit;
        }
        // The coefficients of the model without it may be too far off.
        let again = self.setting.compare_afresh(&far.from, least);
        if again.log_likelihood > fit.log_likelihood {
            again
        } else {
            fit
        }
    }

    /// Whether the amplitudes of a term lie within their bounds: at the edge of what is possible there is no estimate.
    pub(super) fn is_inside(&self, fitted: &Fitted, term: usize) -> bool {
        let term_of = &self.setting.problem.terms()[term];
        let values = fitted.values(term).unwrap_or(&[]);
        let amplitudes = values.iter().take(term_of.amplitudes);
        let mut inside = amplitudes.zip(&term_of.bounds);
        inside.all(|(x, (low, high))| x > low && x < high)
    }

    /// Whether a term is known to be nothing.
    pub(super) fn is_decoy(&self, term: usize) -> bool {
        self.setting.problem.terms()[term].decoy
    }

    /// Variances where a fit starts: those of the model before it, and usual ones.
    pub(super) fn starts(&self, model: &Fitted) -> Vec<Variances> {
        let mut starts = vec![model.variances.clone()];
        starts.extend(self.setting.fresh());
        starts
    }
}

/// The start of a term: each amplitude times its estimate, the shape as it is.
pub(super) fn scaled(start: &[f64], estimate: &[f64]) -> Vec<f64> {
    let values = start.iter().enumerate();
    values
        .map(|(k, x)| estimate.get(k).map_or(*x, |e| e * x))
        .collect()
}
