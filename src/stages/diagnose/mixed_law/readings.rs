//! Readings of a muscle: the mode of everything that is not known given them, and the inverse of its covariance there.
//!
//! Readings are linear in what is not known about a point; Gauss-Newton steps lead to the mode, halved where they do not lower the penalised sum of
//! squares, where the normal matrix is the inverse of the covariance. [`pipeline_inference::heldout`] does the same with the readings of the fit at hand.

use super::muscle::{Muscle, identity};
use super::view::{OF_SESSION, OF_STROKE, Reading, View};
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::{Matrix, dot};
use pipeline_numerics::statistics::sum_of_squares;
use std::collections::BTreeMap;

/// Most steps to the mode.
const MOST_STEPS: usize = 20;
/// A step by which the penalised sum of squares falls by less is the last.
const SETTLED: f64 = 1e-6;
/// Shortest part of a step that is tried.
const SHORTEST: f64 = 1e-3;

/// The readings, and where each of them is.
pub(super) struct Read<'r> {
    pub(super) readings: Vec<Reading>,
    pub(super) force_n: &'r [f64],
    pub(super) session: Vec<usize>,
    pub(super) stroke: Vec<usize>,
    pub(super) sessions: usize,
    pub(super) strokes: usize,
}

/// A point with the views of the readings there, and what it costs.
struct Stand {
    mean: Vec<f64>,
    views: Vec<View>,
    value: f64,
}

impl Muscle<'_> {
    /// The views of the readings about a point.
    fn views(&self, mean: &[f64], read: &Read) -> Vec<View> {
        let of = |(reading, session): (&Reading, &usize)| {
            let own = self.own(mean, Some(*session), reading.lengths());
            self.law.view(&self.base, reading, own)
        };
        read.readings.iter().zip(&read.session).map(of).collect()
    }

    fn rows(&self, views: &[View], read: &Read) -> Vec<Vec<(usize, f64)>> {
        let of = |(i, view): (usize, &View)| {
            self.row(view, Some((read.session[i], read.stroke[i])), read.sessions)
        };
        views.iter().enumerate().map(of).collect()
    }

    /// Measured less what a point has, at views that were taken about another: gain, contracted and set length and zero act through the forward model,
    /// all else by its columns.
    fn beside(&self, mean: &[f64], views: &[View], there: &[View], read: &Read) -> Vec<f64> {
        let rows = self.rows(views, read);
        let nonlinear = |place: usize| {
            let of_session = place.checked_sub(self.of_session(0));
            let of_session = of_session.filter(|k| *k < OF_SESSION * read.sessions);
            self.is_nonlinear(place) || of_session.is_some_and(|k| k % OF_SESSION < 2)
        };
        let of = |(i, row): (usize, &Vec<(usize, f64)>)| {
            let linear = row.iter().filter(|(k, _)| !nonlinear(*k));
            let linear: f64 = linear.map(|(k, x)| x * mean[*k]).sum();
            read.force_n[i] - there[i].force_n - there[i].shown_n - linear
        };
        rows.iter().enumerate().map(of).collect()
    }

    fn stand(&self, mean: Vec<f64>, about: Option<&[View]>, read: &Read) -> Stand {
        let views = self.views(&mean, read);
        let left = self.beside(&mean, about.unwrap_or(&views), &views, read);
        let deviates = left.iter().zip(&views).map(|(l, v)| l / v.noise_n);
        let value = deviates.map(|d| d * d).sum::<f64>() + sum_of_squares(&mean);
        Stand { mean, views, value }
    }

    /// Posterior mode, and the factor of its inverse covariance. Two starts: the prior mean, and the mode with all misfits held at 0; from the prior mean
    /// alone, a length that is off by millimetres is so far from linear that the misfit takes its place.
    pub(super) fn condition(&mut self, read: &Read) {
        let size = self.of_session(read.sessions) + OF_STROKE * read.strokes;
        let nothing = vec![0.0; size];
        let stays = |place: usize, misfit: bool| {
            let in_law = self.in_law && place < self.first_own();
            in_law || (!misfit && self.is_misfit(place, read))
        };
        let all = |place: usize| !stays(place, true);
        let calibrating = |place: usize| !stays(place, false);
        let from_nothing = self.descend(nothing.clone(), &all, read);
        let led = self.descend(nothing, &calibrating, read);
        let led = self.descend(led.mean, &all, read);
        let best = if led.value < from_nothing.value {
            led
        } else {
            from_nothing
        };
        let left = self.beside(&best.mean, &best.views, &best.views, read);
        let deviates = left.iter().zip(&best.views).map(|(l, v)| l / v.noise_n);
        let squares: f64 = deviates.map(|d| d * d).sum();
        self.left = (squares / left.len().max(1) as f64).sqrt();
        let normal = self.normal(&best, read);
        let factor = Cholesky::new(&self.joint(normal));
        self.mean = best.mean;
        self.factor = factor;
    }

    fn is_misfit(&self, place: usize, read: &Read) -> bool {
        let Some(k) = place.checked_sub(self.of_session(0)) else {
            return false;
        };
        k >= OF_SESSION * read.sessions || k % OF_SESSION >= 2
    }

    /// Gauss-Newton steps over the places that are open.
    fn descend(&self, from: Vec<f64>, open: &dyn Fn(usize) -> bool, read: &Read) -> Stand {
        let mut here = self.stand(from, None, read);
        for _ in 0..MOST_STEPS {
            let Some(next) = self.step(&here, open, read) else {
                break;
            };
            // Judged with its own columns from now on.
            let fall = here.value - next.value;
            here = self.stand(next.mean, None, read);
            if fall < SETTLED {
                break;
            }
        }
        here
    }

    fn step(&self, here: &Stand, open: &dyn Fn(usize) -> bool, read: &Read) -> Option<Stand> {
        let size = here.mean.len();
        let places: Vec<usize> = (0..size).filter(|k| open(*k)).collect();
        let number: BTreeMap<usize, usize> =
            places.iter().enumerate().map(|(n, k)| (*k, n)).collect();
        let mut normal = identity(places.len());
        let mut right: Vec<f64> = places.iter().map(|k| -here.mean[*k]).collect();
        let left = self.beside(&here.mean, &here.views, &here.views, read);
        for (i, row) in self.rows(&here.views, read).iter().enumerate() {
            let weight = weight_of(&here.views[i]);
            let row: Vec<(usize, f64)> = row
                .iter()
                .filter_map(|(k, x)| Some((*number.get(k)?, *x)))
                .collect();
            add(&mut normal, &row, weight);
            row.iter()
                .for_each(|(k, x)| right[*k] += weight * x * left[i]);
        }
        let step = Cholesky::new(&normal).solve(&right);
        let mut length = 1.0;
        while length >= SHORTEST {
            let mut mean = here.mean.clone();
            places
                .iter()
                .zip(&step)
                .for_each(|(k, s)| mean[*k] += length * s);
            let next = self.stand(mean, Some(&here.views), read);
            if next.value < here.value {
                return Some(next);
            }
            length *= 0.5;
        }
        None
    }

    /// I + X' X / sigma^2 at a point.
    fn normal(&self, at: &Stand, read: &Read) -> Matrix {
        let mut normal = identity(at.mean.len());
        for (row, view) in self.rows(&at.views, read).iter().zip(&at.views) {
            add(&mut normal, row, weight_of(view));
        }
        normal
    }

    /// The normal matrix of the joint distribution: where the readings told of the parameters before, such that these keep theirs.
    fn joint(&self, mut normal: Matrix) -> Matrix {
        if !self.in_law {
            return normal;
        }
        let (m, n) = (self.first_own(), normal.rows());
        let mut own = Matrix::zeros(n - m, n - m);
        for j in m..n {
            own.column_mut(j - m)
                .copy_from_slice(&normal.column(j)[m..]);
        }
        let factor = Cholesky::new(&own);
        // J_uu = I + J_ub J_bb^-1 J_bu, so that the parameters' own covariance is I.
        let columns: Vec<Vec<f64>> = (0..m)
            .map(|j| factor.forward(&normal.column(j)[m..]))
            .collect();
        for j in 0..m {
            for i in 0..m {
                let one = f64::from(u8::from(i == j));
                normal.column_mut(j)[i] = one + dot(&columns[i], &columns[j]);
            }
        }
        normal
    }
}

fn weight_of(view: &View) -> f64 {
    1.0 / (view.noise_n * view.noise_n)
}

/// Adds the products of a row.
fn add(normal: &mut Matrix, row: &[(usize, f64)], weight: f64) {
    for (j, x) in row {
        let column = normal.column_mut(*j);
        row.iter().for_each(|(i, y)| column[*i] += weight * x * y);
    }
}
