//! The profile of the marginal likelihood along one value of a term, and the interval that it gives.
//!
//! With the value held, the whole model is fitted again: coefficients, other amplitudes, shapes and variances. On either side each fit starts from
//! the one before it. The cut is that of chi-squared with one degree, stretched by the mean of the likelihood ratio in draws from the
//! fitted model (Bartlett's correction by simulation; Rocke, JASA 84 (1989) 598): with a handful of groups it is wider. In the draws the model is
//! linear.

use crate::decisions::FALL_95;
use crate::fit::{Fitted, Free, Setting};
use crate::gram::{Design, Gram};
use crate::screen::{Normal, draw};
use crate::system::{Likelihood, Variances};
use crate::variance::Effort;
use rayon::prelude::*;
use std::sync::OnceLock;

/// A profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The estimate.
    pub value: f64,
    /// Ends of the interval; none where the likelihood stays above the cut as far as the bound.
    pub low: Option<f64>,
    /// See `low`.
    pub high: Option<f64>,
    /// Value and log-likelihood less its largest, rising in the value.
    pub points: Vec<(f64, f64)>,
}

/// How hard the variances are looked for in draws.
const EFFORT: Effort = Effort {
    evaluations: 20,
    tolerance: 1e-3,
};
/// Draws of the correction.
const DRAWS: usize = 40;
/// Steps to either side, in standard errors.
const STEPS: [f64; 7] = [0.5, 1.0, 1.5, 2.0, 2.6, 3.4, 4.5];

/// Where the likelihood has fallen by this multiple of the cut, nothing more is asked.
const FAR: f64 = 2.0;
/// How often an end is looked for beyond the last step, and how much further at least each time.
const BEYOND: usize = 6;
const WIDER: f64 = 1.25;
/// An end beyond the last step holds where the likelihood has fallen by this share of the cut.
const NEARLY: f64 = 0.9;

/// The profiles of a fitted model; its draws serve for all of them.
pub struct Profiles<'a> {
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    normal: &'a Normal<'a>,
    variances: OnceLock<Variances>,
    draws: OnceLock<Vec<Drawn>>,
}

/// A response drawn from the model, and the log-likelihood that the model comes to there.
struct Drawn {
    response: Vec<f64>,
    log_likelihood: f64,
}

impl<'a> Profiles<'a> {
    /// Of a model, with a source of random numbers.
    pub fn new(setting: &'a Setting<'a>, model: &'a Fitted, normal: &'a Normal<'a>) -> Self {
        Self {
            setting,
            model,
            normal,
            variances: OnceLock::new(),
            draws: OnceLock::new(),
        }
    }

    /// The profile of a value of a term; none where the value was not free.
    pub fn of(&self, term: usize, value: usize) -> Option<Profile> {
        let model = self.model;
        let place = model.place(term, value)?;
        let error = model.covariance(&model.variances).at(place, place).sqrt();
        if !(error > 0.0 && error.is_finite()) {
            return None;
        }
        let along = Along::new(self, term, value, place)?;
        let estimate = model.values(term)?[value];
        let (low, high) = self.setting.problem.terms()[term].bounds[value];
        let cut = -FALL_95 * along.stretch();
        let side = |sign: f64| -> (Vec<(f64, f64)>, Option<f64>) {
            let steps = STEPS
                .iter()
                .map(|s| (estimate + sign * s * error).clamp(low, high));
            let mut steps: Vec<f64> = steps.collect();
            steps.dedup();
            steps.retain(|a| *a != estimate);
            let mut points = Vec::new();
            let mut last = model.clone();
            for a in steps {
                last = along.at(a, &last);
                points.push((a, last.log_likelihood - model.log_likelihood));
                if points.len() > 1 && last.log_likelihood - model.log_likelihood < FAR * cut {
                    break;
                }
            }
            // With a handful of groups an end may lie beyond the last step; where the likelihood stays up, there is none.
            for _ in 0..BEYOND {
                let Some(&(furthest, there)) = points.last() else {
                    break;
                };
                let sought = crossing(estimate, &points, cut).unwrap_or(furthest);
                if there < NEARLY * cut || furthest == low || furthest == high {
                    break;
                }
                let further = (sought - estimate)
                    .abs()
                    .max(WIDER * (furthest - estimate).abs());
                let sought = (estimate + sign * further).clamp(low, high);
                last = along.at(sought, &last);
                points.push((sought, last.log_likelihood - model.log_likelihood));
            }
            let has_fallen = points.last().is_some_and(|(_, v)| *v < NEARLY * cut);
            let end =
                crossing(estimate, &points, cut).filter(|a| has_fallen && (low..=high).contains(a));
            (points, end)
        };
        let ((below, lower), (above, upper)) = rayon::join(|| side(-1.0), || side(1.0));
        let mut points: Vec<(f64, f64)> = below.iter().rev().copied().collect();
        points.push((estimate, 0.0));
        points.extend(above);
        Some(Profile {
            value: estimate,
            low: lower,
            high: upper,
            points,
        })
    }

    /// Draws from the model, with how groups of their own differ in predictions.
    fn draws(&self) -> &[Drawn] {
        self.draws.get_or_init(|| {
            let drawn = |k: usize| {
                let response = draw(self.model, self.variances(), &mut *(self.normal)(k));
                let design = &self.model.design;
                let gram = design.with_response_of(&self.model.gram, &[], &response);
                Drawn {
                    log_likelihood: self.ascend(&gram),
                    response,
                }
            };
            (0..DRAWS).into_par_iter().map(drawn).collect()
        })
    }

    /// The likelihood of a response in a linear model, the variances estimated again from the true ones.
    fn ascend(&self, gram: &Gram) -> f64 {
        let scales = self.setting.scales();
        let maximiser = self.setting.maximiser(&scales, Likelihood::Full);
        let known = Some(self.model.inverse.as_slice());
        let best = maximiser.maximise_with(gram, self.variances(), EFFORT, known);
        best.log_likelihood
    }

    fn variances(&self) -> &Variances {
        let of = || self.model.predictive(self.setting);
        self.variances.get_or_init(of)
    }
}

/// Where a side of the profile falls below a cut: linear in the root of the likelihood ratio.
fn crossing(estimate: f64, points: &[(f64, f64)], cut: f64) -> Option<f64> {
    let mut before = (estimate, 0.0);
    for &(a, v) in points {
        if v < cut {
            let root = |v: f64| (-v).max(0.0).sqrt();
            let share = (root(cut) - root(before.1)) / (root(v) - root(before.1));
            return Some(before.0 + share * (a - before.0));
        }
        before = (a, v);
    }
    // Beyond the last step the root of the ratio goes on as a straight line.
    if before.1 >= 0.0 {
        return None;
    }
    let slope = (before.0 - estimate) / (-before.1).sqrt();
    Some(estimate + slope * (-cut).sqrt())
}

struct Along<'a> {
    profiles: &'a Profiles<'a>,
    /// The setting with the value held.
    held: Setting<'a>,
    term: usize,
    value: usize,
    /// The linear model without the column of the value, and its sums.
    rest: Design,
    pinned: Gram,
}

impl<'a> Along<'a> {
    fn new(profiles: &'a Profiles<'a>, term: usize, value: usize, place: usize) -> Option<Self> {
        let Profiles { setting, model, .. } = profiles;
        let mut rest = model.design.clone();
        rest.x.remove(place);
        let number = model.point.terms.iter().position(|(t, _)| *t == term)?;
        let mut held = (*setting).clone();
        held.pinned.push(Free::Value(number, value));
        Some(Self {
            profiles,
            held,
            term,
            value,
            pinned: setting.sums(&rest),
            rest,
        })
    }

    /// The model with the value held, from one beside it: from its variances, and from wider ones, because a component that has faded to nothing
    /// does not grow by itself where the value moves away from its estimate.
    fn at(&self, value: f64, beside: &Fitted) -> Fitted {
        let mut point = beside.point.clone();
        for (t, values) in &mut point.terms {
            if *t == self.term {
                values[self.value] = value;
            }
        }
        let own = &beside.variances;
        let starts = [own.clone(), self.profiles.setting.widened(own)];
        self.held.fit(&point, &starts)
    }

    /// Mean of the likelihood ratio of the true value in draws from the model; at least 1.
    fn stretch(&self) -> f64 {
        let draws = self.profiles.draws();
        let ratios: Vec<f64> = draws
            .par_iter()
            .map(|drawn| {
                let gram = self
                    .rest
                    .with_response_of(&self.pinned, &[], &drawn.response);
                let pinned = self.profiles.ascend(&gram);
                (2.0 * (drawn.log_likelihood - pinned)).max(0.0)
            })
            .collect();
        (ratios.iter().sum::<f64>() / ratios.len() as f64).max(1.0)
    }
}
