//! The search: forward from the null model, one term at a time, each tested against the maximum over all candidates; then deletions and
//! swaps among terms that show alike.

use crate::fit::{Fitted, Free, Setting};
use crate::problem::Point;
use crate::screen::{Normal, Screen, Shown};
use crate::statistic::{critical, deviate, upper_tail};
use crate::system::Variances;

/// The numbers on which a search decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// Family-wise level.
    pub level: f64,
    /// Draws of the bootstrap.
    pub draws: usize,
    /// Models whose log-likelihoods differ by less are alike: their terms are indistinguishable.
    pub alike: f64,
    /// Most terms in a model.
    pub most_terms: usize,
    /// Whether candidates are also looked for from nothing, and alternatives to what was accepted. Inside folds, where a search starts from what
    /// all readings gave, neither is needed.
    pub thorough: bool,
}

/// A term that was accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// Number of the term.
    pub term: usize,
    /// Family-wise probability, at the step where it came in.
    pub p: f64,
    /// Gain in log-likelihood over the final model without it.
    pub gain: f64,
    /// Terms of other kinds that do as well in its place: number, log-likelihood less that of the model.
    pub in_its_place: Vec<(usize, f64)>,
}

/// What a search found; the models are where queries start.
#[derive(Clone, Debug)]
pub struct Found {
    /// The model without terms.
    pub null: Fitted,
    /// The final model.
    pub model: Fitted,
    /// Its terms, in the order in which they came in.
    pub accepted: Vec<Accepted>,
    /// The candidates beside the null, strongest first, with the number of the term.
    pub tested: Vec<(usize, Shown)>,
    /// Maxima of the draws from the null.
    pub draws: Vec<f64>,
    /// The value of [`deviate`] from which a candidate is accepted.
    pub critical: f64,
}

/// A candidate whose probability under the draws from the null lies in this range is tested against draws from its own model as well; beyond
/// it they could not change the answer, because the distribution of the maximum follows from the design far more than from the model.
const CLOSE: (f64, f64) = (0.2, 4.0);
/// How many of the strongest candidates are fitted in full.
const FITTED: usize = 3;
/// A statistic this many times the critical one needs no draws of its own.
const CLEAR: f64 = 2.0;
/// A fit that keeps less than this share of what the linear model promised is made again from nothing.
const PROMISED: f64 = 0.8;
/// A swap has to gain this much in log-likelihood, else the search would go in circles.
const WORTH_A_SWAP: f64 = 0.1;
/// How often a better optimum of the model without a further term is taken up.
const MOST_BETTER: usize = 3;

/// A problem's search.
pub struct Search<'a> {
    /// The problem and its active part.
    pub setting: &'a Setting<'a>,
    /// What decides.
    pub decision: Decision,
    /// A model of the same problem whose terms are tried from its values, besides those that a screen shows.
    pub tried: Option<&'a Fitted>,
}

/// The strongest candidate beside a model, fitted.
struct Next {
    fitted: Fitted,
    term: usize,
    p: f64,
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
    /// Searches from a fitted null. `known` are draws of the same design, which stand for draws from this null.
    pub fn run(&self, null: Fitted, normal: &Normal, known: Option<&[f64]>) -> Found {
        let screen = Screen::new(self.setting, &null);
        let shown = screen.shown(2 * Screen::refined_in_draws());
        let draws = known.map_or_else(
            || screen.draws(self.decision.draws, normal),
            <[f64]>::to_vec,
        );
        let mut found = Found {
            critical: critical(&draws, self.decision.level),
            tested: shown
                .iter()
                .map(|s| (screen.directions[s.direction].term, s.clone()))
                .collect(),
            model: null.clone(),
            null: null.clone(),
            accepted: Vec::new(),
            draws,
        };
        drop(screen);
        let mut better = 0;
        while found.accepted.len() < self.decision.most_terms {
            let next = match self.next(&mut found, normal, known.is_none()) {
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
                gain: next.fitted.log_likelihood - found.model.log_likelihood,
                in_its_place: Vec::new(),
            });
            found.model = next.fitted;
        }
        self.tidy(&mut found);
        found
    }

    /// The candidate that comes in next, or none. A model to which a better null belongs replaces it.
    fn next(&self, found: &mut Found, normal: &Normal, again: bool) -> Step {
        let model = found.model.clone();
        let screen = Screen::new(self.setting, &model);
        let shown = screen.shown(2 * Screen::refined_in_draws());
        let first = shown.first().map_or(f64::NEG_INFINITY, Shown::deviate);
        let mut draws = found.draws.clone();
        let close = (CLOSE.0 * self.decision.level, CLOSE.1 * self.decision.level);
        let p = upper_tail(&draws, first);
        let is_close = p > close.0 && p < close.1;
        // Draws of more groups than there are here have lighter tails: they decide what is clear, no more.
        let is_doubtful = first >= found.critical && first < CLEAR * found.critical;
        if (again && !found.accepted.is_empty() && is_close) || (!again && is_doubtful) {
            draws = screen.draws(self.decision.draws, normal);
        }
        let limit = critical(&draws, self.decision.level);
        let mut fits = self.fits_tried(&model);
        if first >= limit {
            fits.extend(self.fits(&screen, &model, &shown));
        }
        if self.decision.thorough && (found.accepted.is_empty() || fits.is_empty()) {
            fits.extend(self.fits_afresh(&model));
        }
        let Some((fitted, term)) = self.preferred(&fits) else {
            return Step::Nothing;
        };
        let without = self.altered(&fitted, term, None);
        let is_better = without.log_likelihood > model.log_likelihood + WORTH_A_SWAP;
        if is_better {
            if found.accepted.is_empty() {
                found.null = without.clone();
            }
            found.model = without;
        }
        let amplitudes = self.setting.problem.terms()[term].amplitudes;
        let gain = fitted.log_likelihood - found.model.log_likelihood;
        let statistic = deviate(2.0 * gain, amplitudes);
        if statistic >= limit {
            Step::Accepted(Box::new(Next {
                p: upper_tail(&draws, statistic),
                fitted,
                term,
            }))
        } else if is_better {
            Step::BetterBase
        } else {
            Step::Nothing
        }
    }

    /// Fits of the terms of the model that is tried.
    fn fits_tried(&self, model: &Fitted) -> Vec<(Fitted, usize)> {
        let Some(tried) = self.tried else {
            return Vec::new();
        };
        let known = |t: usize| model.point.terms.iter().any(|(k, _)| *k == t);
        let new = tried.point.terms.iter().filter(|(t, _)| !known(*t));
        new.map(|(t, values)| {
            let mut from = model.point.clone();
            for (k, c) in tried.point.coefficients.iter().enumerate() {
                if !self.setting.pinned.contains(&Free::Coefficient(k)) {
                    from.coefficients[k] = *c;
                }
            }
            from.terms.push((*t, values.clone()));
            let starts = [tried.variances.clone(), model.variances.clone()];
            (self.setting.fit(&from, &starts), *t)
        })
        .collect()
    }

    /// Fits of the terms that gain most beside a model whose components have their usual sizes: where a law is far off, scatter and misfit have
    /// taken the place of what it lacks, and the directions there no longer show it.
    fn fits_afresh(&self, model: &Fitted) -> Vec<(Fitted, usize)> {
        let usual = self.setting.usual();
        let mut from = self.setting.problem.start();
        from.terms.clone_from(&model.point.terms);
        let bare = usual.fit(&from, &usual.fresh()[..1]);
        let screen = Screen::new(&usual, &bare);
        let shown = screen.shown(2 * FITTED);
        let mut kinds = Vec::new();
        let mut starts = Vec::new();
        for s in &shown {
            let direction = &screen.directions[s.direction];
            let kind = self.setting.problem.terms()[direction.term].kind;
            if kinds.contains(&kind) || kinds.len() >= FITTED {
                continue;
            }
            kinds.push(kind);
            let mut from = bare.point.clone();
            from.terms
                .push((direction.term, scaled(&direction.start, &s.estimate)));
            starts.push((from, direction.term));
        }
        starts
            .into_iter()
            .map(|(from, term)| (self.setting.fit_afresh(&from), term))
            .collect()
    }

    /// The strongest candidates fitted in full.
    fn fits(&self, screen: &Screen, model: &Fitted, shown: &[Shown]) -> Vec<(Fitted, usize)> {
        let mut fits: Vec<(Fitted, usize)> = Vec::new();
        let mut gained = 0.0_f64;
        for s in shown.iter().take(FITTED) {
            // What promises less than was gained already is left to the swaps.
            if s.likelihood_ratio < PROMISED * gained {
                break;
            }
            let direction = &screen.directions[s.direction];
            let mut from = model.point.clone();
            from.terms
                .push((direction.term, scaled(&direction.start, &s.estimate)));
            let fit = self.setting.fit(&from, &self.starts(model));
            // The linear model promised more: the iteration has gone to another optimum.
            if 2.0 * (fit.log_likelihood - model.log_likelihood) < PROMISED * s.likelihood_ratio {
                fits.push((self.setting.fit_afresh(&from), direction.term));
            }
            gained = gained.max(2.0 * (fit.log_likelihood - model.log_likelihood));
            fits.push((fit, direction.term));
        }
        fits
    }

    /// The best of some fits, by the last term of each; a term with a name before one without where both are alike.
    fn preferred(&self, fits: &[(Fitted, usize)]) -> Option<(Fitted, usize)> {
        let problem = self.setting.problem;
        let inside = || fits.iter().filter(|(f, t)| self.is_inside(f, *t));
        let best = best_fit(inside())?;
        let named = inside().filter(|(_, t)| problem.terms()[*t].named);
        let alike =
            |n: &&(Fitted, usize)| n.0.log_likelihood > best.0.log_likelihood - self.decision.alike;
        Some(best_fit(named).filter(alike).unwrap_or(best).clone())
    }

    /// Whether the amplitudes of a term lie within their bounds: at the edge of what is possible there is no estimate.
    fn is_inside(&self, fitted: &Fitted, term: usize) -> bool {
        let term_of = &self.setting.problem.terms()[term];
        let values = fitted.values(term).unwrap_or(&[]);
        let amplitudes = values.iter().take(term_of.amplitudes);
        let mut inside = amplitudes.zip(&term_of.bounds);
        inside.all(|(x, (low, high))| x > low && x < high)
    }

    /// Variances where a fit starts: those of the model before it, and usual ones.
    fn starts(&self, model: &Fitted) -> Vec<Variances> {
        let mut starts = vec![model.variances.clone()];
        starts.extend(self.setting.fresh());
        starts
    }

    /// A model with one of its terms left out, or another in its place.
    fn altered(&self, model: &Fitted, term: usize, other: Option<(usize, Vec<f64>)>) -> Fitted {
        let mut from: Point = model.point.clone();
        from.terms.retain(|(t, _)| *t != term);
        from.terms.extend(other);
        self.setting.fit(&from, &self.starts(model))
    }

    /// Deletions and swaps, and the alternatives to every term.
    fn tidy(&self, found: &mut Found) {
        let mut place = 0;
        let mut swaps = found.accepted.len();
        while place < found.accepted.len() {
            let term = found.accepted[place].term;
            let without = self.altered(&found.model, term, None);
            let gain = found.model.log_likelihood - without.log_likelihood;
            let amplitudes = self.setting.problem.terms()[term].amplitudes;
            if deviate(2.0 * gain, amplitudes) < found.critical {
                found.accepted.remove(place);
                found.model = without;
                place = 0;
                continue;
            }
            found.accepted[place].gain = gain;
            let others = if self.decision.thorough {
                self.others(&found.model, &without, term, gain)
            } else {
                Vec::new()
            };
            let better = others
                .iter()
                .filter(|(_, f)| f.log_likelihood > found.model.log_likelihood + WORTH_A_SWAP)
                .max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood));
            if let (Some((other, fit)), true) = (better, swaps > 0) {
                swaps -= 1;
                found.accepted[place].term = *other;
                found.model = fit.clone();
                place = 0;
                continue;
            }
            let kind = self.setting.problem.terms()[term].kind;
            found.accepted[place].in_its_place = others
                .into_iter()
                .filter(|(t, _)| self.setting.problem.terms()[*t].kind != kind)
                .map(|(t, f)| (t, f.log_likelihood - found.model.log_likelihood))
                .collect();
            place += 1;
        }
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
            let fit = self.altered(model, term, Some((direction.term, start)));
            if fit.log_likelihood > model.log_likelihood - self.decision.alike {
                fits.push((direction.term, fit));
            }
        }
        fits
    }
}

fn best_fit<'f>(fits: impl Iterator<Item = &'f (Fitted, usize)>) -> Option<&'f (Fitted, usize)> {
    fits.max_by(|a, b| a.0.log_likelihood.total_cmp(&b.0.log_likelihood))
}

/// The start of a term: each amplitude times its estimate, the shape as it is.
fn scaled(start: &[f64], estimate: &[f64]) -> Vec<f64> {
    let values = start.iter().enumerate();
    values
        .map(|(k, x)| estimate.get(k).map_or(*x, |e| e * x))
        .collect()
}
