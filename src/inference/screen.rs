//! What may be added: how every direction of every candidate shows in the residual of a fitted model, and how improbable the strongest is.
//!
//! First all directions by their score, at the variances of the null model; then, for the strongest, the gain in marginal likelihood with the
//! variances estimated again: an effect that acts between groups is otherwise hidden by the scatter that it inflates. The maximum over
//! all candidates is compared with that of draws from the fitted null, for each of which the same is done.

use crate::decisions::IDENTIFIABLE;
use crate::fit::{Fitted, Setting};
use crate::gram::{Gram, Square};
use crate::problem::Direction;
use crate::statistic::{deviate, is_decided};
use crate::system::{Estimates, Factor, Likelihood, Panel, Variances, dot};
use crate::variance::Effort;
use rayon::prelude::*;
use std::sync::OnceLock;

/// How many of the strongest directions get their variances estimated again.
const REFINED: usize = 4;

/// Draws that are made at once where a decision may need fewer than all.
pub(crate) const BATCH: usize = 40;

/// A source of standard normal numbers for a draw.
pub type Normal<'n> = dyn Fn(usize) -> Box<dyn FnMut() -> f64> + Sync + 'n;

/// A direction with what it shows.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Place in the list of directions.
    pub direction: usize,
    /// Number of amplitudes that can show.
    pub amplitudes: usize,
    /// Amplitudes by generalised least squares; 0 of those that cannot show.
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

    /// The amplitude, of a direction that has no other.
    pub fn only_amplitude(&self) -> Option<f64> {
        match self.estimate[..] {
            [only] => Some(only),
            _ => None,
        }
    }
}

/// What the readings tell of a direction.
struct Information {
    direction: usize,
    /// The amplitudes that can show.
    kept: Vec<usize>,
    /// C'P C of their columns.
    matrix: Square,
    /// Share of the whitened sensitivity that the fixed effects leave.
    share: f64,
}

impl Information {
    /// What the direction shows in P y.
    fn shown(&self, direction: &Direction, whitened_twice: &[f64]) -> Shown {
        let columns = self.kept.iter().map(|k| &direction.columns[*k]);
        let scores: Vec<f64> = columns.map(|c| dot(c, whitened_twice)).collect();
        let (values, likelihood_ratio) = solve(&self.matrix, &scores);
        let mut estimate = vec![0.0; direction.columns.len()];
        for (k, value) in self.kept.iter().zip(values) {
            estimate[*k] = value;
        }
        Shown {
            direction: self.direction,
            amplitudes: self.kept.len(),
            estimate,
            likelihood_ratio,
            share: self.share,
            length: self.matrix.at(0, 0).max(0.0).sqrt(),
        }
    }
}

/// Candidates beside a fitted model.
pub struct Screen<'a> {
    setting: &'a Setting<'a>,
    null: &'a Fitted,
    /// Whether amplitudes that cannot show within their bounds are left out.
    bounded: bool,
    /// The directions.
    pub directions: Vec<Direction>,
    /// For each direction the number of its first column in the panel: its amplitudes, then the sums of their pairs (for the products between
    /// them).
    first: Vec<usize>,
    panel: Panel,
    extended: Vec<OnceLock<Gram>>,
    /// Value of the null's likelihood with the effort of a draw.
    null_value: f64,
    /// Of the directions that can be told from the fixed effects, at the variances of the null: draws take it for theirs, which are close.
    information: OnceLock<Vec<Information>>,
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
        Self::of(setting, null, directions).bounded()
    }

    /// Without amplitudes that, anywhere within their bounds, are smaller than their standard error beside the others of their direction. They
    /// cannot be found, and the gain of an amplitude far outside its bounds would hide what can.
    pub fn bounded(mut self) -> Self {
        self.bounded = true;
        self
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
        let panel = Panel::new(&null.design, &null.gram, &columns);
        let mut screen = Self {
            setting,
            null,
            bounded: false,
            extended: directions.iter().map(|_| OnceLock::new()).collect(),
            directions,
            first,
            panel,
            null_value: 0.0,
            information: OnceLock::new(),
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

    /// The directions by their scores at the variances of the null, strongest first; those that cannot be told from the fixed effects are left
    /// out.
    fn scores(&self) -> Vec<Shown> {
        let variances = &self.null.variances;
        let factor = Factor::new(&self.null.design.tree, &self.null.gram, variances);
        let whitened = self.whitened_twice(&factor.estimates(), &self.null.design.y, variances);
        self.shown_in(&whitened)
    }

    /// The directions by what they show in P y, strongest first.
    fn shown_in(&self, whitened_twice: &[f64]) -> Vec<Shown> {
        let of = |i: &Information| i.shown(&self.directions[i.direction], whitened_twice);
        let mut shown: Vec<Shown> = self.information().iter().map(of).collect();
        shown.sort_by(|a, b| b.deviate().total_cmp(&a.deviate()));
        shown
    }

    fn information(&self) -> &[Information] {
        self.information.get_or_init(|| self.informations())
    }

    fn informations(&self) -> Vec<Information> {
        let variances = &self.null.variances;
        let factor = Factor::new(&self.null.design.tree, &self.null.gram, variances);
        let projected = factor.project(&self.panel);
        let mut all = Vec::with_capacity(self.directions.len());
        for (direction, first) in self.first.iter().enumerate() {
            let k = self.directions[direction].columns.len();
            let before: f64 = projected.unprojected[*first..first + k].iter().sum();
            let after: f64 = projected.squares[*first..first + k].iter().sum();
            let share = if before > 0.0 { after / before } else { 0.0 };
            if share.is_nan() || share <= IDENTIFIABLE {
                continue;
            }
            let mut matrix = Square::zeros(k);
            let mut pair = first + k;
            for i in 0..k {
                *matrix.at_mut(i, i) = projected.squares[first + i];
                for j in 0..i {
                    let both = projected.squares[pair];
                    let product =
                        0.5 * (both - projected.squares[first + i] - projected.squares[first + j]);
                    *matrix.at_mut(i, j) = product;
                    *matrix.at_mut(j, i) = product;
                    pair += 1;
                }
            }
            let kept = self.kept(direction, &matrix);
            if !kept.is_empty() {
                all.push(Information {
                    direction,
                    matrix: among(&matrix, &kept),
                    kept,
                    share,
                });
            }
        }
        all
    }

    /// The amplitudes of a direction that can show.
    fn kept(&self, direction: usize, information: &Square) -> Vec<usize> {
        let Direction { term, start, .. } = &self.directions[direction];
        if !self.bounded {
            return (0..information.n).collect();
        }
        let bounds = &self.setting.problem.terms()[*term].bounds;
        let mut kept = Vec::new();
        for i in 0..information.n {
            let (low, high) = bounds[i];
            let most = low.abs().max(high.abs()) / start[i].abs();
            kept.push(i);
            if most * beside_others(&among(information, &kept)).sqrt() < 1.0 {
                kept.pop();
            }
        }
        kept
    }

    /// Gain of a direction with the variances estimated again.
    fn refined(&self, shown: &Shown, y: Option<&[f64]>, null_value: f64, from: &Variances) -> f64 {
        let gram = self.extended[shown.direction].get_or_init(|| {
            let extra: Vec<&[f64]> = self.columns(shown).map(Vec::as_slice).collect();
            self.null.design.gram_with(&self.null.gram, &extra)
        });
        let value = match y {
            None => self.value(gram, from).1,
            Some(y) => {
                let extra: Vec<&[f64]> = self.columns(shown).map(Vec::as_slice).collect();
                let gram = self.null.design.with_response_of(gram, &extra, y);
                self.value(&gram, from).1
            }
        };
        2.0 * (value - null_value)
    }

    /// The columns of a direction's amplitudes that can show.
    fn columns(&self, shown: &Shown) -> impl Iterator<Item = &Vec<f64>> {
        let of = |i: &&Information| i.direction == shown.direction;
        let found = self.information().iter().find(of);
        let kept = found.map_or(&[][..], |i| i.kept.as_slice());
        let columns = &self.directions[shown.direction].columns;
        kept.iter().map(|k| &columns[*k])
    }

    /// The candidates in the data, strongest first; the first few with the variances estimated again.
    pub fn shown(&self, refined: usize) -> Vec<Shown> {
        let mut shown = self.scores();
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

    /// Further draws beside the first ones, for the question whether a value is improbable at a level: no more than it takes to be sure.
    pub fn draws_to_decide(
        &self,
        first: Vec<f64>,
        most: usize,
        normal: &Normal,
        level: f64,
        value: f64,
    ) -> Vec<f64> {
        let mut draws = first;
        while draws.len() < most && !is_decided(&draws, level, value) {
            let end = (draws.len() + BATCH).min(most);
            let batch = draws.len()..end;
            let more: Vec<f64> = batch
                .into_par_iter()
                .map(|k| self.maximum_of_draw(&mut *normal(k)))
                .collect();
            draws.extend(more);
        }
        draws
    }

    fn maximum_of_draw(&self, normal: &mut dyn FnMut() -> f64) -> f64 {
        let drawn_from = self
            .restricted
            .get_or_init(|| self.null.restricted(self.setting));
        let y = draw(self.null, drawn_from, normal);
        let gram = self.null.design.with_response_of(&self.null.gram, &[], &y);
        // From where they were drawn: a component that the full likelihood of the data has at nothing is not found again in a few steps, and
        // every direction would gain what it takes of it.
        let (variances, value) = self.value(&gram, drawn_from);
        let factor = Factor::new(&self.null.design.tree, &gram, &variances);
        let whitened = self.whitened_twice(&factor.estimates(), &y, &variances);
        let shown = self.shown_in(&whitened);
        let best = shown.iter().take(REFINED).map(|s| {
            let gain = self.refined(s, Some(&y), value, &variances);
            deviate(gain, s.amplitudes)
        });
        best.fold(f64::NEG_INFINITY, f64::max)
    }

    /// P y: what is left of a response after its fixed and random effects, by the squared noise; nothing of readings that take no part.
    fn whitened_twice(&self, at: &Estimates, y: &[f64], variances: &Variances) -> Vec<f64> {
        let design = &self.null.design;
        let paths: Vec<Vec<usize>> = (0..design.tree.len())
            .map(|n| design.tree.path_numbers(n))
            .collect();
        let left = |(i, y): (usize, &f64)| {
            let node = design.node[i];
            if !self.setting.active[node] {
                return 0.0;
            }
            let random = paths[node].iter().zip(&design.z[i]);
            let random: f64 = random.map(|(c, z)| z * at.random[*c]).sum();
            let fixed: f64 = design.x.iter().zip(&at.fixed).map(|(x, b)| x[i] * b).sum();
            let noise = variances.noise[design.class[i]];
            (y - random - fixed) / (noise * noise)
        };
        y.iter().enumerate().map(left).collect()
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

/// The rows and columns of a small symmetric matrix that are kept.
fn among(matrix: &Square, kept: &[usize]) -> Square {
    let mut part = Square::zeros(kept.len());
    for (i, from) in kept.iter().enumerate() {
        for (j, to) in kept.iter().enumerate() {
            *part.at_mut(i, j) = matrix.at(*from, *to);
        }
    }
    part
}

/// Information of the last amplitude beside the others.
fn beside_others(information: &Square) -> f64 {
    let last = information.n - 1;
    let others: Vec<usize> = (0..last).collect();
    let cross: Vec<f64> = (0..last).map(|i| information.at(i, last)).collect();
    let (_, taken) = solve(&among(information, &others), &cross);
    (information.at(last, last) - taken).max(0.0)
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
