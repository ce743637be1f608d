//! Whether the size of a term is one number: further columns at the root with one standard deviation, against none.
//!
//! y = X beta + Z b + G u + e with u ~ N(0, tau^2). The columns G are what the caller makes of the term's sensitivity at the mode and of smooth
//! functions of its argument; they are frozen, as all sensitivities inside the covariance are. The statistic is the gain in *restricted*
//! likelihood over tau = 0, the other variances estimated again on both sides. The fixed effects are the same in both models, so that the
//! restricted likelihoods compare, and what the term's own amplitude takes of G counts neither for nor against it: G need not be made
//! orthogonal to a constant. (The full likelihood would charge log|V| for that part.)
//!
//! tau = 0 is at the edge of what is possible, half of the draws gain nothing, and with a handful of groups no table is right: p is that of a
//! parametric bootstrap from the fitted model without G. Where there are several terms, a draw counts with the largest gain of any, so that p
//! is family-wise, and the model without G is fitted once a draw.
//!
//! [`Beside`] asks less: what the columns of one term gain over a model, by the full likelihood, as another term would. A term that gains no more
//! beside the first than these do may be nothing but the form of the first.
//!
//! What u is, is answered with tau averaged over its likelihood (a flat prior; Gelman, Bayesian Analysis 1 (2006) 515): at the maximum alone,
//! which is often 0, a size that is hardly known would look like one that is known not to change.

use crate::decisions::IDENTIFIABLE;
use crate::fit::{Fitted, Setting};
use crate::gram::{Design, Gram, Square};
use crate::screen::{BATCH, Normal, draw};
use crate::statistic::{deviate, is_decided, upper_tail};
use crate::system::{Factor, Likelihood, Panel, Variances};
use crate::tree::Block;
use crate::variance::{Effort, Maximum, Prior, Scale};
use rayon::prelude::*;
use std::sync::Arc;

/// Where the likelihood of tau is taken, as multiples of its estimate, or of the value that is as large as what is not known of u.
pub(crate) const GRID: [f64; 10] = [0.0, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];

/// How the question is decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Family-wise level.
    pub level: f64,
    /// Most draws.
    pub draws: usize,
}

/// What further columns gain, and what their coefficients are.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Gain in restricted log-likelihood.
    pub gain: f64,
    /// Probability of as large a gain of any of the terms that were asked for.
    pub p: f64,
    /// The standard deviation.
    pub sd: f64,
    /// Means of the coefficients u, then of the fixed effects of the design.
    pub mean: Vec<f64>,
    /// Their covariance.
    pub covariance: Square,
}

/// The gain and the probability of each of several sets of further columns, one list of all readings a column; none of a set of which the fixed
/// effects leave nothing.
pub fn answers(
    setting: &Setting,
    model: &Fitted,
    sets: &[Vec<Vec<f64>>],
    bootstrap: Bootstrap,
    normal: &Normal,
) -> Vec<Option<Answer>> {
    let plain = Plain::new(setting, model, Likelihood::Restricted);
    let wider: Vec<Option<Wider>> = sets.iter().map(|set| plain.wider(set)).collect();
    let asked: Vec<&Wider> = wider.iter().flatten().collect();
    let gains: Vec<f64> = asked
        .par_iter()
        .map(|w| plain.gain(w, &w.gram, &plain.maximum))
        .collect();
    let draws = plain.draws(&asked, &gains, bootstrap, normal);
    let mut gains = gains.into_iter();
    wider
        .iter()
        .map(|w| {
            let w = w.as_ref()?;
            let gain = gains.next()?;
            Some(plain.answer(w, gain, upper_tail(&draws, deviate(2.0 * gain, 1))))
        })
        .collect()
}

/// A model of which sets of further columns may each be a part.
pub struct Beside<'a>(Plain<'a>);

impl<'a> Beside<'a> {
    /// Beside a fitted model.
    pub fn new(setting: &'a Setting<'a>, model: &'a Fitted) -> Self {
        Self(Plain::new(setting, model, Likelihood::Full))
    }

    /// What a set gains in (full) log-likelihood; nothing where the fixed effects leave nothing of it.
    pub fn gain(&self, set: &[Vec<f64>]) -> f64 {
        let wider = self.0.wider(set);
        wider.map_or(0.0, |w| self.0.gain(&w, &w.gram, &self.0.maximum))
    }

    /// The same by an ascent that goes on to its end, and the standard deviation of the coefficients with which it does.
    pub fn scatter(&self, set: &[Vec<f64>]) -> (f64, f64) {
        let Some(wider) = self.0.wider(set) else {
            return (0.0, 0.0);
        };
        let plain = &self.0.maximum;
        let with = self.0.ascent(&wider, &wider.gram, plain, Effort::STEP);
        let gain = with.log_likelihood - plain.log_likelihood;
        if gain > 0.0 {
            (gain, with.variances.components[self.0.scales.len()])
        } else {
            (0.0, 0.0)
        }
    }

    /// What a set gains with a known standard deviation of the coefficients: less than nothing where that is too large.
    pub fn gain_at(&self, set: &[Vec<f64>], sd: f64) -> f64 {
        if sd == 0.0 {
            return 0.0;
        }
        let known = |wider: &Wider| self.0.with_known(wider, &self.0.maximum.variances, sd);
        let with = self.0.wider(set).map(|wider| known(&wider).log_likelihood);
        with.map_or(0.0, |with| with - self.0.maximum.log_likelihood)
    }
}

/// The model without further columns.
struct Plain<'a> {
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    likelihood: Likelihood,
    scales: Vec<Scale>,
    maximum: Maximum,
}

/// The model with them.
struct Wider {
    design: Design,
    gram: Gram,
    scales: Vec<Scale>,
    /// Number of columns.
    columns: usize,
    /// Where ascents start: as large as what is not known of the coefficients.
    start: f64,
}

impl<'a> Plain<'a> {
    fn new(setting: &'a Setting<'a>, model: &'a Fitted, likelihood: Likelihood) -> Self {
        let scales = setting.scales();
        let maximum = setting.maximiser(&scales, likelihood).maximise_with(
            &model.gram,
            &model.variances,
            Effort::FULL,
            Some(&model.inverse),
        );
        Self {
            setting,
            model,
            likelihood,
            scales,
            maximum,
        }
    }

    fn wider(&self, set: &[Vec<f64>]) -> Option<Wider> {
        let plain = &self.model.design;
        let factor = Factor::new(&plain.tree, &self.model.gram, &self.maximum.variances);
        let left = factor.project(&Panel::new(plain, &self.model.gram, set));
        let [before, after] = [&left.unprojected, &left.squares].map(|s| s.iter().sum::<f64>());
        if set.is_empty() || !(after > IDENTIFIABLE * before && after.is_finite()) {
            return None;
        }
        let root = plain.tree.width(0);
        let rows = plain.z.iter().enumerate();
        let z = rows.map(|(i, z)| {
            let own = set.iter().map(|column| column[i]);
            let above = z[..root].iter().copied();
            above.chain(own).chain(z[root..].iter().copied()).collect()
        });
        let design = Design {
            tree: plain.tree.with_at_root(Block {
                component: self.scales.len(),
                columns: set.len(),
            }),
            z: Arc::new(z.collect()),
            ..plain.clone()
        };
        let mut scales = self.scales.clone();
        let start = (set.len() as f64 / after).sqrt();
        scales.push(Scale {
            prior: Prior::Free,
            usual: start.max(1.0),
            groups: 1,
        });
        Some(Wider {
            gram: self.setting.sums(&design),
            design,
            scales,
            columns: set.len(),
            start,
        })
    }

    /// Variances with one more component.
    fn with(&self, variances: &Variances, sd: f64) -> Variances {
        let mut wider = variances.clone();
        wider.components.push(sd);
        wider
    }

    /// The ascent from a model without the columns. The information on the logarithm of tau is half the number of columns where tau is as large as
    /// what is not known of the coefficients.
    fn ascent(&self, wider: &Wider, gram: &Gram, plain: &Maximum, effort: Effort) -> Maximum {
        let known = self.scales.iter().filter(|s| s.prior.is_estimated());
        let inverse = bordered(&plain.inverse, known.count(), 2.0 / wider.columns as f64);
        let from = self.with(&plain.variances, wider.start);
        self.maximise(
            wider,
            &wider.scales,
            gram,
            &from,
            effort,
            inverse.as_deref(),
        )
    }

    fn maximise(
        &self,
        wider: &Wider,
        scales: &[Scale],
        gram: &Gram,
        from: &Variances,
        effort: Effort,
        inverse: Option<&[f64]>,
    ) -> Maximum {
        let maximiser = crate::variance::Maximiser {
            tree: &wider.design.tree,
            ..self.setting.maximiser(scales, self.likelihood)
        };
        maximiser.maximise_with(gram, from, effort, inverse)
    }

    /// Gain of the columns with the effort of a draw; 0 where tau = 0 does as well.
    fn gain(&self, wider: &Wider, gram: &Gram, plain: &Maximum) -> f64 {
        let with = self.ascent(wider, gram, plain, Effort::SHORT);
        (with.log_likelihood - plain.log_likelihood).max(0.0)
    }

    /// The largest gains of draws from the model without columns, on the scale of [`deviate`]: no more than it takes to decide.
    fn draws(
        &self,
        asked: &[&Wider],
        gains: &[f64],
        bootstrap: Bootstrap,
        normal: &Normal,
    ) -> Vec<f64> {
        let mut draws: Vec<f64> = Vec::new();
        let is_open = |draws: &[f64]| {
            let mut values = gains.iter().map(|g| deviate(2.0 * g, 1));
            values.any(|v| !is_decided(draws, bootstrap.level, v))
        };
        while draws.len() < bootstrap.draws && is_open(&draws) {
            let end = (draws.len() + BATCH).min(bootstrap.draws);
            let batch = draws.len()..end;
            let more: Vec<f64> = batch
                .into_par_iter()
                .map(|k| self.largest_of_draw(asked, &mut *normal(k)))
                .collect();
            draws.extend(more);
        }
        draws
    }

    fn largest_of_draw(&self, asked: &[&Wider], normal: &mut dyn FnMut() -> f64) -> f64 {
        let y = draw(self.model, &self.maximum.variances, normal);
        let gram = self
            .model
            .design
            .with_response_of(&self.model.gram, &[], &y);
        let plain = self
            .setting
            .maximiser(&self.scales, self.likelihood)
            .maximise_with(
                &gram,
                &self.maximum.variances,
                Effort::SHORT,
                Some(&self.maximum.inverse),
            );
        let gains = asked.iter().map(|wider| {
            let gram = wider.design.with_response_of(&wider.gram, &[], &y);
            self.gain(wider, &gram, &plain)
        });
        deviate(2.0 * gains.fold(0.0, f64::max), 1)
    }

    fn answer(&self, wider: &Wider, gain: f64, p: f64) -> Answer {
        let best = self.ascent(wider, &wider.gram, &self.maximum, Effort::FULL);
        let sd = best.variances.components[self.scales.len()];
        let unit = sd.max(wider.start);
        let points: Vec<Point> = GRID
            .par_iter()
            .map(|factor| self.point(wider, &best.variances, factor * unit))
            .collect();
        let gain = gain.max(best.log_likelihood - self.maximum.log_likelihood);
        let (mean, covariance) = averaged(&points);
        Answer {
            gain,
            p,
            sd,
            mean,
            covariance,
        }
    }

    /// The other variances where the standard deviation of the coefficients is known.
    fn with_known(&self, wider: &Wider, from: &Variances, sd: f64) -> Maximum {
        let component = self.scales.len();
        let mut scales = wider.scales.clone();
        scales[component].prior = Prior::Fixed(sd);
        let mut from = from.clone();
        from.components.truncate(component);
        from.components.push(sd);
        let inverse = Some(self.maximum.inverse.as_slice());
        let effort = Effort::SHORT;
        self.maximise(wider, &scales, &wider.gram, &from, effort, inverse)
    }

    /// The model with a known standard deviation of the coefficients.
    fn point(&self, wider: &Wider, from: &Variances, sd: f64) -> Point {
        let at = self.with_known(wider, from, sd);
        let factor = Factor::new(&wider.design.tree, &wider.gram, &at.variances);
        let estimates = factor.estimates();
        let root = wider.design.tree.width(0);
        let first = root - wider.columns;
        let own = estimates.random[first..root].iter().copied();
        let open = factor.covariance_at_root();
        let mut covariance = Square::zeros(open.n - first);
        for i in 0..covariance.n {
            for j in 0..covariance.n {
                *covariance.at_mut(i, j) = open.at(first + i, first + j);
            }
        }
        Point {
            sd,
            log_likelihood: at.log_likelihood,
            mean: own.chain(estimates.fixed.iter().copied()).collect(),
            covariance,
        }
    }
}

/// Coefficients given their standard deviation.
struct Point {
    sd: f64,
    log_likelihood: f64,
    mean: Vec<f64>,
    covariance: Square,
}

/// Mean and covariance with the standard deviation averaged over its likelihood, by trapezoids.
fn averaged(points: &[Point]) -> (Vec<f64>, Square) {
    let highest = points.iter().map(|p| p.log_likelihood);
    let highest = highest.fold(f64::NEG_INFINITY, f64::max);
    let last = points.len() - 1;
    let weight = |k: usize| {
        let width = points[last.min(k + 1)].sd - points[k.saturating_sub(1)].sd;
        width * libm::exp(points[k].log_likelihood - highest)
    };
    let weights: Vec<f64> = (0..points.len()).map(weight).collect();
    let all: f64 = weights.iter().sum();
    let n = points[0].mean.len();
    let mut mean = vec![0.0; n];
    for (w, p) in weights.iter().zip(points) {
        for (m, x) in mean.iter_mut().zip(&p.mean) {
            *m += w / all * x;
        }
    }
    let mut covariance = Square::zeros(n);
    for (w, p) in weights.iter().zip(points) {
        for i in 0..n {
            for j in 0..n {
                let off = (p.mean[i] - mean[i]) * (p.mean[j] - mean[j]);
                *covariance.at_mut(i, j) += w / all * (p.covariance.at(i, j) + off);
            }
        }
    }
    (mean, covariance)
}

/// A matrix with one more row and column behind the first `place`: components stand before the noise, and the new one is the last of them.
fn bordered(inverse: &[f64], place: usize, diagonal: f64) -> Option<Vec<f64>> {
    let n = (0..=inverse.len()).find(|n| n * n >= inverse.len())?;
    if n * n != inverse.len() || place > n {
        return None;
    }
    let wide = n + 1;
    let mut a = vec![0.0; wide * wide];
    let to = |k: usize| if k < place { k } else { k + 1 };
    for i in 0..n {
        for j in 0..n {
            a[to(i) * wide + to(j)] = inverse[i * n + j];
        }
    }
    a[place * wide + place] = diagonal;
    Some(a)
}
