//! The variances: maximum of the marginal (or restricted) likelihood while sensitivities are frozen.
//!
//! Variables are logarithms of standard deviations, so that none can become negative and a component may fade to nothing. The gradient is
//! exact ([`Factor::gradient`]; Fisher's identity), the ascent is BFGS with a backtracking line search. The likelihood may have
//! several maxima: callers that need the global one give several starts.

use crate::gram::Gram;
use crate::system::{Factor, Likelihood, Variances, dot};
use crate::tree::Tree;
use rayon::prelude::*;
use std::cmp::Ordering;

/// What is known beforehand of a standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prior {
    /// Nothing.
    Free,
    /// It is this: declared, or a convention such as rounding to 1 mm.
    Fixed(f64),
    /// This while models are compared and sizes are estimated: no reading of the class may say more, however small its noise. Readings that
    /// take no part are predicted with what those that do show: the mean of what the model leaves of them, and the noise about it,
    /// [`Prior::Away`] from nothing with this scale.
    Held(f64),
    /// Every group's own size is half-normal with this scale, and all are alike: the prior counts once a group.
    HalfNormal(f64),
    /// The same, away from 0: times x/(1 + x^2), x the standard deviation over its usual size (after Chung et al., Psychometrika 78 (2013) 685). A
    /// handful of groups often has its likelihood's maximum at 0, where draws and predictions would know nothing of how groups differ; one
    /// group tells as good as nothing, and then the usual size stands. Where there are many groups it hardly changes the estimate.
    Away(f64),
}

impl Prior {
    /// Whether it is a variable of its own.
    pub(crate) fn is_estimated(self) -> bool {
        !matches!(self, Prior::Fixed(_) | Prior::Held(_))
    }
}

/// A standard deviation to be estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What is known of it.
    pub prior: Prior,
    /// A usual size, where searches start.
    pub usual: f64,
    /// Number of groups that have a value.
    pub groups: usize,
}

/// Standard deviations are kept within these multiples of their usual size.
const RANGE: (f64, f64) = (1e-4, 50.0);
/// Longest step of a logarithm.
const LONGEST_STEP: f64 = 2.0;

/// Evaluations after which starts are compared.
const HEAT: usize = 8;
/// A start whose log-likelihood is then this far below the best is given up.
const GIVEN_UP: f64 = 5.0;

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Evaluations of the likelihood.
    pub evaluations: usize,
    /// A gain below this ends the ascent.
    pub tolerance: f64,
}

impl Effort {
    /// To the maximum, for what is reported.
    pub const FULL: Self = Self {
        evaluations: 60,
        tolerance: 1e-6,
    };
    /// From afar, before an outer iteration that goes on anyway.
    pub const FIRST: Self = Self {
        evaluations: 60,
        tolerance: 1e-3,
    };
    /// Within an outer iteration, from the maximum of the one before it.
    pub const STEP: Self = Self {
        evaluations: 12,
        tolerance: 1e-3,
    };
    /// A few steps from a point close by: in the draws of a bootstrap.
    pub const SHORT: Self = Self {
        evaluations: 10,
        tolerance: 0.05,
    };
}

/// A maximum.
#[derive(Clone, Debug)]
pub struct Maximum {
    /// Where.
    pub variances: Variances,
    /// Log-likelihood, with the logarithm of the priors.
    pub log_likelihood: f64,
    /// Evaluations made.
    pub evaluations: usize,
    /// Inverse curvature in the logarithms, as the ascent learnt it: a start for ascents close by.
    pub inverse: Vec<f64>,
}

/// The variables among the standard deviations, and what is known of all.
pub struct Maximiser<'a> {
    /// The groups.
    pub tree: &'a Tree,
    /// One entry a component.
    pub components: &'a [Scale],
    /// One entry a class of noise.
    pub noise: &'a [Scale],
    /// Which likelihood.
    pub likelihood: Likelihood,
}

impl Maximiser<'_> {
    /// Usual sizes times a factor; what is fixed as it is.
    pub fn start(&self, factor: f64) -> Variances {
        let of = |scales: &[Scale], factor: f64| -> Vec<f64> {
            let value = |s: &Scale| match s.prior {
                Prior::Fixed(sd) | Prior::Held(sd) => sd,
                _ => s.usual * factor,
            };
            scales.iter().map(value).collect()
        };
        Variances {
            components: of(self.components, factor),
            noise: of(self.noise, 1.0),
        }
    }

    fn scales(&self) -> impl Iterator<Item = &Scale> {
        self.components.iter().chain(self.noise)
    }

    pub(crate) fn variables(&self, at: &Variances) -> Vec<f64> {
        let values = at.components.iter().chain(&at.noise);
        let free = self.scales().zip(values);
        free.filter(|(s, _)| s.prior.is_estimated())
            .map(|(s, v)| libm::log(v.clamp(s.usual * RANGE.0, s.usual * RANGE.1)))
            .collect()
    }

    fn variances(&self, variables: &[f64]) -> Variances {
        let mut next = variables.iter();
        let mut all = self.scales().map(|s| match s.prior {
            Prior::Fixed(sd) | Prior::Held(sd) => sd,
            _ => next.next().map_or(s.usual, |v| libm::exp(*v)),
        });
        let components = all.by_ref().take(self.components.len()).collect();
        let noise = all.collect();
        Variances { components, noise }
    }

    /// Log-likelihood with priors at some variances.
    pub fn value(&self, gram: &Gram, at: &Variances) -> f64 {
        let factor = Factor::new(self.tree, gram, at);
        factor.log_likelihood(self.likelihood) + self.log_prior(at)
    }

    fn log_prior(&self, at: &Variances) -> f64 {
        let values = at.components.iter().chain(&at.noise);
        self.scales()
            .zip(values)
            .map(|(s, v)| match s.prior {
                Prior::HalfNormal(scale) => half_normal(s, scale, *v),
                Prior::Away(scale) => half_normal(s, scale, *v) + away(v / s.usual).0,
                Prior::Free | Prior::Fixed(_) | Prior::Held(_) => 0.0,
            })
            .sum()
    }

    /// The same with its derivatives by the variables: logarithms of the standard deviations that are estimated.
    pub(crate) fn value_and_gradient(&self, gram: &Gram, variables: &[f64]) -> (f64, Vec<f64>) {
        let at = self.variances(variables);
        let factor = Factor::new(self.tree, gram, &at);
        let value = factor.log_likelihood(self.likelihood) + self.log_prior(&at);
        let (by_components, by_noise) = factor.gradient(self.likelihood);
        let slopes = by_components.iter().chain(&by_noise);
        let values = at.components.iter().chain(&at.noise);
        let all = self.scales().zip(slopes).zip(values);
        let gradient = all
            .filter(|((s, _), _)| s.prior.is_estimated())
            .map(|((s, slope), v)| match s.prior {
                Prior::HalfNormal(scale) => slope + 2.0 * half_normal(s, scale, *v),
                Prior::Away(scale) => slope + 2.0 * half_normal(s, scale, *v) + away(v / s.usual).1,
                Prior::Free | Prior::Fixed(_) | Prior::Held(_) => *slope,
            })
            .collect();
        (value, gradient)
    }

    /// Inverse of the largest curvature that the logarithms can have: each value of a component, and each reading of a class, adds at most 2.
    fn least_inverse(&self, gram: &Gram) -> Vec<f64> {
        let mut values = vec![0; self.components.len()];
        let blocks = (0..self.tree.len()).flat_map(|n| self.tree.blocks(n));
        blocks.for_each(|b| values[b.component] += b.columns);
        let counts = values.iter().chain(&gram.counts).zip(self.scales());
        let curvatures: Vec<f64> = counts
            .filter(|(_, s)| s.prior.is_estimated())
            .map(|(count, _)| 2.0 * (*count).max(1) as f64)
            .collect();
        let n = curvatures.len();
        let mut inverse = vec![0.0; n * n];
        for (k, curvature) in curvatures.iter().enumerate() {
            inverse[k * n + k] = 1.0 / curvature;
        }
        inverse
    }

    fn limits(&self) -> Vec<(f64, f64)> {
        self.scales()
            .filter(|s| s.prior.is_estimated())
            .map(|s| (libm::log(s.usual * RANGE.0), libm::log(s.usual * RANGE.1)))
            .collect()
    }

    /// Ascends from a point.
    pub fn maximise(&self, gram: &Gram, from: &Variances, effort: Effort) -> Maximum {
        self.maximise_with(gram, from, effort, None)
    }

    /// Ascends from a point, with the inverse curvature of an ascent close by.
    pub fn maximise_with(
        &self,
        gram: &Gram,
        from: &Variances,
        effort: Effort,
        known: Option<&[f64]>,
    ) -> Maximum {
        let limits = self.limits();
        let mut x = self.variables(from);
        let (mut value, mut gradient) = self.value_and_gradient(gram, &x);
        let n = x.len();
        let mut evaluations = 1;
        let cautious = self.least_inverse(gram);
        let known = known.filter(|k| k.len() == n * n);
        let mut is_cautious = known.is_none();
        let mut inverse = known.map_or_else(|| cautious.clone(), <[f64]>::to_vec);
        while evaluations < effort.evaluations {
            let direction = ascent(&inverse, &gradient, &x, &limits);
            let slope = dot(&direction, &gradient);
            let mut length = 1.0;
            let mut moved = None;
            while slope >= effort.tolerance * 0.1
                && evaluations < effort.evaluations
                && length > 1e-4
            {
                let y = step(&x, &direction, length, &limits);
                let (v, g) = self.value_and_gradient(gram, &y);
                evaluations += 1;
                if v.is_finite() && v >= value + 1e-4 * length * slope {
                    moved = Some((y, v, g));
                    break;
                }
                length *= 0.3;
            }
            let mut gain = 0.0;
            if let Some((y, v, g)) = moved {
                update(&mut inverse, &x, &y, &gradient, &g);
                gain = v - value;
                (x, value, gradient) = (y, v, g);
            }
            if gain < effort.tolerance {
                // The curvature that was learnt elsewhere may hold it back.
                let safe = ascent(&cautious, &gradient, &x, &limits);
                if is_cautious || 0.5 * dot(&safe, &gradient) < effort.tolerance {
                    break;
                }
                inverse.clone_from(&cautious);
            }
            is_cautious = gain < effort.tolerance;
        }
        Maximum {
            variances: self.variances(&x),
            log_likelihood: value,
            evaluations,
            inverse,
        }
    }

    /// The best of ascents from several starts: those that are far behind after a few steps are given up.
    pub fn best(&self, gram: &Gram, starts: &[Variances], effort: Effort) -> Maximum {
        let usual = [self.start(1.0)];
        let starts = if starts.is_empty() { &usual } else { starts };
        if let [only] = starts {
            return self.maximise(gram, only, effort);
        }
        let first = Effort {
            evaluations: HEAT,
            ..effort
        };
        let begun: Vec<Maximum> = starts
            .par_iter()
            .map(|start| self.maximise(gram, start, first))
            .collect();
        let highest = |of: &[Maximum]| {
            let values = of.iter().map(|m| m.log_likelihood);
            values.fold(f64::NEG_INFINITY, f64::max)
        };
        let limit = highest(&begun) - GIVEN_UP;
        let mut ended: Vec<Maximum> = begun
            .into_par_iter()
            .filter(|m| !matches!(m.log_likelihood.partial_cmp(&limit), Some(Ordering::Less)))
            .map(|m| self.maximise_with(gram, &m.variances, effort, Some(&m.inverse)))
            .collect();
        let best = highest(&ended);
        let place = ended.iter().position(|m| m.log_likelihood == best);
        ended.swap_remove(place.unwrap_or(0))
    }
}

/// Logarithm of the half-normal prior of a standard deviation, less its constant.
fn half_normal(of: &Scale, scale: f64, sd: f64) -> f64 {
    -0.5 * of.groups as f64 * (sd / scale) * (sd / scale)
}

/// Logarithm of x/(1 + x^2), and its derivative by the logarithm of x.
fn away(x: f64) -> (f64, f64) {
    let square = x * x;
    (
        libm::log(x / (1.0 + square)),
        (1.0 - square) / (1.0 + square),
    )
}

/// The quasi-Newton direction among the variables that do not press against a limit, bounded in length.
fn ascent(inverse: &[f64], gradient: &[f64], x: &[f64], limits: &[(f64, f64)]) -> Vec<f64> {
    let n = x.len();
    let held: Vec<bool> = (0..n)
        .map(|k| {
            (x[k] <= limits[k].0 && gradient[k] < 0.0) || (x[k] >= limits[k].1 && gradient[k] > 0.0)
        })
        .collect();
    let mut direction: Vec<f64> = (0..n)
        .map(|i| {
            if held[i] {
                return 0.0;
            }
            (0..n)
                .filter(|j| !held[*j])
                .map(|j| inverse[i * n + j] * gradient[j])
                .sum()
        })
        .collect();
    let longest = direction.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    if longest > LONGEST_STEP {
        for d in &mut direction {
            *d *= LONGEST_STEP / longest;
        }
    }
    direction
}

fn step(x: &[f64], direction: &[f64], length: f64, limits: &[(f64, f64)]) -> Vec<f64> {
    let moved = x.iter().zip(direction).zip(limits);
    moved
        .map(|((x, d), (low, high))| (x + length * d).clamp(*low, *high))
        .collect()
}

/// BFGS for a maximum: curvature pairs with the sign of the gradient turned.
fn update(inverse: &mut [f64], x: &[f64], y: &[f64], old: &[f64], new: &[f64]) {
    let n = x.len();
    let s: Vec<f64> = y.iter().zip(x).map(|(a, b)| a - b).collect();
    let d: Vec<f64> = old.iter().zip(new).map(|(a, b)| a - b).collect();
    let sd: f64 = s.iter().zip(&d).map(|(a, b)| a * b).sum();
    if sd <= 1e-12 {
        return;
    }
    let hd: Vec<f64> = (0..n)
        .map(|i| (0..n).map(|j| inverse[i * n + j] * d[j]).sum())
        .collect();
    let dhd: f64 = hd.iter().zip(&d).map(|(a, b)| a * b).sum();
    for i in 0..n {
        for j in 0..n {
            inverse[i * n + j] +=
                (1.0 + dhd / sd) * s[i] * s[j] / sd - (hd[i] * s[j] + s[i] * hd[j]) / sd;
        }
    }
}
