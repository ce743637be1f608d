//! The model near a fit, reduced to sums over sessions: how much each addition would explain.
//!
//! At a fitted point every addition leaves a trace d = dF/d(amplitude), a number for each reading. What matters of it is what is left
//! after base coefficients, strengths and the effects already in the model have been refitted: its projection d~. Its share |d~|/|d| is
//! *visible*, the cosine between two projections tells whether two additions can be told apart, and (d~.r)^2/(d~.d~) is how much the
//! sum of squares would fall.
//!
//! Everything needed for that are sums of products over the readings of each session, so they are summed once. A subset of the sessions
//! (leave-one-out, resampling, a part of the campaign on which something acts) is then a sum over few small matrices.

use super::model::{Fitted, Model, Place};
use super::term::{Term, What};
use crate::effects::{self, Applied};
use crate::numerics::cholesky::Cholesky;
use crate::numerics::matrix::{Matrix, dot};
use crate::numerics::real::{Dual, Real};

/// Directions that one pass differentiates by.
const WIDTH: usize = 2;
type D = Dual<WIDTH>;

/// A column of the linearised model: a direction, on some of the sessions.
#[derive(Clone, Debug)]
struct Column {
    direction: usize,
    sessions: Vec<bool>,
}

/// Sums of products over the readings of each session.
pub struct Linear {
    /// One matrix a session: products of all directions, the residual last.
    moments: Vec<Matrix>,
    width: usize,
    /// Base, effects of the model, strengths: what is refitted.
    fixed: Vec<Column>,
    /// Penalty of each of them.
    penalty: Vec<f64>,
    /// Half the slope of the penalty at the point.
    pull: Vec<f64>,
    /// For each candidate its columns.
    added: Vec<Vec<Column>>,
    /// Readings a session.
    pub readings: Vec<usize>,
}

/// A model with some candidates added, on weighted sessions, ready to be asked about others.
pub struct Stand<'a> {
    linear: &'a Linear,
    weights: Vec<f64>,
    columns: Vec<Column>,
    factor: Cholesky,
    /// L^-1 X'r
    reduced: Vec<f64>,
    /// Sum of squares that is left.
    pub left: f64,
}

/// What a candidate would do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Fall of the sum of squares, N^2.
    pub fall: f64,
    /// Share of the trace that the refit does not swallow.
    pub visible: f64,
    /// First amplitude.
    pub amplitude: f64,
    /// Amplitudes that are determined.
    pub parameters: usize,
}

/// What the readings say of an amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Information {
    /// Share of the trace that the refit does not swallow.
    pub visible: f64,
    /// Square of what is left of the trace, N^2 by unit of the amplitude squared.
    pub left: f64,
}

impl Linear {
    /// The sums at a fitted point, for strengths that scatter by `scatter`.
    pub fn new(model: &Model, fitted: &Fitted, scatter: f64, candidates: &[Term]) -> Self {
        let data = model.data;
        let n = data.len();
        let mut directions: Vec<Vec<f64>> = Vec::new();
        let (fixed, penalty, pull) = fixed_columns(model, fitted, scatter, &mut directions);
        let added = added_columns(model, fitted, candidates, &mut directions);
        directions.push(fitted.residuals.clone());
        let width = directions.len();
        let mut readings = vec![0; data.sessions.len()];
        let mut places: Vec<Vec<usize>> = vec![Vec::new(); data.sessions.len()];
        for i in 0..n {
            readings[data.session[i]] += 1;
            places[data.session[i]].push(i);
        }
        let moments = places
            .iter()
            .map(|places| {
                let picked: Vec<Vec<f64>> = directions
                    .iter()
                    .map(|d| places.iter().map(|&i| d[i]).collect())
                    .collect();
                let mut m = Matrix::zeros(width, width);
                for a in 0..width {
                    for b in 0..=a {
                        let product = dot(&picked[a], &picked[b]);
                        m[(a, b)] = product;
                        m[(b, a)] = product;
                    }
                }
                m
            })
            .collect();
        Self {
            moments,
            width,
            fixed,
            penalty,
            pull,
            added,
            readings,
        }
    }

    fn product(&self, weights: &[f64], a: &Column, b: &Column) -> f64 {
        let acting =
            (0..weights.len()).filter(|s| weights[*s] != 0.0 && a.sessions[*s] && b.sessions[*s]);
        acting
            .map(|s| weights[s] * self.moments[s][(a.direction, b.direction)])
            .sum()
    }

    fn with_residual(&self, weights: &[f64], a: &Column) -> f64 {
        let acting = (0..weights.len()).filter(|s| weights[*s] != 0.0 && a.sessions[*s]);
        acting
            .map(|s| weights[s] * self.moments[s][(a.direction, self.width - 1)])
            .sum()
    }

    /// The model with the candidates `chosen`, every session with a weight.
    pub fn stand(&self, weights: &[f64], chosen: &[usize]) -> Stand<'_> {
        let mut columns: Vec<Column> = self.fixed.clone();
        for c in chosen {
            columns.extend(self.added[*c].iter().cloned());
        }
        let p = columns.len();
        let mut gram = Matrix::zeros(p, p);
        for a in 0..p {
            for b in 0..=a {
                gram[(a, b)] = self.product(weights, &columns[a], &columns[b]);
                gram[(b, a)] = gram[(a, b)];
            }
        }
        let mut right: Vec<f64> = columns
            .iter()
            .map(|c| self.with_residual(weights, c))
            .collect();
        for k in 0..self.fixed.len() {
            gram[(k, k)] += self.penalty[k];
            right[k] -= self.pull[k];
        }
        let factor = Cholesky::new(&gram);
        let reduced = factor.forward(&right);
        let last = self.width - 1;
        let all: f64 = (0..weights.len())
            .map(|s| weights[s] * self.moments[s][(last, last)])
            .sum();
        let left = all - reduced.iter().map(|x| x * x).sum::<f64>();
        Stand {
            linear: self,
            weights: weights.to_vec(),
            columns,
            factor,
            reduced,
            left,
        }
    }

    /// Every session once.
    pub fn all_sessions(&self) -> Vec<f64> {
        vec![1.0; self.moments.len()]
    }
}

/// The columns of what is refitted anyway, with their penalties and half the slopes of these; disjoint columns (strengths, amplitudes)
/// share a direction.
fn fixed_columns(
    model: &Model,
    fitted: &Fitted,
    scatter: f64,
    directions: &mut Vec<Vec<f64>>,
) -> (Vec<Column>, Vec<f64>, Vec<f64>) {
    let of_session = model.data.specimen_of_session();
    let sessions = model.data.sessions.len();
    let ratio = (fitted.sigma / scatter) * (fitted.sigma / scatter);
    let mut place_of_slot: Vec<Option<usize>> = vec![None; fitted.traces.len()];
    let (mut fixed, mut penalty, mut pull) = (Vec::new(), Vec::new(), Vec::new());
    for place in model.layout() {
        let slots: Vec<Option<usize>> = (0..sessions)
            .map(|s| model.slot(place, s, of_session[s]))
            .collect();
        let Some(slot) = slots.iter().flatten().next().copied() else {
            continue;
        };
        let direction = *place_of_slot[slot].get_or_insert_with(|| {
            directions.push(fitted.traces[slot].clone());
            directions.len() - 1
        });
        fixed.push(Column {
            direction,
            sessions: slots.iter().map(Option::is_some).collect(),
        });
        let strength = match place {
            Place::Strength(k) => Some(fitted.strengths[k]),
            _ => None,
        };
        penalty.push(strength.map_or(0.0, |_| ratio));
        pull.push(strength.map_or(0.0, |u| ratio * u));
    }
    (fixed, penalty, pull)
}

/// The columns of the candidates; those of one effect share a direction whatever they act on.
fn added_columns(
    model: &Model,
    fitted: &Fitted,
    candidates: &[Term],
    directions: &mut Vec<Vec<f64>>,
) -> Vec<Vec<Column>> {
    let sessions = model.data.sessions.len();
    let mut traces: Vec<(What, Vec<usize>)> = Vec::new();
    for candidate in candidates {
        if !traces.iter().any(|(w, _)| same(w, &candidate.what)) {
            traces.push((candidate.what, Vec::new()));
        }
    }
    for (what, places) in &mut traces {
        for trace in trace(model, fitted, *what) {
            places.push(directions.len());
            directions.push(trace);
        }
    }
    candidates
        .iter()
        .map(|candidate| {
            let places = traces
                .iter()
                .find(|(w, _)| same(w, &candidate.what))
                .map_or(&[][..], |(_, p)| p);
            let groups = 0..candidate.amplitudes;
            groups
                .flat_map(|g| {
                    let acting: Vec<bool> = (0..sessions)
                        .map(|s| candidate.acts_on[s] == Some(g))
                        .collect();
                    places.iter().map(move |d| Column {
                        direction: *d,
                        sessions: acting.clone(),
                    })
                })
                .collect()
        })
        .collect()
}

/// Equality that holds for shapes that are no numbers.
fn same(a: &What, b: &What) -> bool {
    match (a, b) {
        (
            What::Effect {
                effect,
                form,
                shape,
            },
            What::Effect {
                effect: e,
                form: f,
                shape: s,
            },
        ) => effect == e && form == f && shape.to_bits() == s.to_bits(),
        _ => a == b,
    }
}

/// What an amplitude of one adds to the force of every reading, to first order: one column, or two for a polynomial.
fn trace(model: &Model, fitted: &Fitted, what: What) -> Vec<Vec<f64>> {
    let data = model.data;
    let base: Vec<D> = fitted.base.iter().map(|c| D::constant(*c)).collect();
    let columns = if matches!(what, What::Effect { .. }) {
        1
    } else {
        2
    };
    let mut out = vec![Vec::with_capacity(data.len()); columns];
    for i in 0..data.len() {
        let session = data.session[i];
        let strength = D::constant(1.0 + fitted.strengths[data.specimen[i]]);
        let mut applied: Vec<Applied<D>> = Vec::new();
        let mut empirical = Vec::new();
        for (term, (amplitudes, second)) in model.terms.iter().zip(&fitted.terms) {
            let Some(g) = term.acts_on[session] else {
                continue;
            };
            let parameters = [D::constant(amplitudes[g]), D::constant(*second)];
            match term.what {
                What::Empirical(e) => empirical.push((e, parameters)),
                What::Effect { .. } => applied.extend(term.applied(parameters)),
            }
        }
        match what {
            What::Effect {
                effect,
                form,
                shape,
            } => applied.push(Applied {
                effect,
                form,
                parameters: [
                    D::variable(effects::all()[effect].near(), 0),
                    D::constant(shape),
                ],
            }),
            What::Empirical(e) => empirical.push((e, [D::variable(0.0, 0), D::variable(0.0, 1)])),
        }
        let pulled = effects::force(model.base, &base, strength, &applied, &data.conditions[i]);
        let shown = empirical
            .iter()
            .fold(pulled, |f, (e, p)| e.apply(f, *p, data, i));
        for (k, column) in out.iter_mut().enumerate() {
            column.push(shown.gradient[k]);
        }
    }
    out
}

impl Stand<'_> {
    /// L^-1 X'c of a column, and its own square.
    fn against(&self, column: &Column) -> (Vec<f64>, f64) {
        let right: Vec<f64> = self
            .columns
            .iter()
            .map(|c| self.linear.product(&self.weights, c, column))
            .collect();
        (
            self.factor.forward(&right),
            self.linear.product(&self.weights, column, column),
        )
    }

    /// What a candidate would do to the sum of squares.
    pub fn gain(&self, candidate: usize) -> Gain {
        let columns = &self.linear.added[candidate];
        let reduced: Vec<(Vec<f64>, f64)> = columns.iter().map(|c| self.against(c)).collect();
        let m = columns.len();
        let mut gram = Matrix::zeros(m, m);
        let mut right = vec![0.0; m];
        let (mut visible, mut parameters) = (0.0_f64, 0);
        for a in 0..m {
            let own = dot(&reduced[a].0, &reduced[a].0);
            let left = (reduced[a].1 - own).max(0.0);
            let share = if reduced[a].1 > 0.0 {
                (left / reduced[a].1).sqrt()
            } else {
                0.0
            };
            visible = visible.max(share);
            if share < BLIND {
                gram[(a, a)] = 1.0;
                continue;
            }
            parameters += 1;
            right[a] = self.linear.with_residual(&self.weights, &columns[a])
                - dot(&reduced[a].0, &self.reduced);
            gram[(a, a)] = left;
            for b in 0..a {
                if gram[(b, b)] != 1.0 || right[b] != 0.0 {
                    let cross = self.linear.product(&self.weights, &columns[a], &columns[b])
                        - dot(&reduced[a].0, &reduced[b].0);
                    gram[(a, b)] = cross;
                    gram[(b, a)] = cross;
                }
            }
        }
        let factor = Cholesky::new(&gram);
        let z = factor.forward(&right);
        let solution = factor.backward(&z);
        Gain {
            fall: z.iter().map(|x| x * x).sum(),
            visible,
            amplitude: solution.first().copied().unwrap_or(0.0),
            parameters,
        }
    }

    /// What the readings say of a candidate's first amplitude.
    pub fn information(&self, candidate: usize) -> Information {
        let Some(column) = self.linear.added[candidate].first() else {
            return Information {
                visible: 0.0,
                left: 0.0,
            };
        };
        let (reduced, own) = self.against(column);
        let left = (own - dot(&reduced, &reduced)).max(0.0);
        Information {
            visible: if own > 0.0 { (left / own).sqrt() } else { 0.0 },
            left,
        }
    }

    /// Cosine between what is left of two candidates after the refit: of their first columns.
    pub fn cosine(&self, a: usize, b: usize) -> f64 {
        let (Some(ca), Some(cb)) = (self.linear.added[a].first(), self.linear.added[b].first())
        else {
            return 0.0;
        };
        let (ra, aa) = self.against(ca);
        let (rb, bb) = self.against(cb);
        let left = |own: f64, r: &[f64]| (own - dot(r, r)).max(0.0);
        let cross = self.linear.product(&self.weights, ca, cb) - dot(&ra, &rb);
        let norm = (left(aa, &ra) * left(bb, &rb)).sqrt();
        if norm > 0.0 { cross / norm } else { 0.0 }
    }

    /// What each session says of a candidate's first amplitude: information d~.d~ and d~.r, strengths and coefficients as refitted.
    pub fn by_session(&self, candidate: usize) -> Vec<(f64, f64)> {
        let Some(column) = self.linear.added[candidate].first() else {
            return Vec::new();
        };
        let (reduced, _) = self.against(column);
        let gamma = self.factor.backward(&reduced);
        let beta = self.factor.backward(&self.reduced);
        let last = self.linear.width - 1;
        (0..self.weights.len())
            .map(|s| {
                let m = &self.linear.moments[s];
                // The projection of the candidate and the residual after the refit, as combinations of directions.
                let mut d: Vec<(usize, f64)> = self
                    .columns
                    .iter()
                    .zip(&gamma)
                    .filter(|(c, _)| c.sessions[s])
                    .map(|(c, g)| (c.direction, -g))
                    .collect();
                if column.sessions[s] {
                    d.push((column.direction, 1.0));
                }
                let mut r: Vec<(usize, f64)> = self
                    .columns
                    .iter()
                    .zip(&beta)
                    .filter(|(c, _)| c.sessions[s])
                    .map(|(c, b)| (c.direction, -b))
                    .collect();
                r.push((last, 1.0));
                let product = |x: &[(usize, f64)], y: &[(usize, f64)]| -> f64 {
                    x.iter()
                        .flat_map(|(i, a)| y.iter().map(move |(j, b)| a * b * m[(*i, *j)]))
                        .sum()
                };
                (product(&d, &d), product(&d, &r))
            })
            .collect()
    }
}

/// A trace of which less than this is visible is none.
pub const BLIND: f64 = 0.05;
