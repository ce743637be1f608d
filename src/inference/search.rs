//! The search: forward from the null model, one term at a time, each tested against the maximum over all candidates; then deletions and
//! swaps among terms that show alike. At the end a term stays only if it also shows where the size of any other one may bend along its own argument
//! ([`crate::problem::Problem::bends`]): an effect whose form the library does not have must not call up a second one.

use crate::fit::{Fitted, Free, Setting};
use crate::form;
use crate::problem::Point;
use crate::screen::{Normal, Screen, Shown};
use crate::statistic::{critical, deviate, likelihood_ratio, upper_tail};
use crate::system::Variances;
use rayon::prelude::*;

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
    /// The value of [`deviate`] from which it was accepted.
    pub critical: f64,
    /// Gain in log-likelihood over the final model without it.
    pub gain: f64,
    /// Terms of other kinds that do as well in its place.
    pub in_its_place: Vec<Instead>,
}

/// A term that does as well in the place of another.
#[derive(Clone, Debug, PartialEq)]
pub struct Instead {
    /// Number of the term.
    pub term: usize,
    /// Log-likelihood less that of the model.
    pub log_likelihood: f64,
    /// The model with it.
    pub point: Point,
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
    /// Models on the way to it: a deletion leads back to one of them, if a fit from the larger model does not come as far.
    stages: Vec<Fitted>,
    /// The final model and others on the way without one of their terms.
    left_out: Vec<LeftOut>,
    /// The candidates beside the null, strongest first, with the number of the term.
    pub tested: Vec<(usize, Shown)>,
    /// Maxima of the draws from the null.
    pub draws: Vec<f64>,
    /// The value of [`deviate`] from which a candidate is accepted.
    pub critical: f64,
}

/// A model without one of its terms.
#[derive(Clone, Debug)]
struct LeftOut {
    of: Point,
    term: usize,
    rest: Fitted,
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
/// Most rounds of additions and deletions.
const MOST_ROUNDS: usize = 3;
/// Most choices of forms that are built anew.
const MOST_CHOICES: usize = 8;

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
    critical: f64,
}

/// When a candidate is tested against draws from its own model as well as against those from the null.
#[derive(Clone, Copy)]
enum Drawn {
    /// Where the draws that were given, of another model of this kind, do not decide by far.
    IfDoubtful,
    /// Where that could change the answer in a design with many groups.
    IfClose,
    /// Wherever the null's draws do not make it improbable enough by far.
    Always,
}

/// How terms come in.
#[derive(Clone, Copy)]
struct Way {
    drawn: Drawn,
    /// Whether only terms with names do.
    named_only: bool,
    /// What each amplitude beyond the first has to gain for a term to be preferred to one without it.
    of_amplitude: f64,
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
        let mut found = self.begun(null, normal, known);
        let way = Way {
            drawn: known.map_or(Drawn::IfClose, |_| Drawn::IfDoubtful),
            named_only: false,
            of_amplitude: self.decision.alike,
        };
        // What gave way to a term that then went itself may come back.
        let mut ended = Vec::new();
        for _ in 0..MOST_ROUNDS {
            self.forward(&mut found, normal, way, self.decision.most_terms);
            let before = found.accepted.len();
            self.tidy(&mut found, way);
            let terms: Vec<usize> = found.accepted.iter().map(|a| a.term).collect();
            if found.accepted.len() == before || terms == ended {
                break;
            }
            ended = terms;
        }
        self.leave_out_bends(&mut found);
        found
    }

    /// A fit from where a comparison left it to its estimates.
    fn estimated(&self, compared: &Fitted) -> Fitted {
        let starts = std::slice::from_ref(&compared.variances);
        self.setting.fit(&compared.point, starts)
    }

    /// Leaves out the terms, the weakest first, that no longer show beside another one whose size bends along its own argument: where that has
    /// another form than the library knows, a second term takes up the difference.
    fn leave_out_bends(&self, found: &mut Found) {
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

    /// The same, with exchanges after every step: the model is built anew with every choice of forms, because the first form to come in may lead
    /// the others to another optimum. Where a term without a name came in, the terms with names
    /// are also tried by themselves first: a flexible curve beside half of what is there must not stand for the other half. Further terms are
    /// tested against draws from the model itself: with a handful of groups, what is between groups in the null model makes its draws wilder
    /// than those of a model that explains it. A term with several amplitudes has to be worth each of them. For problems whose fits are cheap.
    pub fn run_exchanging(&self, null: Fitted, normal: &Normal, known: Option<&[f64]>) -> Found {
        let begun = self.begun(null, normal, known);
        let way = |named_only| Way {
            drawn: known.map_or(Drawn::Always, |_| Drawn::IfDoubtful),
            named_only,
            of_amplitude: self.decision.alike,
        };
        let mut found = self.grown(begun.clone(), normal, way(false));
        let is_named = |a: &Accepted| self.setting.problem.terms()[a.term].named;
        if !found.accepted.iter().all(is_named) {
            let named = self.grown(begun, normal, way(true));
            let named = self.grown(named, normal, way(false));
            if named.model.log_likelihood > found.model.log_likelihood - self.decision.alike {
                found = named;
            }
        }
        self.tidy(&mut found, way(false));
        found
    }

    /// Terms come in one by one, with exchanges after each.
    fn grown(&self, mut found: Found, normal: &Normal, way: Way) -> Found {
        loop {
            let before = found.accepted.len();
            self.forward(
                &mut found,
                normal,
                way,
                (before + 1).min(self.decision.most_terms),
            );
            if found.accepted.len() == before {
                return found;
            }
            self.exchange(&mut found, way);
        }
    }

    /// The candidates beside a model.
    fn screen<'s>(&self, setting: &'s Setting<'s>, model: &'s Fitted, way: Way) -> Screen<'s> {
        let mut screen = Screen::new(setting, model);
        if way.named_only {
            let terms = setting.problem.terms();
            let mut directions = std::mem::take(&mut screen.directions);
            directions.retain(|d| terms[d.term].named);
            screen = Screen::of(setting, model, directions).bounded();
        }
        screen
    }

    /// The null with its candidates and draws.
    fn begun(&self, null: Fitted, normal: &Normal, known: Option<&[f64]>) -> Found {
        let screen = Screen::new(self.setting, &null);
        let shown = screen.shown(2 * Screen::refined_in_draws());
        let draws = known.map_or_else(
            || screen.draws(self.decision.draws, normal),
            <[f64]>::to_vec,
        );
        Found {
            critical: critical(&draws, self.decision.level),
            tested: shown
                .iter()
                .map(|s| (screen.directions[s.direction].term, s.clone()))
                .collect(),
            model: null.clone(),
            null: null.clone(),
            accepted: Vec::new(),
            stages: Vec::new(),
            left_out: Vec::new(),
            draws,
        }
    }

    /// Builds the model anew with every choice of forms of what was found, and takes the best, if it gains.
    fn exchange(&self, found: &mut Found, way: Way) {
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

    /// Terms come in until none is improbable enough, or there are so many.
    fn forward(&self, found: &mut Found, normal: &Normal, way: Way, most: usize) {
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
        let shown = screen.shown(2 * Screen::refined_in_draws());
        let first = shown.first().map_or(f64::NEG_INFINITY, Shown::deviate);
        let mut draws = found.draws.clone();
        let close = (CLOSE.0 * self.decision.level, CLOSE.1 * self.decision.level);
        let p = upper_tail(&draws, first);
        let is_first = found.accepted.is_empty();
        let redrawn = match way.drawn {
            // Draws of more groups than there are here have lighter tails: they decide what is clear, no more.
            Drawn::IfDoubtful => first >= found.critical && first < CLEAR * found.critical,
            Drawn::IfClose => !is_first && p > close.0 && p < close.1,
            Drawn::Always => !is_first && p > close.0,
        };
        if redrawn {
            let (most, level) = (self.decision.draws, self.decision.level);
            draws = if self.decision.thorough {
                screen.draws(most, normal)
            } else {
                screen.draws_to_decide(most, normal, level, first)
            };
        }
        let limit = critical(&draws, self.decision.level);
        let mut fits = self.fits_tried(&model);
        if first >= limit {
            let others = self.fits(&screen, &model, &shown, &fits);
            fits.extend(others);
        }
        if self.decision.thorough && (found.accepted.is_empty() || fits.is_empty()) {
            fits.extend(self.fits_afresh(&model, way));
        }
        let passes =
            |(f, t): &(Fitted, usize)| self.statistic(f, *t, model.log_likelihood) >= limit;
        if self.decision.thorough {
            let least = self.least_of_use(&fits, &model, limit, way);
            fits.extend(self.fits_far(&model, way, least));
        }
        // What would not be accepted keeps nothing out.
        if fits.iter().any(passes) {
            fits.retain(passes);
        }
        let Some((fitted, term)) = self.preferred(&fits, way) else {
            return Step::Nothing;
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
            Step::Nothing
        }
    }

    /// What a fit gains by a term, on the scale of [`deviate`].
    fn statistic(&self, fitted: &Fitted, term: usize, below: f64) -> f64 {
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

    /// Fits of the terms of the model that is tried, of kinds that are not in the model.
    fn fits_tried(&self, model: &Fitted) -> Vec<(Fitted, usize)> {
        let Some(tried) = self.tried else {
            return Vec::new();
        };
        let kind = |t: usize| self.setting.problem.terms()[t].kind;
        let known = |t: usize| model.point.terms.iter().any(|(k, _)| kind(*k) == kind(t));
        let starts = [tried.variances.clone(), model.variances.clone()];
        let new = tried.point.terms.iter().filter(|(t, _)| !known(*t));
        let fits = new.map(|(t, values)| {
            let mut from = model.point.clone();
            for (k, c) in tried.point.coefficients.iter().enumerate() {
                if !self.setting.pinned.contains(&Free::Coefficient(k)) {
                    from.coefficients[k] = *c;
                }
            }
            from.terms.push((*t, values.clone()));
            (self.setting.compare(&from, &starts, f64::NEG_INFINITY), *t)
        });
        fits.filter(|(fit, t)| self.is_inside(fit, *t)).collect()
    }

    /// Fits of the terms that gain most beside a model whose components have their usual sizes: where a law is far off, scatter and misfit have
    /// taken the place of what it lacks, and the directions there no longer show it.
    fn fits_afresh(&self, model: &Fitted, way: Way) -> Vec<(Fitted, usize)> {
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
            if kinds.contains(&kind) {
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
    fn fits_far(&self, model: &Fitted, way: Way, least: f64) -> Vec<(Fitted, usize)> {
        let terms = self.setting.problem.terms();
        let kinds: Vec<usize> = model
            .point
            .terms
            .iter()
            .map(|(t, _)| terms[*t].kind)
            .collect();
        let may_come =
            |t: usize| !kinds.contains(&terms[t].kind) && (terms[t].named || !way.named_only);
        let starts = self.setting.problem.far(&model.point);
        let fits = starts.into_par_iter().filter(|(t, _)| may_come(*t));
        let fits = fits.map(|(t, values)| {
            let mut from = model.point.clone();
            from.terms.push((t, values));
            let starts = std::slice::from_ref(&model.variances);
            let fit = self.setting.compare(&from, starts, least);
            if fit.converged || fit.log_likelihood < least {
                return (fit, t);
            }
            // The coefficients of the model without it may be too far off.
            let again = self.setting.compare_afresh(&from, least);
            let is_better = again.log_likelihood > fit.log_likelihood;
            (if is_better { again } else { fit }, t)
        });
        let mut fits: Vec<(Fitted, usize)> = fits.collect();
        fits.retain(|(f, t)| f.log_likelihood >= least && self.is_inside(f, *t));
        fits
    }

    /// The strongest candidates fitted in full, beyond those that are fitted already. One that ends at its bound takes no other's place.
    fn fits(
        &self,
        screen: &Screen,
        model: &Fitted,
        shown: &[Shown],
        known: &[(Fitted, usize)],
    ) -> Vec<(Fitted, usize)> {
        let mut fits: Vec<(Fitted, usize)> = Vec::new();
        let gain = |f: &Fitted| 2.0 * (f.log_likelihood - model.log_likelihood);
        let mut gained = known.iter().fold(0.0_f64, |m, (f, _)| m.max(gain(f)));
        for s in shown.iter().take(2 * Screen::refined_in_draws()) {
            if fits.len() >= FITTED {
                break;
            }
            // What promises less than was gained already is left to the swaps, if it cannot be alike either.
            let alike = gained - 2.0 * self.decision.alike;
            if s.likelihood_ratio < alike.min(PROMISED * gained) {
                break;
            }
            let direction = &screen.directions[s.direction];
            if known.iter().any(|(_, t)| *t == direction.term) {
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
            if let Some(fit) = better {
                gained = gained.max(gain(&fit));
                fits.push((fit, direction.term));
            }
        }
        fits
    }

    /// The log-likelihood of a fit, less what the amplitudes of a term have to be worth and what unusual sizes cost.
    fn worth(&self, fitted: &Fitted, term: usize, way: Way) -> f64 {
        self.weighed(fitted) - self.of_further_amplitudes(term, way)
    }

    /// What the amplitudes of a term beyond its first have to be worth.
    fn of_further_amplitudes(&self, term: usize, way: Way) -> f64 {
        let amplitudes = self.setting.problem.terms()[term].amplitudes;
        way.of_amplitude * amplitudes.saturating_sub(1) as f64
    }

    /// The log-likelihood of a fit with the prior of the sizes of its terms: normal, with the usual size as standard deviation.
    fn weighed(&self, fitted: &Fitted) -> f64 {
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

    /// The best of some fits, by the last term of each; a term with a name before one without where both are alike.
    fn preferred(&self, fits: &[(Fitted, usize)], way: Way) -> Option<(Fitted, usize)> {
        let problem = self.setting.problem;
        let worth = |(f, t): &(Fitted, usize)| self.worth(f, *t, way);
        let best_of = |a: &&(Fitted, usize), b: &&(Fitted, usize)| worth(a).total_cmp(&worth(b));
        let best = fits.iter().max_by(best_of)?;
        let named = fits.iter().filter(|(_, t)| problem.terms()[*t].named);
        let alike = |n: &&(Fitted, usize)| worth(n) > worth(best) - self.decision.alike;
        Some(named.max_by(best_of).filter(alike).unwrap_or(best).clone())
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

    /// A model with one of its terms left out.
    fn left_out(&self, model: &Fitted, term: usize) -> Fitted {
        let mut from: Point = model.point.clone();
        from.terms.retain(|(t, _)| *t != term);
        self.setting.fit(&from, &self.starts(model))
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

    /// The model without one of its terms, which is asked for again where nothing has changed.
    fn without(&self, found: &mut Found, term: usize) -> Fitted {
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

    /// Whether a term can be told from the fixed effects of a model by its tangent.
    fn shows(&self, model: &Fitted, term: usize) -> bool {
        let directions = self.setting.problem.directions_of(&model.point, term);
        !Screen::of(self.setting, model, directions)
            .shown(0)
            .is_empty()
    }

    /// Deletions and swaps, and the alternatives to every term.
    fn tidy(&self, found: &mut Found, way: Way) {
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
            let is_named = |t: usize| self.setting.problem.terms()[t].named;
            let mut others = if self.decision.thorough {
                self.others(&found.model, &without, term, gain)
            } else {
                Vec::new()
            };
            // What no tangent shows has alternatives that none shows either.
            if self.decision.thorough && !(is_named(term) && self.shows(&without, term)) {
                let own = self.worth(&found.model, term, way) - self.decision.alike;
                let way_of_names = Way {
                    named_only: true,
                    ..way
                };
                let far = self.fits_far(&without, way_of_names, own);
                let far = far
                    .into_iter()
                    .filter(|(f, t)| *t != term && self.worth(f, *t, way) > own);
                others.extend(far.map(|(f, t)| (t, f)));
            }
            let own = self.worth(&found.model, term, way);
            // A name gives way to none only where they are not alike.
            let least = |other: usize| match (is_named(term), is_named(other)) {
                (true, false) => self.decision.alike,
                (false, true) => -self.decision.alike,
                _ => WORTH_A_SWAP,
            };
            let better = others
                .iter()
                .map(|(t, f)| (self.worth(f, *t, way), t, f))
                .filter(|(worth, t, _)| *worth > own + least(**t))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            if let (Some((_, other, fit)), true) = (better, swaps > 0) {
                swaps -= 1;
                found.accepted[place].term = *other;
                found.model = self.estimated(fit);
                place = 0;
                continue;
            }
            let kind = self.setting.problem.terms()[term].kind;
            found.accepted[place].in_its_place = others
                .into_iter()
                .filter(|(t, f)| {
                    self.setting.problem.terms()[*t].kind != kind
                        && f.log_likelihood > found.model.log_likelihood - self.decision.alike
                })
                .map(|(term, f)| Instead {
                    term,
                    log_likelihood: f.log_likelihood - found.model.log_likelihood,
                    point: f.point,
                })
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
            let alike = model.log_likelihood - self.decision.alike;
            let fit = self.exchanged(model, term, (direction.term, start), alike);
            let is_alike = fit.log_likelihood > alike;
            if is_alike && self.is_inside(&fit, direction.term) {
                fits.push((direction.term, fit));
            }
        }
        fits
    }
}

/// The start of a term: each amplitude times its estimate, the shape as it is.
fn scaled(start: &[f64], estimate: &[f64]) -> Vec<f64> {
    let values = start.iter().enumerate();
    values
        .map(|(k, x)| estimate.get(k).map_or(*x, |e| e * x))
        .collect()
}
