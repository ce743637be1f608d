//! The nonlinear mixed model: linearised about the mode of the random effects, again and again.
//!
//! First-order conditional estimation (Lindstrom and Bates, Biometrics 46 (1990) 673; Pinheiro and Bates 2000, chapter 7): at a point, the
//! forward model is linearised; the variances maximise the marginal likelihood of that linear model ([`crate::variance`]); coefficients,
//! amplitudes and random effects move to their estimates, shortened until the penalised sum of squares falls. Sensitivities inside the
//! covariance are frozen within an iteration, else the likelihood would reward small predictions.
//!
//! Components in which the forward model is linear (misfits, rounding of lengths) are profiled out of that sum: they follow at once wherever the
//! others go. Held where they were they would count what they take up a step later, and good steps would be shortened to a fraction.
//!
//! A fit ends where a whole step would gain next to nothing (the Newton decrement, which does not depend on the scale of anything) and the
//! likelihood has settled. Fits that are only compared end earlier, or where they are out of reach of what they are compared with.
//!
//! | file | idea |
//! |---|---|
//! | `setting` | a problem, the part of it that is fitted, and how its components scatter |
//! | `goal` | how far a fit is taken |
//! | `linear` | the linear mixed model at a point |
//! | `step` | the way from a point to the estimates of its linear model |
//! | `fitted` | a fitted model, and what follows from it at once |
//! | `shown` | what new readings show of themselves |

mod fitted;
mod goal;
mod linear;
mod setting;
mod shown;
mod step;

pub use fitted::Fitted;
pub use linear::Free;
pub use setting::Setting;
pub use shown::Shown;
pub(crate) use step::SHORTEST;

use crate::gram::{Design, Gram};
use crate::problem::Point;
use crate::system::{Estimates, Factor, Likelihood, Variances};
use crate::variance::{Effort, Maximiser, Maximum};
use goal::Goal;
use linear::short_of;

/// Iterations in which estimates stay and the log-likelihood does not, after which it is taken to alternate.
const ALTERNATES: usize = 3;

/// After so many iterations steps are halved: readings that go slack and taut again in turn make the iteration alternate.
const DAMPED_AFTER: usize = 8;

impl Setting<'_> {
    /// Fits from a point about which nothing is known: first with every component at its usual size, then with all of them free. Where the
    /// coefficients are still far off, free components take their place, and keep it.
    pub fn fit_afresh(&self, from: &Point) -> Fitted {
        self.afresh(from, Goal::ESTIMATED)
    }

    /// The same for a comparison ([`Self::compare`]).
    pub fn compare_afresh(&self, from: &Point, least: f64) -> Fitted {
        self.afresh(from, Goal::compared(least))
    }

    fn afresh(&self, from: &Point, goal: Goal) -> Fitted {
        let usual = self.usual();
        let first = usual.fit_within(from, &usual.fresh()[..1], Goal::APPROACHED);
        self.fit_within(&first.point, &[self.widened(&first.variances)], goal)
    }

    /// Fits from a point and from several starts of the variances.
    pub fn fit(&self, from: &Point, starts: &[Variances]) -> Fitted {
        self.fit_within(from, starts, Goal::ESTIMATED)
    }

    /// The same, no further than a log-likelihood needs that is compared with others, and given up where it will not come to `least`, or an
    /// amplitude of the last term stays at its bound.
    pub fn compare(&self, from: &Point, starts: &[Variances], least: f64) -> Fitted {
        self.fit_within(from, starts, Goal::compared(least))
    }

    /// What a fit comes to at once: the linear model at the point to which the first step leads. To choose among starts.
    pub fn glance(&self, from: &Point, starts: &[Variances]) -> Fitted {
        self.fit_within(from, starts, Goal::GLANCED)
    }

    /// The best of fits from several points.
    pub fn best(&self, from: &[Point], starts: &[Variances]) -> Option<Fitted> {
        let fits = from.iter().map(|p| self.fit(p, starts));
        fits.filter(|f| f.log_likelihood.is_finite())
            .max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
    }

    fn fit_within(&self, from: &Point, starts: &[Variances], goal: Goal) -> Fitted {
        let scales = self.scales();
        let maximiser = self.maximiser(&scales, Likelihood::Full);
        let mut point = self.inside(from);
        let mut known: Option<Maximum> = None;
        let mut held: Vec<Free> = Vec::new();
        let mut before = f64::NEG_INFINITY;
        let mut stayed = 0;
        let mut iteration = 0;
        loop {
            let here = self.linear_model(&point, &held, &maximiser, known.as_ref(), starts);
            let gained = here.maximum.log_likelihood - before;
            let settled = gained.abs() < goal.settled;
            before = here.maximum.log_likelihood;
            iteration += 1;
            // Readings in the corner to slackness may leave and enter it in turn while nothing else moves: it ends at the better of the two.
            let alternates = stayed >= ALTERNATES && gained >= 0.0;
            stayed = if here.to_gain < goal.rest {
                stayed + 1
            } else {
                0
            };
            let converged = stayed > 0 && (settled || alternates);
            let ends = iteration >= goal.iterations
                || goal.is_out_of_reach(iteration, before, gained.max(here.to_gain));
            let pressed = self.pressed(&point, &here.free, &here.estimates);
            if converged && !ends && !pressed.is_empty() {
                // What stands at its bound and would go on is no estimate, however little it would gain.
                held.extend(pressed);
                if self.is_given_up(goal, &point, &held) {
                    return here.fitted(&point, self.at_bound(&point), false);
                }
                known = Some(here.maximum);
                continue;
            }
            if converged || ends {
                return here.fitted(&point, self.at_bound(&point), converged);
            }
            let longest = if iteration > DAMPED_AFTER { 0.5 } else { 1.0 };
            let moved = self.step(
                (&point, &here.predicted),
                (&here.design, &here.gram),
                &here.free,
                &here.estimates,
                &here.maximum.variances,
                longest,
            );
            held.extend(moved.stopped);
            point = moved.point;
            if self.is_given_up(goal, &point, &held) {
                return here.fitted(&point, self.at_bound(&point), false);
            }
            known = Some(here.maximum);
        }
    }

    /// Whether a fit for a comparison has its last term at a bound.
    fn is_given_up(&self, goal: Goal, point: &Point, held: &[Free]) -> bool {
        let Some((place, (term, _))) = point.terms.iter().enumerate().next_back() else {
            return false;
        };
        let amplitudes = self.problem.terms()[*term].amplitudes;
        let is_of_last = |f: &Free| matches!(*f, Free::Value(t, k) if t == place && k < amplitudes);
        goal.inside && held.iter().any(is_of_last)
    }

    /// The linear model at a point, its variances from where those of the point before it are known, or else from some starts.
    fn linear_model(
        &self,
        point: &Point,
        held: &[Free],
        maximiser: &Maximiser,
        known: Option<&Maximum>,
        starts: &[Variances],
    ) -> LinearModel {
        let mut linear = self.problem.linearise(point);
        let free = self.free(point, held);
        let design = self.design(point, &mut linear, &free);
        let gram = self.sums(&design);
        let maximum = match known {
            None => maximiser.best(&gram, starts, Effort::FIRST),
            Some(k) => maximiser.maximise_with(&gram, &k.variances, Effort::STEP, Some(&k.inverse)),
        };
        let factor = Factor::new(&design.tree, &gram, &maximum.variances);
        let estimates = factor.estimates();
        let covariance = factor.fixed_covariance();
        let to_gain = short_of(&covariance, &estimates.fixed);
        LinearModel {
            predicted: linear.predicted,
            free,
            design,
            gram,
            maximum,
            estimates,
            to_gain,
        }
    }
}

/// The linear model at a point, with its variances and estimates.
struct LinearModel {
    predicted: Vec<f64>,
    free: Vec<Free>,
    design: Design,
    gram: Gram,
    maximum: Maximum,
    estimates: Estimates,
    /// What a whole step would gain.
    to_gain: f64,
}

impl LinearModel {
    /// The model that is fitted where the iteration ends at its point.
    fn fitted(self, point: &Point, at_bound: Vec<bool>, converged: bool) -> Fitted {
        let mut last = point.clone();
        last.random = self.estimates.random;
        Fitted {
            point: last,
            log_likelihood: self.maximum.log_likelihood - self.to_gain,
            variances: self.maximum.variances,
            design: self.design,
            gram: self.gram,
            free: self.free,
            inverse: self.maximum.inverse,
            predicted: self.predicted,
            converged,
            at_bound,
        }
    }
}
