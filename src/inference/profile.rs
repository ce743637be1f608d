//! The profile of the marginal likelihood along one value of a term, and the interval that it gives.
//!
//! Along the profile the forward model is exact in the value itself; coefficients, other amplitudes and variances are estimated again in the
//! linear model of the fit. The cut is that of chi-squared with one degree, stretched by the mean of the likelihood ratio in draws from the
//! fitted model (Bartlett's correction by simulation; Rocke, JASA 84 (1989) 597): with a handful of groups it is wider.

use crate::fit::{Fitted, Setting};
use crate::gram::Gram;
use crate::screen::{Normal, draw};
use crate::system::Likelihood;
use crate::variance::Effort;
use rayon::prelude::*;

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

/// Upper 5% point of chi-squared with one degree.
const CHI_SQUARED: f64 = 3.841_458_820_694_124;
/// How hard the variances are looked for along the profile.
const EFFORT: Effort = Effort {
    evaluations: 10,
    tolerance: 1e-3,
};
/// Draws of the correction.
const DRAWS: usize = 40;
/// Steps to either side, in standard errors.
const STEPS: [f64; 7] = [0.5, 1.0, 1.5, 2.0, 2.6, 3.4, 4.5];

/// The profile of a value of a term in a fitted model; none where the value was not free.
pub fn profile(
    setting: &Setting,
    model: &Fitted,
    term: usize,
    value: usize,
    normal: &Normal,
) -> Option<Profile> {
    let place = model.place(term, value)?;
    let error = model.covariance(&model.variances).at(place, place).sqrt();
    if !(error > 0.0 && error.is_finite()) {
        return None;
    }
    let along = Along::new(setting, model, term, value, place);
    let estimate = model.values(term)?[value];
    let (low, high) = setting.problem.terms()[term].bounds[value];
    let best = along.best;
    let side = |sign: f64| -> Vec<(f64, f64)> {
        let points = STEPS
            .iter()
            .map(|s| (estimate + sign * s * error).clamp(low, high));
        let mut points: Vec<f64> = points.collect();
        points.dedup();
        points
            .into_par_iter()
            .filter(|a| *a != estimate)
            .map(|a| (a, along.at(a) - best))
            .collect()
    };
    let (below, above) = (side(-1.0), side(1.0));
    let cut = -0.5 * CHI_SQUARED * along.stretch(normal);
    let ends = [&below, &above].map(|points| {
        let end = crossing(estimate, points, cut);
        end.filter(|a| (low..=high).contains(a))
    });
    let mut points: Vec<(f64, f64)> = below.iter().rev().copied().collect();
    points.push((estimate, 0.0));
    points.extend(above);
    // With a handful of groups an end may lie beyond the last step.
    for end in ends.into_iter().flatten() {
        let (first, last) = (points[0].0, points[points.len() - 1].0);
        if end < first {
            points.insert(0, (end, along.at(end) - best));
        } else if end > last {
            points.push((end, along.at(end) - best));
        }
    }
    Some(Profile {
        value: estimate,
        low: ends[0],
        high: ends[1],
        points,
    })
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
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    term: usize,
    value: usize,
    place: usize,
    /// The sums without the column of the value.
    pinned: Gram,
    best: f64,
}

impl<'a> Along<'a> {
    fn new(
        setting: &'a Setting,
        model: &'a Fitted,
        term: usize,
        value: usize,
        place: usize,
    ) -> Self {
        let mut design = model.design.clone();
        design.x.remove(place);
        let mut along = Self {
            setting,
            model,
            term,
            value,
            place,
            pinned: setting.sums(&design),
            best: 0.0,
        };
        along.best = along.ascend(&model.gram);
        along
    }

    /// The likelihood with the variances estimated again: from those of the model, and from wider ones, because a component that has faded to
    /// nothing does not grow by itself where the value moves away from its estimate.
    fn ascend(&self, gram: &Gram) -> f64 {
        let own = &self.model.variances;
        let near = self.ascend_near(gram);
        let wide = self.setting.widened(own);
        if wide == *own {
            return near;
        }
        let scales = self.setting.scales();
        let maximiser = self.setting.maximiser(&scales, Likelihood::Full);
        near.max(maximiser.maximise(gram, &wide, EFFORT).log_likelihood)
    }

    /// The same from the variances of the model alone: in draws these are the true ones.
    fn ascend_near(&self, gram: &Gram) -> f64 {
        let scales = self.setting.scales();
        let maximiser = self.setting.maximiser(&scales, Likelihood::Full);
        let (own, inverse) = (&self.model.variances, &self.model.inverse);
        maximiser
            .maximise_with(gram, own, EFFORT, Some(inverse))
            .log_likelihood
    }

    /// The likelihood with the value held.
    fn at(&self, value: f64) -> f64 {
        let mut point = self.model.point.clone();
        for (t, values) in &mut point.terms {
            if *t == self.term {
                values[self.value] = value;
            }
        }
        let there = self.setting.problem.predict(&point);
        let here = self.setting.problem.predict(&self.model.point);
        let y: Vec<f64> = self
            .model
            .design
            .y
            .iter()
            .zip(there.iter().zip(&here))
            .map(|(y, (a, b))| y - (a - b))
            .collect();
        self.ascend(&self.respond(&y))
    }

    fn respond(&self, y: &[f64]) -> Gram {
        let mut design = self.model.design.clone();
        design.x.remove(self.place);
        design.with_response_of(&self.pinned, &[], y)
    }

    /// Mean of the likelihood ratio of the true value in draws from the model; at least 1.
    fn stretch(&self, normal: &Normal) -> f64 {
        let variances = self.model.predictive(self.setting);
        let ratios: Vec<f64> = (0..DRAWS)
            .into_par_iter()
            .map(|k| {
                let y = draw(self.model, &variances, &mut *normal(k));
                let free = self
                    .model
                    .design
                    .with_response_of(&self.model.gram, &[], &y);
                let best = self.ascend_near(&free);
                let pinned = self.ascend_near(&self.respond(&y));
                (2.0 * (best - pinned)).max(0.0)
            })
            .collect();
        (ratios.iter().sum::<f64>() / ratios.len() as f64).max(1.0)
    }
}
