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

use crate::gram::{Design, Gram, Square};
use crate::problem::{Component, Linearised, Point, Problem};
use crate::system::{Estimates, Factor, Likelihood, Panel, Variances, dot};
use crate::variance::{Effort, Maximiser, Maximum, Prior, Scale};
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::Matrix;
use std::collections::BTreeSet;
use std::sync::Arc;

/// How far a fit is taken.
#[derive(Clone, Copy)]
struct Goal {
    /// Most outer iterations.
    iterations: usize,
    /// Estimates are at rest where a whole step would gain less log-likelihood than this at the variances as they are (half the squared Newton
    /// decrement).
    rest: f64,
    /// The likelihood is settled where it changes by less than this from one iteration to the next.
    settled: f64,
    /// Log-likelihood below which the fit is of no use.
    least: f64,
}

impl Goal {
    /// Estimates, and what is reported of them: within a twentieth of their standard errors.
    const ESTIMATED: Self = Self {
        iterations: 24,
        rest: 1e-3,
        settled: 0.02,
        least: f64::NEG_INFINITY,
    };

    /// A log-likelihood that is compared with others.
    const fn compared(least: f64) -> Self {
        Self {
            rest: 0.02,
            settled: 0.05,
            least,
            ..Self::ESTIMATED
        }
    }

    /// What a fit comes to at once.
    const GLANCED: Self = Self {
        iterations: 2,
        ..Self::ESTIMATED
    };

    /// Whether a fit that has come so far will not reach what is of use: even ten times what it gains now would not take it there.
    fn is_out_of_reach(self, iteration: usize, log_likelihood: f64, gains: f64) -> bool {
        iteration >= FIRST_STEPS && log_likelihood + 10.0 * gains < self.least
    }
}

/// Iterations in which a fit may do anything.
const FIRST_STEPS: usize = 4;
/// Iterations in which estimates stay and the log-likelihood does not, after which it is taken to alternate.
const ALTERNATES: usize = 3;
/// After so many iterations steps are halved: readings that go slack and taut again in turn make the iteration alternate.
const DAMPED_AFTER: usize = 8;
/// Shortest part of a step that is tried.
pub(crate) const SHORTEST: f64 = 1.0 / 256.0;

/// A problem, and the part of it that is fitted.
#[derive(Clone)]
pub struct Setting<'a> {
    /// The problem.
    pub problem: &'a dyn Problem,
    /// For each node whether its readings take part.
    pub active: Vec<bool>,
    /// Factor on the prior scales of the misfit.
    pub misfit_factor: f64,
    /// Factor on the usual sizes of components where searches start (the tests of convergence move it).
    pub start_factor: f64,
    /// Whether every component is held at its usual size.
    pub at_usual: bool,
    /// What is not fitted.
    pub pinned: Vec<Free>,
}

/// A free variable of the fixed part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// A coefficient.
    Coefficient(usize),
    /// A value of a term in the model: place among [`Point::terms`], number of the value.
    Value(usize, usize),
}

/// A fitted model; everything else is a query of it.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Coefficients, terms and random effects.
    pub point: Point,
    /// Standard deviations (full likelihood).
    pub variances: Variances,
    /// Marginal log-likelihood with the priors of the misfit.
    pub log_likelihood: f64,
    /// The linear model of the last iteration: response less predictions, with the random effects added back.
    pub design: Design,
    /// Its sums over the active nodes.
    pub gram: Gram,
    /// The fixed effects of the design.
    pub free: Vec<Free>,
    /// Inverse curvature of the likelihood in the logarithms of the standard deviations.
    pub inverse: Vec<f64>,
    /// Predictions at the point, linear components left out.
    pub predicted: Vec<f64>,
    /// Whether the iteration ended by itself.
    pub converged: bool,
    /// Whether a coefficient ended at a bound.
    pub at_bound: Vec<bool>,
}

/// What new readings show of themselves, by class of noise.
pub struct Shown {
    /// Mean beside the prediction.
    pub means: Vec<f64>,
    /// Standard deviation about it, with that of an estimated mean.
    pub noise: Vec<f64>,
}

impl<'a> Setting<'a> {
    /// All readings of a problem.
    pub fn new(problem: &'a dyn Problem) -> Self {
        Self {
            problem,
            active: vec![true; problem.tree().len()],
            misfit_factor: 1.0,
            start_factor: 1.0,
            at_usual: false,
            pinned: Vec::new(),
        }
    }

    /// Without the readings of a node and of those below it.
    pub fn without(&self, node: usize) -> Self {
        let tree = self.problem.tree();
        let mut rest = self.clone();
        for n in 0..tree.len() {
            if tree.path(n).contains(&node) {
                rest.active[n] = false;
            }
        }
        rest
    }

    /// Scales of the components, with the prior of the misfit as set here.
    pub fn scales(&self) -> Vec<Scale> {
        let of = |c: &Component| {
            let mut scale = c.scale;
            if let (true, Prior::HalfNormal(s)) = (c.misfit, scale.prior) {
                scale.prior = if self.misfit_factor > 0.0 {
                    Prior::HalfNormal(s * self.misfit_factor)
                } else {
                    Prior::Fixed(0.0)
                };
            }
            if let (true, Prior::Free | Prior::HalfNormal(_) | Prior::Away(_)) =
                (self.at_usual, scale.prior)
            {
                scale.prior = Prior::Fixed(scale.usual);
            }
            scale
        };
        self.problem.components().iter().map(of).collect()
    }

    /// Variances where a search that knows nothing starts: usual sizes, and a fifth of them.
    pub fn fresh(&self) -> Vec<Variances> {
        let scales = self.scales();
        let maximiser = self.maximiser(&scales, Likelihood::Full);
        [1.0, 0.2]
            .map(|f| maximiser.start(f * self.start_factor))
            .to_vec()
    }

    /// The maximiser over the variances.
    pub fn maximiser<'s>(&'s self, scales: &'s [Scale], likelihood: Likelihood) -> Maximiser<'s> {
        Maximiser {
            tree: self.problem.tree(),
            components: scales,
            noise: self.problem.noise(),
            likelihood,
        }
    }

    /// The same with every component at its usual size: only the noise is estimated.
    pub fn usual(&self) -> Self {
        Self {
            at_usual: true,
            ..self.clone()
        }
    }

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
        let first = usual.compare(from, &usual.fresh()[..1], f64::NEG_INFINITY);
        self.fit_within(&first.point, &[self.widened(&first.variances)], goal)
    }

    /// Variances from which a fit with this setting starts: none so small that it cannot grow again.
    pub fn widened(&self, from: &Variances) -> Variances {
        let mut wide = from.clone();
        for (value, scale) in wide.components.iter_mut().zip(self.scales()) {
            *value = match scale.prior {
                Prior::Fixed(sd) | Prior::Held(sd) => sd,
                _ => value.max(0.5 * scale.usual),
            };
        }
        wide
    }

    /// Fits from a point and from several starts of the variances.
    pub fn fit(&self, from: &Point, starts: &[Variances]) -> Fitted {
        self.fit_within(from, starts, Goal::ESTIMATED)
    }

    /// The same, no further than a log-likelihood needs that is compared with others, and given up where it will not come to `least`.
    pub fn compare(&self, from: &Point, starts: &[Variances], least: f64) -> Fitted {
        self.fit_within(from, starts, Goal::compared(least))
    }

    /// What a fit comes to at once: the linear model at the point to which the first step leads. To choose among starts.
    pub fn glance(&self, from: &Point, starts: &[Variances]) -> Fitted {
        self.fit_within(from, starts, Goal::GLANCED)
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
            let mut linear = self.problem.linearise(&point);
            let free = self.free(&point, &held);
            let design = self.design(&point, &mut linear, &free);
            let gram = self.sums(&design);
            let maximum = match &known {
                None => maximiser.best(&gram, starts, Effort::FIRST),
                Some(k) => {
                    maximiser.maximise_with(&gram, &k.variances, Effort::STEP, Some(&k.inverse))
                }
            };
            let factor = Factor::new(&design.tree, &gram, &maximum.variances);
            let estimates = factor.estimates();
            let covariance = factor.fixed_covariance();
            let to_gain = short_of(&covariance, &estimates.fixed);
            let gained = maximum.log_likelihood - before;
            let settled = gained.abs() < goal.settled;
            before = maximum.log_likelihood;
            iteration += 1;
            // Readings in the corner to slackness may leave and enter it in turn while nothing else moves: it ends at the better of the two.
            let alternates = stayed >= ALTERNATES && gained >= 0.0;
            stayed = if to_gain < goal.rest { stayed + 1 } else { 0 };
            let converged = stayed > 0 && (settled || alternates);
            let ends = iteration >= goal.iterations
                || goal.is_out_of_reach(iteration, before, gained.max(to_gain));
            let pressed = self.pressed(&point, &free, &estimates);
            if converged && !ends && !pressed.is_empty() {
                // What stands at its bound and would go on is no estimate, however little it would gain.
                held.extend(pressed);
                known = Some(maximum);
                continue;
            }
            if converged || ends {
                let at_bound = self.at_bound(&point);
                let mut last = point.clone();
                last.random = estimates.random;
                return Fitted {
                    point: last,
                    log_likelihood: maximum.log_likelihood - to_gain,
                    variances: maximum.variances,
                    design,
                    gram,
                    free,
                    inverse: maximum.inverse,
                    predicted: linear.predicted,
                    converged,
                    at_bound,
                };
            }
            let longest = if iteration > DAMPED_AFTER { 0.5 } else { 1.0 };
            let moved = self.step(
                (&point, &linear.predicted),
                (&design, &gram),
                &free,
                &estimates,
                &maximum.variances,
                longest,
            );
            held.extend(moved.stopped);
            point = moved.point;
            known = Some(maximum);
        }
    }

    /// The best of fits from several points.
    pub fn best(&self, from: &[Point], starts: &[Variances]) -> Option<Fitted> {
        let fits = from.iter().map(|p| self.fit(p, starts));
        fits.filter(|f| f.log_likelihood.is_finite())
            .max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
    }

    fn inside(&self, point: &Point) -> Point {
        let mut point = point.clone();
        for (x, c) in point
            .coefficients
            .iter_mut()
            .zip(self.problem.coefficients())
        {
            *x = x.clamp(c.bounds.0, c.bounds.1);
        }
        for (term, values) in &mut point.terms {
            for (x, (low, high)) in values.iter_mut().zip(&self.problem.terms()[*term].bounds) {
                *x = x.clamp(*low, *high);
            }
        }
        point
    }

    fn free(&self, point: &Point, held: &[Free]) -> Vec<Free> {
        let coefficients = self.problem.coefficients().iter().enumerate();
        let mut free: Vec<Free> = coefficients
            .filter(|(_, c)| c.free)
            .map(|(k, _)| Free::Coefficient(k))
            .collect();
        for (t, (_, values)) in point.terms.iter().enumerate() {
            free.extend((0..values.len()).map(|k| Free::Value(t, k)));
        }
        free.retain(|f| !held.contains(f) && !self.pinned.contains(f));
        free
    }

    /// The linear mixed model at a point; takes the columns of the random effects.
    fn design(&self, point: &Point, linear: &mut Linearised, free: &[Free]) -> Design {
        let problem = self.problem;
        let tree = problem.tree();
        let nonlinear = self.nonlinear_columns();
        let paths: Vec<Vec<usize>> = (0..tree.len()).map(|n| tree.path_numbers(n)).collect();
        let y = (0..linear.predicted.len())
            .map(|i| {
                let path = &paths[problem.node()[i]];
                let own: f64 = path
                    .iter()
                    .zip(&linear.random[i])
                    .filter(|(c, _)| nonlinear[**c])
                    .map(|(c, z)| z * point.random[*c])
                    .sum();
                problem.observed()[i] - linear.predicted[i] + own
            })
            .collect();
        Design {
            tree: tree.clone(),
            node: problem.node().to_vec(),
            class: problem.class().to_vec(),
            classes: problem.noise().len(),
            z: Arc::new(std::mem::take(&mut linear.random)),
            x: free
                .iter()
                .map(|f| column(point, linear, *f).to_vec())
                .collect(),
            y,
        }
    }

    /// The sums over the active nodes.
    pub fn sums(&self, design: &Design) -> Gram {
        design.gram_of(|n| self.active[n])
    }

    /// For each column of the tree whether the forward model is nonlinear in it.
    pub fn nonlinear_columns(&self) -> Vec<bool> {
        let tree = self.problem.tree();
        let components = self.problem.components();
        (0..tree.len())
            .flat_map(|n| tree.components_of(n))
            .map(|c| !components[c].linear)
            .collect()
    }

    /// Penalised sum of squares at a point with these predictions, the least over the random effects of linear components: wherever the others
    /// go, these follow at once. `linear` is the factor of a system that knows no others.
    pub(crate) fn objective(
        &self,
        point: &Point,
        predicted: &[f64],
        (design, linear): (&Design, &Factor),
        variances: &Variances,
    ) -> f64 {
        let readings = self.problem.observed().iter().zip(predicted);
        let left = readings.map(|(y, p)| y - p).collect();
        let panel = Panel::of_active(design, &[left], |n| self.active[n]);
        let sum = linear.project(&panel).unprojected[0];
        let tree = self.problem.tree();
        let components = (0..tree.len()).flat_map(|n| tree.components_of(n));
        let effects = point.random.iter().zip(components);
        let penalty = effects.map(|(b, c)| {
            let is_open = !self.problem.components()[c].linear && *b != 0.0;
            let u = b / variances.components[c].max(f64::MIN_POSITIVE);
            if is_open { u * u } else { 0.0 }
        });
        sum + penalty.sum::<f64>()
    }

    /// The variances with no components but those in which the forward model is linear.
    pub(crate) fn linear_only(&self, variances: &Variances) -> Variances {
        let mut alone = variances.clone();
        let components = alone.components.iter_mut().zip(self.problem.components());
        for (sd, _) in components.filter(|(_, c)| !c.linear) {
            *sd = 0.0;
        }
        alone
    }

    /// Moves from a point with these predictions to the estimates of the linear model, shortened until the penalised sum of squares does not rise.
    fn step(
        &self,
        (point, predicted): (&Point, &[f64]),
        (design, gram): (&Design, &Gram),
        free: &[Free],
        estimates: &Estimates,
        variances: &Variances,
        longest: f64,
    ) -> Moved {
        let alone = self.linear_only(variances);
        let linear = Factor::new(&design.tree, gram, &alone);
        let value = |p: &Point, predicted: &[f64]| {
            self.objective(p, predicted, (design, &linear), variances)
        };
        let at = |p: &Point| value(p, &self.problem.predict(p));
        let old = value(point, predicted);
        let (next, stopped) = self.moved(point, free, estimates, longest);
        if falls(at(&next), old) {
            return Moved {
                point: next,
                stopped,
            };
        }
        // New variances may punish the old random effects so much that any step would do, or favour the new ones so much that none that keeps
        // part of the old ones does: shorter steps start from the better of both. The estimates are the minimum of a convex function, downhill
        // from either.
        let mut renewed = point.clone();
        renewed.random.clone_from(&estimates.random);
        let new = at(&renewed);
        let (from, here) = if new < old {
            (&renewed, new)
        } else {
            (point, old)
        };
        let mut length = longest;
        loop {
            let (next, stopped) = self.moved(from, free, estimates, length);
            if falls(at(&next), here) || length <= SHORTEST {
                return Moved {
                    point: next,
                    stopped,
                };
            }
            length *= 0.5;
        }
    }

    /// The free values that stand at a bound and would go on.
    fn pressed(&self, point: &Point, free: &[Free], estimates: &Estimates) -> Vec<Free> {
        let steps = free.iter().zip(&estimates.fixed);
        let pressed = steps.filter(|(f, step)| {
            let (value, (low, high)) = self.bounded(point, **f);
            (value <= low && **step < 0.0) || (value >= high && **step > 0.0)
        });
        pressed.map(|(f, _)| *f).collect()
    }

    /// A value with its bounds.
    fn bounded(&self, point: &Point, free: Free) -> (f64, (f64, f64)) {
        match free {
            Free::Coefficient(k) => (point.coefficients[k], self.problem.coefficients()[k].bounds),
            Free::Value(t, k) => {
                let (term, values) = &point.terms[t];
                (values[k], self.problem.terms()[*term].bounds[k])
            }
        }
    }

    fn moved(
        &self,
        point: &Point,
        free: &[Free],
        estimates: &Estimates,
        length: f64,
    ) -> (Point, Vec<Free>) {
        let mut next = point.clone();
        for (b, to) in next.random.iter_mut().zip(&estimates.random) {
            *b += length * (to - *b);
        }
        let mut stopped = Vec::new();
        for (f, d) in free.iter().zip(&estimates.fixed) {
            let (value, (low, high)) = match *f {
                Free::Coefficient(k) => (
                    &mut next.coefficients[k],
                    self.problem.coefficients()[k].bounds,
                ),
                Free::Value(t, k) => {
                    let (term, values) = &mut next.terms[t];
                    (&mut values[k], self.problem.terms()[*term].bounds[k])
                }
            };
            let wanted = *value + length * d;
            let bounded = wanted.clamp(low, high);
            // A bound that is met twice holds.
            if bounded != wanted && bounded == *value {
                stopped.push(*f);
            }
            *value = bounded;
        }
        (next, stopped)
    }

    /// For each coefficient whether it is fitted and stands at a bound.
    fn at_bound(&self, point: &Point) -> Vec<bool> {
        let coefficients = self.problem.coefficients();
        let values = point.coefficients.iter().zip(coefficients);
        values
            .map(|(x, c)| c.free && (*x <= c.bounds.0 || *x >= c.bounds.1))
            .collect()
    }
}

/// Whether a penalised sum of squares does not rise.
fn falls(to: f64, from: f64) -> bool {
    to.is_finite() && to <= from * (1.0 + 1e-9)
}

struct Moved {
    point: Point,
    stopped: Vec<Free>,
}

/// By how much the log-likelihood at a point is below that of its linear model, whose estimates are `step` away: nothing at a fixed point.
fn short_of(covariance: &Square, step: &[f64]) -> f64 {
    let n = step.len();
    if n == 0 {
        return 0.0;
    }
    let mut matrix = Matrix::zeros(n, n);
    for j in 0..n {
        for (i, x) in matrix.column_mut(j).iter_mut().enumerate() {
            *x = covariance.at(i, j);
        }
    }
    0.5 * dot(step, &Cholesky::new(&matrix).solve(step))
}

fn column<'l>(point: &Point, linear: &'l Linearised, free: Free) -> &'l [f64] {
    match free {
        Free::Coefficient(k) => &linear.by_coefficients[k],
        Free::Value(t, k) => {
            let before: usize = point.terms[..t].iter().map(|(_, v)| v.len()).sum();
            &linear.by_terms[before + k]
        }
    }
}

impl Fitted {
    /// The factor at the estimates.
    pub fn factor(&self) -> Factor<'_> {
        Factor::new(&self.design.tree, &self.gram, &self.variances)
    }

    /// The place among the fixed effects of a term's value.
    pub fn place(&self, term: usize, value: usize) -> Option<usize> {
        let t = self.point.terms.iter().position(|(k, _)| *k == term)?;
        self.free.iter().position(|f| *f == Free::Value(t, value))
    }

    /// The values of a term in the model.
    pub fn values(&self, term: usize) -> Option<&[f64]> {
        let found = self.point.terms.iter().find(|(k, _)| *k == term);
        found.map(|(_, values)| values.as_slice())
    }

    /// Where a fit without some groups starts: their random effects are 0.
    pub fn cleared(&self, setting: &Setting) -> Point {
        let tree = setting.problem.tree();
        let mut point = self.point.clone();
        for node in (0..tree.len()).filter(|n| !setting.active[*n]) {
            let first = tree.first_column(node);
            point.random[first..first + tree.width(node)].fill(0.0);
        }
        point
    }

    /// Variances by the restricted likelihood, from those of the full one.
    pub fn restricted(&self, setting: &Setting) -> Variances {
        self.estimated(setting, &setting.scales())
    }

    /// The same for draws and predictions: how groups of their own differ is never estimated as nothing ([`Prior::Away`]).
    pub fn predictive(&self, setting: &Setting) -> Variances {
        let mut scales = setting.scales();
        for (scale, component) in scales.iter_mut().zip(setting.problem.components()) {
            if let (true, Prior::HalfNormal(s)) = (component.calibrates, scale.prior) {
                scale.prior = Prior::Away(s);
            }
        }
        self.estimated(setting, &scales)
    }

    fn estimated(&self, setting: &Setting, scales: &[Scale]) -> Variances {
        // A component that has faded to nothing does not grow by itself.
        let starts = [self.variances.clone(), setting.widened(&self.variances)];
        setting
            .maximiser(scales, Likelihood::Restricted)
            .best(&self.gram, &starts, Effort::FULL)
            .variances
    }

    /// What new readings show beside variances of the model: those of a class that is held ([`Prior::Held`]) what such readings do, all others their noise
    /// and no more.
    pub fn shown(&self, setting: &Setting, variances: &Variances) -> Shown {
        let classes = setting.problem.noise();
        let is_held = |class: usize| matches!(classes[class].prior, Prior::Held(_));
        let mut means = vec![0.0; classes.len()];
        if !(0..classes.len()).any(is_held) {
            let noise = variances.noise.clone();
            return Shown { means, noise };
        }
        let left = self.left(variances);
        let mut of_mean = vec![1.0; classes.len()];
        for (class, mean) in means.iter_mut().enumerate().filter(|(c, _)| is_held(*c)) {
            let of =
                |i: &usize| self.design.class[*i] == class && setting.active[self.design.node[*i]];
            let of: Vec<usize> = (0..self.design.len()).filter(of).collect();
            // Readings of one group are alike: as many means as there are groups were averaged.
            let groups: BTreeSet<usize> = of.iter().map(|i| self.design.node[*i]).collect();
            let count = groups.len() as f64;
            if count > 1.0 {
                *mean = of.iter().map(|i| left[*i]).sum::<f64>() / of.len() as f64;
                of_mean[class] = ((count + 1.0) / (count - 1.0)).sqrt();
            }
        }
        let readings = self.design.y.iter().zip(&self.design.class);
        let about: Vec<f64> = readings.map(|(y, class)| y - means[*class]).collect();
        let gram = self.design.with_response_of(&self.gram, &[], &about);
        let at = |scale: Scale, sd: &f64| Scale {
            prior: match scale.prior {
                Prior::Held(sd) => Prior::Away(sd),
                _ => Prior::Fixed(*sd),
            },
            ..scale
        };
        let components = setting.scales().into_iter().zip(&variances.components);
        let components: Vec<Scale> = components.map(|(scale, sd)| at(scale, sd)).collect();
        let of_classes = classes.iter().zip(&variances.noise);
        let noise: Vec<Scale> = of_classes.map(|(scale, sd)| at(*scale, sd)).collect();
        let maximiser = Maximiser {
            noise: &noise,
            ..setting.maximiser(&components, Likelihood::Restricted)
        };
        let starts = std::slice::from_ref(variances);
        let best = maximiser.best(&gram, starts, Effort::FULL);
        let noise = best.variances.noise.iter().zip(&of_mean);
        Shown {
            means,
            noise: noise.map(|(sd, more)| sd * more).collect(),
        }
    }

    /// What fixed and random effects leave of every reading at some variances; groups that take no part have none of their own.
    fn left(&self, variances: &Variances) -> Vec<f64> {
        let tree = &self.design.tree;
        let estimates = Factor::new(tree, &self.gram, variances).estimates();
        let paths: Vec<Vec<usize>> = (0..tree.len()).map(|n| tree.path_numbers(n)).collect();
        let of = |i: usize| {
            let path = &paths[self.design.node[i]];
            let random = path.iter().zip(&self.design.z[i]);
            let random: f64 = random.map(|(k, z)| z * estimates.random[*k]).sum();
            let fixed = self.design.x.iter().zip(&estimates.fixed);
            let fixed: f64 = fixed.map(|(x, b)| x[i] * b).sum();
            self.design.y[i] - random - fixed
        };
        (0..self.design.len()).map(of).collect()
    }

    /// Covariance of the fixed effects at some variances.
    pub fn covariance(&self, variances: &Variances) -> Square {
        Factor::new(&self.design.tree, &self.gram, variances).fixed_covariance()
    }
}
