//! What may be added: how every direction of every candidate shows in the residual of a fitted model, and how improbable the strongest is.
//!
//! First all directions by their score, at the variances of the null model; then, for the strongest, the gain in marginal likelihood with the
//! variances estimated again: an effect that acts between groups is otherwise hidden by the scatter that it inflates. The maximum over
//! all candidates is compared with that of draws from the fitted null, for each of which the same is done.

use crate::fit::{Fitted, Setting};
use crate::gram::{Gram, Square};
use crate::problem::Direction;
use crate::statistic::deviate;
use crate::system::{Factor, Likelihood, Panel, Variances};
use crate::variance::Effort;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Least share of a whitened sensitivity that the fixed effects must leave.
pub const IDENTIFIABLE: f64 = 0.01;
/// How many of the strongest directions get their variances estimated again.
const REFINED: usize = 4;

/// A source of standard normal numbers for a draw.
pub type Normal<'n> = dyn Fn(usize) -> Box<dyn FnMut() -> f64> + Sync + 'n;

/// A direction with what it shows.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Place in the list of directions.
    pub direction: usize,
    /// Number of amplitudes.
    pub amplitudes: usize,
    /// Amplitudes by generalised least squares.
    pub estimate: Vec<f64>,
    /// Twice the gain in log-likelihood.
    pub likelihood_ratio: f64,
    /// Share of the whitened sensitivity that the fixed effects leave.
    pub share: f64,
    /// Length of the whitened sensitivity after projection, per unit amplitude (of the first amplitude).
    pub length: f64,
}

impl Shown {
    /// The likelihood ratio on the scale of [`deviate`].
    pub fn deviate(&self) -> f64 {
        deviate(self.likelihood_ratio, self.amplitudes)
    }
}

/// Candidates beside a fitted model.
pub struct Screen<'a> {
    setting: &'a Setting<'a>,
    null: &'a Fitted,
    /// The directions.
    pub directions: Vec<Direction>,
    /// All columns: for each direction its amplitudes, then the sums of their pairs (for the products between them).
    columns: Vec<Vec<f64>>,
    first: Vec<usize>,
    panel: Panel,
    extended: Vec<OnceLock<Gram>>,
    /// Value of the null's likelihood with the effort of a draw.
    null_value: f64,
    /// Standard deviations of the null by the restricted likelihood, from which responses are drawn: those of the full one are too small where
    /// fixed effects take their share, most of all where a component has few columns.
    restricted: OnceLock<Variances>,
}

impl<'a> Screen<'a> {
    /// The candidates of the problem at a fitted model.
    pub fn new(setting: &'a Setting<'a>, null: &'a Fitted) -> Self {
        // One form of an effect is one too many where another is in the model: what the forms share would be split between them.
        let terms = setting.problem.terms();
        let kinds: Vec<usize> = null
            .point
            .terms
            .iter()
            .map(|(t, _)| terms[*t].kind)
            .collect();
        let mut directions = setting.problem.directions(&null.point);
        directions.retain(|d| !kinds.contains(&terms[d.term].kind));
        Self::of(setting, null, directions)
    }

    /// These candidates only.
    pub fn of(setting: &'a Setting<'a>, null: &'a Fitted, directions: Vec<Direction>) -> Self {
        let mut columns = Vec::new();
        let mut first = Vec::new();
        for d in &directions {
            first.push(columns.len());
            columns.extend(d.columns.iter().cloned());
            for i in 0..d.columns.len() {
                for j in 0..i {
                    let pair = d.columns[i].iter().zip(&d.columns[j]);
                    columns.push(pair.map(|(a, b)| a + b).collect());
                }
            }
        }
        let panel = Panel::of_active(&null.design, &columns, |n| setting.active[n]);
        let mut screen = Self {
            setting,
            null,
            extended: directions.iter().map(|_| OnceLock::new()).collect(),
            directions,
            columns,
            first,
            panel,
            null_value: 0.0,
            restricted: OnceLock::new(),
        };
        screen.null_value = screen.value(&null.gram, &null.variances).1;
        screen
    }

    /// Variances and likelihood of a model close to the null, with the effort of a draw.
    fn value(&self, gram: &Gram, from: &Variances) -> (Variances, f64) {
        let scales = self.setting.scales();
        let maximiser = self.setting.maximiser(&scales, Likelihood::Full);
        let found = maximiser.maximise_with(gram, from, Effort::SHORT, Some(&self.null.inverse));
        (found.variances, found.log_likelihood)
    }

    /// The directions by their scores at some variances, strongest first; those that cannot be told from the fixed effects are left out.
    fn scores(&self, gram: &Gram, panel: &Panel, variances: &Variances) -> Vec<Shown> {
        let factor = Factor::new(&self.null.design.tree, gram, variances);
        let projected = factor.project(panel);
        let mut shown = Vec::with_capacity(self.directions.len());
        for (d, first) in self.first.iter().enumerate() {
            let k = self.directions[d].columns.len();
            let before: f64 = projected.unprojected[*first..first + k].iter().sum();
            let after: f64 = projected.squares[*first..first + k].iter().sum();
            let share = if before > 0.0 { after / before } else { 0.0 };
            if share.is_nan() || share <= IDENTIFIABLE {
                continue;
            }
            let mut information = Square::zeros(k);
            let mut pair = first + k;
            for i in 0..k {
                *information.at_mut(i, i) = projected.squares[first + i];
                for j in 0..i {
                    let both = projected.squares[pair];
                    let product =
                        0.5 * (both - projected.squares[first + i] - projected.squares[first + j]);
                    *information.at_mut(i, j) = product;
                    *information.at_mut(j, i) = product;
                    pair += 1;
                }
            }
            let scores = &projected.scores[*first..first + k];
            let (estimate, gain) = solve(&information, scores);
            shown.push(Shown {
                direction: d,
                amplitudes: k,
                estimate,
                likelihood_ratio: gain,
                share,
                length: information.at(0, 0).max(0.0).sqrt(),
            });
        }
        shown.sort_by(|a, b| b.deviate().total_cmp(&a.deviate()));
        shown
    }

    /// Gain of a direction with the variances estimated again.
    fn refined(&self, shown: &Shown, y: Option<&[f64]>, null_value: f64, from: &Variances) -> f64 {
        let gram = self.extended[shown.direction].get_or_init(|| {
            let mut design = self.null.design.clone();
            design
                .x
                .extend(self.directions[shown.direction].columns.iter().cloned());
            self.setting.sums(&design)
        });
        let value = match y {
            None => self.value(gram, from).1,
            Some(y) => {
                let extra = &self.directions[shown.direction].columns;
                let gram = self.null.design.with_response_of(gram, extra, y);
                self.value(&gram, from).1
            }
        };
        (2.0 * (value - null_value)).max(shown.likelihood_ratio)
    }

    /// The candidates in the data, strongest first; the first few with the variances estimated again.
    pub fn shown(&self, refined: usize) -> Vec<Shown> {
        let mut shown = self.scores(&self.null.gram, &self.panel, &self.null.variances);
        shown.par_iter_mut().take(refined).for_each(|s| {
            s.likelihood_ratio = self.refined(s, None, self.null_value, &self.null.variances);
        });
        shown.sort_by(|a, b| b.deviate().total_cmp(&a.deviate()));
        shown
    }

    /// The maxima over all candidates of draws from the null.
    pub fn draws(&self, count: usize, normal: &Normal) -> Vec<f64> {
        (0..count)
            .into_par_iter()
            .map(|k| self.maximum_of_draw(&mut *normal(k)))
            .collect()
    }

    fn maximum_of_draw(&self, normal: &mut dyn FnMut() -> f64) -> f64 {
        let variances = self
            .restricted
            .get_or_init(|| self.null.restricted(self.setting));
        let y = draw(self.null, variances, normal);
        let design = &self.null.design;
        let gram = design.with_response_of(&self.null.gram, &[], &y);
        let (variances, value) = self.value(&gram, &self.null.variances);
        let panel = self
            .panel
            .with_response_of(&self.null.gram, design, &self.columns, &y);
        let scores = self.scores(&gram, &panel, &variances);
        let best = scores.iter().take(REFINED).map(|s| {
            let gain = self.refined(s, Some(&y), value, &variances);
            deviate(gain, s.amplitudes)
        });
        best.fold(f64::NEG_INFINITY, f64::max)
    }

    /// How many directions get their variances estimated again in draws, and must in the data.
    pub fn refined_in_draws() -> usize {
        REFINED
    }
}

/// A response drawn from a fitted model with these standard deviations, its fixed effects taken off.
pub fn draw(model: &Fitted, variances: &Variances, normal: &mut dyn FnMut() -> f64) -> Vec<f64> {
    let tree = &model.design.tree;
    let random: Vec<f64> = (0..tree.len())
        .flat_map(|n| tree.components_of(n))
        .map(|c| variances.components[c] * normal())
        .collect();
    let paths: Vec<Vec<usize>> = (0..tree.len()).map(|n| tree.path_numbers(n)).collect();
    (0..model.design.len())
        .map(|i| {
            let path = &paths[model.design.node[i]];
            let own: f64 = path
                .iter()
                .zip(&model.design.z[i])
                .map(|(c, z)| z * random[*c])
                .sum();
            own + variances.noise[model.design.class[i]] * normal()
        })
        .collect()
}

/// Solution of a small symmetric system and half of it times the right side; directions without a pivot are left at 0.
fn solve(matrix: &Square, right: &[f64]) -> (Vec<f64>, f64) {
    let n = matrix.n;
    let mut lower = Square::zeros(n);
    for j in 0..n {
        let mut pivot = matrix.at(j, j);
        for k in 0..j {
            pivot -= lower.at(j, k) * lower.at(j, k);
        }
        if pivot <= 1e-9 * matrix.at(j, j) || pivot <= 0.0 {
            continue;
        }
        let root = pivot.sqrt();
        *lower.at_mut(j, j) = root;
        for i in j + 1..n {
            let mut x = matrix.at(i, j);
            for k in 0..j {
                x -= lower.at(i, k) * lower.at(j, k);
            }
            *lower.at_mut(i, j) = x / root;
        }
    }
    let half = crate::system::forward(&lower, right);
    let gain = half.iter().map(|x| x * x).sum();
    (crate::system::back_substitute(&lower, &half), gain)
}
