//! Which additions explain the residual: forward by a beam, backward by removal, each step refitted in full.
//!
//! At every step the linearised model ([`super::linear`]) ranks all candidates, the best few are fitted together with everything else,
//! and the criterion of the fitted models decides: minus twice the log-likelihood of the mixed model (Laplace's approximation), with the
//! *effective* number of readings, plus the Bayesian price of every parameter (Schwarz 1978) and of every place that a part of the
//! campaign was chosen from (extended criterion: Chen and Chen, Biometrika 95 (2008) 759).

use super::base::Base;
use super::between;
use super::candidates::choices;
use super::data::Data;
use super::linear::{BLIND, Linear, Stand};
use super::model::{Fitted, MOST_TERMS, Model, USUAL_SCATTER};
use super::term::{Empirical, Scope, Term, What};
use crate::numerics::statistics::{mean, median, quantile};

/// States that go on to the next size.
const BEAM: usize = 2;
/// Candidates that are fitted in full from each state.
const TRIED: usize = 5;
/// Least relative fall of the sum of squares for which an addition is looked at: less has no consequence for any use of the model.
pub const LEAST_FALL: f64 = 0.02;
/// The same relative to the base model: what is left after a strong effect of another shape than the library's is no second effect.
const LEAST_OF_ALL: f64 = 0.01;
/// Least root mean square of what an addition takes off, by the force that all but 5% of the readings stay below. The zero that a
/// log declares, the converter's steps and the means over plateaus are not better than this (0.18 N from session to session in simulated
/// logs without any effect, which a thousand samples make significant).
pub const LEAST_OF_RANGE: f64 = 0.001;
/// Or it explains this part of what can be explained: what is left beside noise that repeats show. A second effect may be small beside the
/// first; the misfit of a shape is not explained to that part by anything else.
const NEARLY_ALL: f64 = 0.8;
/// The same for a value of every session: what these explain is in part the misfit of a shape.
const LEAST_OF_ALL_EACH: f64 = 0.1;
/// One session (specimen) is looked at by itself if its value stands out so many times above the median of the others'.
const STANDS_OUT: f64 = 6.0;
/// A physical effect is preferred to an empirical dependence if it explains this part of what that does: of the shape of a sensor or of
/// an offset (a constant and a slope), of a gain with an extra column.
pub const PREFERENCE: (f64, f64) = (0.85, 0.97);
/// An offset with a column has a constant in it. Where that alone, the zero of the channel, explains half of it, the zero comes first,
/// and the column may follow.
const HALF: f64 = 0.5;
/// An effect for which something beside the force speaks (zero logs that stand out) is preferred if it explains this part of what
/// another does.
pub const EVIDENCE: f64 = 0.8;

/// A model in the beam.
#[derive(Clone)]
pub struct State {
    /// Places in the list of candidates, in the order in which they came in.
    pub chosen: Vec<usize>,
    /// The fit.
    pub fitted: Fitted,
    /// The criterion: smaller is better.
    pub criterion: f64,
    /// Effective number of readings.
    pub effective: f64,
}

/// A search on some readings.
pub struct Search<'a> {
    /// Base model.
    pub base: &'a Base,
    /// Readings.
    pub data: &'a Data,
    /// What may be added.
    pub candidates: &'a [Term],
    /// Most additions.
    pub most: usize,
    /// Largest corrected p of an addition.
    pub significance: f64,
    /// Sum of squares that repeated readings show, N^2: no model explains it. 0 where nothing was repeated.
    pub pure: f64,
    /// Least root mean square that an addition must take off, N: see [`LEAST_OF_RANGE`].
    pub least_n: f64,
}

impl<'a> Search<'a> {
    /// A search on some readings.
    pub fn new(
        base: &'a Base,
        data: &'a Data,
        candidates: &'a [Term],
        most: usize,
        significance: f64,
    ) -> Self {
        let range = if data.is_empty() {
            0.0
        } else {
            quantile(&data.force, 0.95)
        };
        let mut search = Self {
            base,
            data,
            candidates,
            most,
            significance,
            pure: 0.0,
            least_n: LEAST_OF_RANGE * range.max(0.0),
        };
        let null = search.model(&[]).fit(None, 0);
        let noise = super::noise::noise_floor(data, &null.residuals).unwrap_or(0.0);
        search.pure = noise * noise * data.len() as f64;
        search
    }

    /// The model with these candidates.
    pub fn model(&self, chosen: &[usize]) -> Model<'a> {
        Model {
            base: self.base,
            data: self.data,
            terms: chosen.iter().map(|c| self.candidates[*c].clone()).collect(),
        }
    }

    /// A fitted model as a state.
    pub fn state(&self, chosen: Vec<usize>, from: Option<&Fitted>) -> State {
        let model = self.model(&chosen);
        let fitted = model.fit(from, 1);
        let effective = effective_readings(self.data, &fitted.residuals);
        let criterion = self.criterion(&model, &fitted, effective);
        State {
            chosen,
            fitted,
            criterion,
            effective,
        }
    }

    fn criterion(&self, model: &Model, fitted: &Fitted, effective: f64) -> f64 {
        let n = self.data.len() as f64;
        let rss: f64 = fitted.residuals.iter().map(|r| r * r).sum();
        let parameters: usize = model.terms.iter().map(Term::parameters).sum();
        let places: f64 = model
            .terms
            .iter()
            .map(|t| libm::log(choices(&t.scope, self.data)))
            .sum();
        effective * libm::log(rss / n)
            + strengths(model, fitted)
            + parameters as f64 * libm::log(effective)
            + 2.0 * places
    }

    /// The best models from the base upwards: the best of all, then those of smaller sizes that were in the beam, the largest first.
    pub fn run(&self) -> Vec<State> {
        let null = self.state(Vec::new(), None);
        // What has a value for every session explains much and predicts nothing: see `with_each_session`.
        let shared: Vec<usize> = (0..self.candidates.len())
            .filter(|c| self.candidates[*c].scope != Scope::EachSession)
            .collect();
        // What the strengths ask for comes first: left out, its traces within the specimens would be credited to others.
        let asked = between::asked_for(self, &null.fitted).filter(|(_, p)| *p < self.significance);
        let from = asked.map_or_else(
            || null.clone(),
            |(c, _)| self.state(vec![c], Some(&null.fitted)),
        );
        let grown = self.grow(&null, from, &shared, BEAM);
        let Some((largest, smaller)) = grown.split_last() else {
            return vec![null];
        };
        let best = self.prune(largest.clone(), rss(&null));
        let best = self.with_better_forms(&null, best);
        let size = best.chosen.len();
        let smaller = smaller.iter().rev().filter(|s| s.chosen.len() < size);
        std::iter::once(best.clone())
            .chain(smaller.cloned())
            .collect()
    }

    /// The best model with an effect that has a value for every session, on top of another; in place of its effects of single sessions, if
    /// there are several, which may be all of them, and of dependences on columns with one value a session. None where it does not pay.
    pub fn with_each_session(&self, best: &State) -> Option<State> {
        let single: Vec<usize> = (0..self.candidates.len())
            .filter(|c| self.candidates[*c].scope == Scope::EachSession)
            .collect();
        let null = self.state(Vec::new(), None);
        let part = |c: &usize| {
            matches!(
                self.candidates[*c].scope,
                Scope::Session(_) | Scope::From(_)
            )
        };
        let several = best.chosen.iter().filter(|c| part(c)).count() > 1;
        let by_column = |c: &usize| match self.candidates[*c].what {
            What::Empirical(Empirical::Gain(k) | Empirical::Offset(k)) => {
                self.data.extras[k].constant_in_sessions
            }
            _ => false,
        };
        let kept: Vec<usize> = best
            .chosen
            .iter()
            .copied()
            .filter(|c| !(several && part(c) || by_column(c)))
            .collect();
        let from = if kept.len() < best.chosen.len() {
            self.state(kept, None)
        } else {
            best.clone()
        };
        let grown = self.grow(&null, from.clone(), &single, 1).pop()?;
        let pays = self.criterion_gain(&null, &grown) > self.criterion_gain(&null, best);
        (grown.chosen.len() > from.chosen.len() && pays).then_some(grown)
    }

    /// The best models from one with a value for every session upwards, the largest first, that one last.
    pub fn further(&self, from: &State) -> Vec<State> {
        let null = self.state(Vec::new(), None);
        let whole: Vec<usize> = (0..self.candidates.len())
            .filter(|c| self.candidates[*c].scope == Scope::Whole)
            .collect();
        let mut grown = self.grow(&null, from.clone(), &whole, BEAM);
        grown.reverse();
        grown
    }

    /// The best models from a state upwards, with additions from a list: by size, in each size the best one last.
    fn grow(&self, null: &State, from: State, list: &[usize], width: usize) -> Vec<State> {
        let all = rss(null);
        let mut best = from.clone();
        let mut path = vec![from.clone()];
        let mut beam = vec![from];
        for size in best.chosen.len()..self.most.min(MOST_TERMS) {
            let mut next: Vec<State> = beam
                .iter()
                .flat_map(|state| self.expand(state, list))
                .collect();
            let evidence = |s: &State| self.criterion_gain(null, s);
            next.sort_by(|a, b| evidence(b).total_cmp(&evidence(a)));
            next.dedup_by(|a, b| sorted(&a.chosen) == sorted(&b.chosen));
            self.prefer_physics(&mut next, &beam[0]);
            next.truncate(width);
            let Some(first) = next.first() else {
                break;
            };
            if self.worth(&best, first, all) {
                let others = next.iter().skip(1).rev();
                path.extend(others.filter(|s| self.worth(&best, s, all)).cloned());
                best = first.clone();
                path.push(best.clone());
            } else if best.chosen.len() < size {
                break;
            }
            beam = next;
        }
        path
    }

    /// The same effects in whichever of their forms explains most: a form that came in early may not be the best beside the others.
    fn with_better_forms(&self, null: &State, mut best: State) -> State {
        for k in 0..best.chosen.len() {
            let now = &self.candidates[best.chosen[k]];
            let others: Vec<usize> = (0..self.candidates.len())
                .filter(|c| {
                    now.id().is_some()
                        && self.candidates[*c].id() == now.id()
                        && self.candidates[*c].scope == now.scope
                })
                .filter(|c| *c != best.chosen[k])
                .collect();
            for c in others {
                let mut chosen = best.chosen.clone();
                chosen[k] = c;
                let state = self.state(chosen, None);
                if self.criterion_gain(null, &state) > self.criterion_gain(null, &best) {
                    best = state;
                }
            }
        }
        best
    }

    /// By how much a larger model betters the criterion, at its own effective number of readings.
    pub fn criterion_gain(&self, small: &State, large: &State) -> f64 {
        self.criterion(&self.model(&small.chosen), &small.fitted, large.effective) - large.criterion
    }

    /// Whether a larger model is worth its price: by the criterion at its own effective number of readings, and by a fall that matters.
    fn worth(&self, small: &State, large: &State, all: f64) -> bool {
        let model = self.model(&small.chosen);
        let fall = relative_fall(small, large);
        let of_all = (rss(small) - rss(large)) / all.max(f64::MIN_POSITIVE);
        let each = large
            .chosen
            .iter()
            .filter(|c| !small.chosen.contains(c))
            .any(|c| self.candidates[*c].scope == Scope::EachSession);
        let least = if each {
            LEAST_OF_ALL_EACH
        } else {
            LEAST_OF_ALL
        };
        let taken_off = ((rss(small) - rss(large)).max(0.0) / self.data.len() as f64).sqrt();
        let between =
            strengths(&model, &small.fitted) - strengths(&self.model(&large.chosen), &large.fitted);
        let explained = (rss(small) - rss(large)) / (rss(small) - self.pure).max(f64::MIN_POSITIVE);
        let matters = of_all > least || (explained > NEARLY_ALL && !each);
        self.criterion_gain(small, large) > 0.0
            && ((fall > LEAST_FALL && matters && taken_off > self.least_n) || between > 6.0)
    }

    /// The best model gives way to one of the same size that explains nearly as much and has more behind it: physics and not an
    /// empirical dependence, zero logs that stand out and not the force alone.
    fn prefer_physics(&self, next: &mut Vec<State>, parent: &State) {
        let fall = |s: &State| rss(parent) - rss(s);
        let Some(most) = next.first().map(fall) else {
            return;
        };
        // At most twice: from an empirical dependence to physics, from there to what has evidence.
        for _ in 0..2 {
            let first = &next[0];
            let better = next
                .iter()
                .position(|s| fall(s) >= self.needed(first, s) * most);
            if let Some(place) = better {
                let state = next.remove(place);
                next.insert(0, state);
            }
        }
    }

    /// Which share of what one model explains another must explain to be preferred; infinite where it has nothing to be preferred for.
    fn needed(&self, first: &State, other: &State) -> f64 {
        let empirical = |s: &State| {
            let share = |c: &usize| match self.candidates[*c].what {
                What::Empirical(Empirical::Gain(_)) => Some(PREFERENCE.1),
                What::Empirical(_) => Some(PREFERENCE.0),
                What::Effect { .. } => None,
            };
            s.chosen.iter().filter_map(share).reduce(f64::max)
        };
        let evidence = |s: &State| s.chosen.iter().any(|c| self.candidates[*c].has_evidence());
        let has = |s: &State, is: &dyn Fn(&Term) -> bool| {
            s.chosen.iter().any(|c| is(&self.candidates[*c]))
        };
        let offset = |t: &Term| matches!(t.what, What::Empirical(Empirical::Offset(_)));
        let zero = |t: &Term| {
            t.id() == Some("force_zero_offset") && t.scope == Scope::Whole && !t.has_evidence()
        };
        match (empirical(first), empirical(other)) {
            (Some(_), None) if has(first, &offset) && has(other, &zero) => HALF,
            (Some(share), None) => share,
            (None, None) if evidence(other) && !evidence(first) => EVIDENCE,
            _ => f64::INFINITY,
        }
    }

    /// The best additions to a state, each fitted.
    fn expand(&self, state: &State, list: &[usize]) -> Vec<State> {
        let model = self.model(&state.chosen);
        let ranked = self.rank(&model, state, list);
        ranked
            .into_iter()
            .map(|c| {
                let mut chosen = state.chosen.clone();
                chosen.push(c);
                self.state(chosen, Some(&state.fitted))
            })
            .collect()
    }

    /// The candidates that would explain most, by the linearised model, with strengths that scatter as fitted and as is usual.
    fn rank(&self, model: &Model, state: &State, list: &[usize]) -> Vec<usize> {
        let n = self.data.len() as f64;
        let mut picked: Vec<usize> = Vec::new();
        for scatter in [state.fitted.scatter, USUAL_SCATTER] {
            let linear = Linear::new(model, &state.fitted, scatter, self.candidates);
            let stand = linear.stand(&linear.all_sessions(), &[]);
            let mut gains: Vec<(f64, usize)> = list
                .iter()
                .copied()
                .filter(|c| !state.chosen.contains(c) && !between::is_between(&self.candidates[*c]))
                .filter(|c| !self.is_another_form(*c, &state.chosen))
                .filter_map(|c| {
                    let gain = stand.gain(c);
                    let term = &self.candidates[c];
                    let fall = 1.0 - gain.fall / stand.left.max(f64::MIN_POSITIVE);
                    let price = term.parameters() as f64 * libm::log(n)
                        + 2.0 * libm::log(choices(&term.scope, self.data));
                    // The residual's own structure makes the effective number small as long as nothing explains it, so the ranking
                    // counts all readings; whether the addition pays is asked after the fit.
                    let better = -(n * libm::log(fall.max(1e-12))) - price;
                    let inside = self.sign_is_possible(c, gain.amplitude);
                    (gain.visible >= BLIND && better > 0.0 && inside).then_some((better, c))
                })
                .filter(|(_, c)| self.stands_out(&stand, *c, list))
                .collect();
            gains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            self.pick_different(&gains, &mut picked);
        }
        picked
    }

    /// Whether it is another form of an effect that is in the model already: forms are alternatives. Only what has evidence of its own beside
    /// the force (a pull in the zero logs) is something else than the effect of the same name (a zero of the channel).
    fn is_another_form(&self, candidate: usize, chosen: &[usize]) -> bool {
        let term = &self.candidates[candidate];
        chosen.iter().map(|c| &self.candidates[*c]).any(|other| {
            other.id().is_some()
                && other.id() == term.id()
                && other.scope == Scope::Whole
                && term.scope == Scope::Whole
                && other.has_evidence() == term.has_evidence()
        })
    }

    /// Whether a session or specimen that would get a value of its own differs from all others, and not only from the mean.
    fn stands_out(&self, stand: &Stand, candidate: usize, list: &[usize]) -> bool {
        let term = &self.candidates[candidate];
        let alike = |other: &Scope| match (&term.scope, other) {
            (Scope::Session(a), Scope::Session(b)) | (Scope::Specimen(a), Scope::Specimen(b)) => {
                a != b
            }
            _ => false,
        };
        if !matches!(term.scope, Scope::Session(_) | Scope::Specimen(_)) {
            return true;
        }
        let size = |c: usize| stand.gain(c).amplitude.abs();
        let others: Vec<f64> = list
            .iter()
            .copied()
            .filter(|c| self.candidates[*c].what_is(term) && alike(&self.candidates[*c].scope))
            .map(size)
            .collect();
        size(candidate) > STANDS_OUT * median(&others)
    }

    /// The best ones, but not all of one kind: at most two of one effect, and the best empirical one always.
    fn pick_different(&self, gains: &[(f64, usize)], picked: &mut Vec<usize>) {
        let start = picked.len();
        for (_, c) in gains {
            let kind = |c: usize| self.candidates[c].id();
            let alike = picked[start..]
                .iter()
                .filter(|p| kind(**p) == kind(*c))
                .count();
            if picked.len() - start < TRIED && alike < 2 && !picked.contains(c) {
                picked.push(*c);
            }
        }
        let empirical = gains
            .iter()
            .find(|(_, c)| self.candidates[*c].id().is_none());
        if let Some((_, c)) = empirical
            && !picked.contains(c)
        {
            picked.push(*c);
        }
    }

    /// Whether a one-sided effect would have the sign that it can have.
    fn sign_is_possible(&self, candidate: usize, amplitude: f64) -> bool {
        let term = &self.candidates[candidate];
        let (low, high) = term.amplitude_bounds();
        let near = term.start().0;
        near + amplitude > low - 1e-12
            && (high > 0.0 || amplitude < 0.0)
            && (amplitude > 0.0 || low < 0.0 || near > 0.0)
    }

    /// Drops what a later addition made superfluous.
    fn prune(&self, mut best: State, all: f64) -> State {
        loop {
            let within = (0..best.chosen.len())
                .filter(|k| !between::is_between(&self.candidates[best.chosen[*k]]));
            let smaller = within.map(|k| {
                let mut chosen = best.chosen.clone();
                chosen.remove(k);
                self.state(chosen, None)
            });
            let superfluous = smaller
                .filter(|s| !self.worth(s, &best, all))
                .min_by(|a, b| rss(a).total_cmp(&rss(b)));
            match superfluous {
                Some(state) => best = state,
                None => return best,
            }
        }
    }
}

/// The candidates of a model, whatever the order in which they came in.
pub fn sorted(chosen: &[usize]) -> Vec<usize> {
    let mut sorted = chosen.to_vec();
    sorted.sort_unstable();
    sorted
}

/// Sum of squared residuals, N^2.
pub fn rss(state: &State) -> f64 {
    state.fitted.residuals.iter().map(|r| r * r).sum()
}

/// By how much the sum of squares falls, relative.
pub fn relative_fall(small: &State, large: &State) -> f64 {
    1.0 - rss(large) / rss(small).max(f64::MIN_POSITIVE)
}

/// What the strengths add to minus twice the log-likelihood.
fn strengths(model: &Model, fitted: &Fitted) -> f64 {
    let variance = fitted.scatter * fitted.scatter;
    let information = model.strength_information(&fitted.traces);
    let seen = information
        .iter()
        .zip(&fitted.strengths)
        .filter(|(i, _)| **i > 0.0);
    seen.map(|(i, u)| libm::log1p(i / (fitted.sigma * fitted.sigma) * variance) + u * u / variance)
        .sum()
}

/// Readings that are independent: n (1 - r)/(1 + r), with r the correlation of neighbours in a log (Bayley and Hammersley 1946), and not
/// more than n.
pub fn effective_readings(data: &Data, residuals: &[f64]) -> f64 {
    let centre = mean(residuals);
    let (mut products, mut squares, mut pairs) = (0.0, 0.0, 0.0);
    for i in 1..residuals.len() {
        if data.log[i] == data.log[i - 1] {
            products += (residuals[i] - centre) * (residuals[i - 1] - centre);
            pairs += 1.0;
        }
    }
    for r in residuals {
        squares += (r - centre) * (r - centre);
    }
    let n = residuals.len() as f64;
    let correlation = if pairs > 0.0 && squares > 0.0 {
        (products / pairs) / (squares / n)
    } else {
        0.0
    };
    let r = correlation.clamp(0.0, 0.98);
    (n * (1.0 - r) / (1.0 + r)).max(2.0)
}

/// Whether a scope has one value for the whole campaign.
pub fn is_whole(term: &Term) -> bool {
    term.scope == Scope::Whole
}
