//! What each term of the library would change: columns at small amplitudes and at large ones, starts that are far off, bends.

use super::ForceProblem;
use super::misfit::LawSpan;
use crate::bent::Bent;
use crate::library::{Column, Scope, Term, What};
use crate::settings;
use crate::smooth::cosines;
use pipeline_effects as effects;
use pipeline_inference::problem::{Direction, Point, Problem};
use rayon::prelude::*;

/// Changes of the force, as shares of its root mean square, at which an effect that enters nonlinearly is looked at again; no larger than
/// four fifths of its bounds. A sharp threshold has an optimum between any two pressures that were set: with two shares one of 150 kPa was missed.
pub const LARGE_CHANGES: [f64; 3] = [0.08, 0.24, 0.72];

/// Cosine above which two amplitudes of one effect show alike.
pub const SAME_DIRECTION: f64 = 0.98;

impl ForceProblem<'_> {
    /// Starts of the terms at amplitudes where their tangents do not tell what they do.
    pub(super) fn far_starts(&self, point: &Point) -> Vec<(usize, Vec<f64>)> {
        let Some(span) = self.law_span() else {
            return Vec::new();
        };
        let base = self.predict(point);
        let is_whole = |t: &usize| {
            let term = &self.library[*t];
            term.scope == Scope::All && term.id().is_some() && term.amplitudes == 1
        };
        let known = |t: &usize| point.terms.iter().any(|(u, _)| u == t);
        let terms: Vec<usize> = (0..self.library.len())
            .filter(|t| is_whole(t) && !known(t))
            .collect();
        let starts = terms.into_par_iter().flat_map_iter(|t| {
            let far = self.far_amplitudes(point, &base, t, &span);
            let start = move |a: f64| (t, self.library[t].start(a));
            far.into_iter().map(start)
        });
        starts.collect()
    }

    /// Columns by which the size of a term in the model may bend along its own argument.
    pub(super) fn bent_columns(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        let linear = self.linearise(point);
        if let What::Column(column) = self.library[term].what {
            return self.curved_columns(column, &linear.predicted);
        }
        let mut place = 0;
        for (t, values) in &point.terms {
            let of_term = &linear.by_terms[place..place + values.len()];
            place += values.len();
            if *t == term {
                let amplitudes = values.iter().take(self.library[term].amplitudes);
                let columns = of_term.iter().map(Vec::as_slice);
                let by_amplitudes: Vec<(f64, &[f64])> = amplitudes.copied().zip(columns).collect();
                let bent = Bent::new(
                    &self.library[term],
                    &self.data.conditions,
                    &by_amplitudes,
                    &linear.predicted,
                    |_| true,
                );
                return bent.map_or_else(Vec::new, |b| b.columns);
            }
        }
        Vec::new()
    }

    /// Columns of what a dependence on a logged column may be beside a polynomial of second degree: a smooth function of it, times the force or by itself.
    fn curved_columns(&self, column: Column, predicted: &[f64]) -> Vec<Vec<f64>> {
        let (Column::Gain(k) | Column::Offset(k)) = column else {
            return Vec::new();
        };
        let along = &self.data.extras[k].values;
        let low = along.iter().copied().fold(f64::INFINITY, f64::min);
        let high = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut columns = vec![vec![0.0; predicted.len()]; settings::COLUMN_COSINES - 1];
        for (i, x) in along.iter().enumerate() {
            let share = (x - low) / (high - low);
            let basis = cosines(settings::COLUMN_COSINES, share, settings::COLUMN_LENGTH);
            let size = if column.is_gain() { predicted[i] } else { 1.0 };
            for (of, c) in columns.iter_mut().zip(&basis[1..]) {
                of[i] = size * c;
            }
        }
        columns
    }

    /// Columns by which the size of a term that acts on parts of the sessions may scatter among sessions: the operator with a value for each of them.
    pub(super) fn scattered_columns(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        let of = &self.library[term];
        if of.scope == Scope::All {
            return Vec::new();
        }
        let mut without = point.clone();
        without.terms.retain(|(t, _)| *t != term);
        let base = self.predict(&without);
        let whole = self.library.iter().position(|t| same(t, of.what));
        let directions = whole.map_or_else(Vec::new, |t| self.whole_directions(&without, &base, t));
        let Some(column) = directions.first().and_then(|d| d.columns.first()) else {
            return Vec::new();
        };
        let sessions = 0..self.data.sessions.len();
        let of_session = |s: usize| {
            let readings = column.iter().enumerate();
            readings
                .map(|(i, x)| {
                    if self.data.session.get(i) == Some(&s) {
                        *x
                    } else {
                        0.0
                    }
                })
                .collect()
        };
        sessions.map(of_session).collect()
    }

    /// Changes of the force by every term that is not in the model.
    pub(super) fn directions_beside(&self, point: &Point) -> Vec<Direction> {
        let base = self.predict(point);
        let mut whole: Vec<(What, Vec<Direction>)> = Vec::new();
        for (t, term) in self.library.iter().enumerate() {
            if term.scope == Scope::All && !point.terms.iter().any(|(u, _)| *u == t) {
                whole.push((term.what, Vec::new()));
            }
        }
        whole.par_iter_mut().for_each(|(what, directions)| {
            let t = self
                .library
                .iter()
                .position(|t| t.scope == Scope::All && t.what == *what || same(t, *what));
            if let Some(t) = t {
                *directions = self.whole_directions(point, &base, t);
            }
        });
        let mut all = Vec::new();
        for (t, term) in self.library.iter().enumerate() {
            if point.terms.iter().any(|(u, _)| *u == t) {
                continue;
            }
            let found = whole.iter().find(|(what, _)| same(term, *what));
            for direction in found.map_or(&[][..], |(_, d)| d) {
                all.push(self.masked(t, term, direction));
            }
        }
        all
    }

    /// Changes of the force by a term on all readings, per unit of its amplitude: at a small amplitude, and at one that changes the force
    /// visibly, where that has another form.
    fn whole_directions(&self, point: &Point, base: &[f64], t: usize) -> Vec<Direction> {
        let term = &self.library[t];
        if let What::Column(_) = term.what {
            let columns = (0..2).map(|k| {
                let mut values = vec![0.0; 2];
                values[k] = 1e-3;
                self.change(point, base, t, &values, 1e-3)
            });
            return vec![Direction {
                term: t,
                start: vec![1.0; 2],
                columns: columns.collect(),
            }];
        }
        let mut directions: Vec<Direction> = Vec::new();
        for amplitude in self.amplitudes(point, base, t, &LARGE_CHANGES[..1]) {
            let change = self.change(point, base, t, &term.start(amplitude), amplitude);
            let alike = |d: &Direction| cosine(&d.columns[0], &change) >= SAME_DIRECTION;
            if !directions.iter().any(alike) {
                directions.push(Direction {
                    term: t,
                    start: term.start(1.0),
                    columns: vec![change],
                });
            }
        }
        directions
    }

    /// Amplitudes at which a term with one is looked at: a small one, and those that change the force by such shares, of either sign.
    fn amplitudes(&self, point: &Point, base: &[f64], t: usize, shares: &[f64]) -> Vec<f64> {
        let term = &self.library[t];
        let (low, high) = self.terms[t].bounds[0];
        let near = term
            .id()
            .and_then(effects::index)
            .map_or(0.0, |e| effects::all()[e].near());
        let small = if near == 0.0 { 1e-4 * high } else { near };
        let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).sqrt();
        let change = rms(&self.change(point, base, t, &term.start(small), small));
        let mut all = vec![small];
        if change > 0.0 && change.is_finite() {
            for share in shares {
                let large = (share * rms(base) / change).min(0.8 * high);
                all.push(large);
                if low < 0.0 {
                    all.push((-large).max(0.8 * low));
                }
            }
        }
        all
    }

    /// Amplitudes of a term at which what the law leaves of its change has another form than at a small one.
    fn far_amplitudes(&self, point: &Point, base: &[f64], t: usize, span: &LawSpan) -> Vec<f64> {
        let term = &self.library[t];
        let left = |amplitude: f64| {
            let change = self.change(point, base, t, &term.start(amplitude), amplitude);
            span.left_of_forces(&change)
        };
        let amplitudes = self.amplitudes(point, base, t, &LARGE_CHANGES);
        let near = left(amplitudes[0]);
        let mut far = amplitudes[1..].to_vec();
        far.retain(|a| cosine(&near, &left(*a)) < SAME_DIRECTION);
        far
    }

    /// The change of the force by a term on all readings at a size, per unit of it.
    pub fn direction_at(&self, point: &Point, t: usize, amplitude: f64) -> Direction {
        let term = &self.library[t];
        let base = self.predict(point);
        Direction {
            term: t,
            start: term.start(1.0),
            columns: vec![self.change(point, &base, t, &term.of_size(amplitude), amplitude)],
        }
    }

    fn change(&self, point: &Point, base: &[f64], t: usize, values: &[f64], unit: f64) -> Vec<f64> {
        let mut with = point.clone();
        with.terms.push((t, values.to_vec()));
        let predicted = self.predict(&with);
        predicted
            .iter()
            .zip(base)
            .map(|(a, b)| (a - b) / unit)
            .collect()
    }

    /// The direction of a term that acts on a part of the sessions, from that on all readings.
    fn masked(&self, t: usize, term: &Term, whole: &Direction) -> Direction {
        if term.scope == Scope::All {
            return Direction {
                term: t,
                ..whole.clone()
            };
        }
        let columns = (0..term.amplitudes).map(|g| {
            let session = |i: usize| self.data.session.get(i);
            let acts = |i: usize| session(i).is_some_and(|s| term.acts_on[*s] == Some(g));
            let column = whole.columns[0].iter().enumerate();
            column
                .map(|(i, x)| if acts(i) { *x } else { 0.0 })
                .collect()
        });
        Direction {
            term: t,
            start: term.start(1.0),
            columns: columns.collect(),
        }
    }
}

/// Whether a term is of this form (shapes are compared as bits: not a number where there is none).
fn same(term: &Term, what: What) -> bool {
    match (term.what, what) {
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
        (a, b) => a == b,
    }
}

/// Cosine of the angle between two columns; 1 where one of them is nothing.
pub fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let norms = (dot(a, a) * dot(b, b)).sqrt();
    if norms > 0.0 { dot(a, b) / norms } else { 1.0 }
}
