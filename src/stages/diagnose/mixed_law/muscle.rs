//! A muscle: without readings, or with some, which tell of its gain, its lengths, the lengths that were set, and of the law.
//!
//! Everything that is not known is one vector of independent standard normal numbers: parameters, gain and zero of a campaign of its own, gain and
//! lengths of the muscle, and for each session that was read its set length, zero and misfit, for each stroke its own. Readings are linear in them
//! about a point; Gauss-Newton steps lead to the mode, where the normal matrix is the inverse of their covariance (K. Levenberg's halving where a step
//! does not lower the penalised sum of squares).
//!
//! Readings that the law was made of do not tell of the parameters again: their joint distribution with what is the muscle's own has the
//! parameters' as it is.

use super::MixedLaw;
use super::parts::{Forecast, Parts};
use super::view::{OF_SESSION, OF_STROKE, Own, Reading, View, Whose};
use crate::base::Base;
use crate::data::{Data, specimen_id};
use pipeline_base::row::Row;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::distributions::normal_cdf;
use pipeline_numerics::matrix::{Matrix, dot};
use pipeline_numerics::statistics::sum_of_squares;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Most readings of one session that are used: neighbours of a log say the same.
const MOST_READINGS: usize = 40;
/// Most steps to the mode.
const MOST_STEPS: usize = 20;
/// A step by which the penalised sum of squares falls by less is the last.
const SETTLED: f64 = 1e-6;
/// Shortest part of a step that is tried.
const SHORTEST: f64 = 1e-3;

/// What the readings say of one number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Session, of set lengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub session: Option<String>,
    /// Posterior mean.
    pub value: f64,
    /// Posterior standard deviation.
    pub sd: f64,
    /// Standard deviation before any reading.
    pub sd_before: f64,
}

/// What a further reading would be worth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Next {
    /// Contraction.
    pub contraction: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// Standard deviation of the force asked for, before and after it, N.
    pub sd_before_n: f64,
    /// See `sd_before_n`.
    pub sd_after_n: f64,
}

/// A muscle under the law.
#[derive(Clone)]
pub struct Muscle<'a> {
    /// The law.
    pub law: &'a MixedLaw,
    base: Arc<Base>,
    campaign: Option<usize>,
    /// How well its length is known where its force is asked for, mm; none as the rig sets it.
    length_sd_mm: Option<f64>,
    sessions: Vec<String>,
    readings: usize,
    /// Whether the readings are some that the law was made of.
    in_law: bool,
    /// Mean of what is not known, in standard deviations.
    mean: Vec<f64>,
    /// Factor of the inverse of its covariance.
    factor: Cholesky,
}

/// The readings, and where each of them is.
struct Read<'r> {
    readings: Vec<Reading>,
    force_n: &'r [f64],
    session: Vec<usize>,
    stroke: Vec<usize>,
    sessions: usize,
    strokes: usize,
}

/// A point with the views of the readings there, and what it costs.
struct Stand {
    mean: Vec<f64>,
    views: Vec<View>,
    value: f64,
}

impl<'a> Muscle<'a> {
    /// A muscle of which nothing is known.
    pub fn unread(law: &'a MixedLaw) -> Self {
        let size = law.parameters() + OWN;
        Self {
            law,
            base: Arc::new(law.base()),
            campaign: None,
            length_sd_mm: None,
            sessions: Vec::new(),
            readings: 0,
            in_law: false,
            mean: vec![0.0; size],
            factor: Cholesky::new(&identity(size)),
        }
    }

    /// A muscle of which there are readings, all of it; not of one session more than [`MOST_READINGS`] of them.
    pub fn read(law: &'a MixedLaw, rows: &[&Row]) -> Self {
        let mut muscle = Self::unread(law);
        let Some(first) = rows.first() else {
            return muscle;
        };
        let data = Data::counted_from(rows, &law.origins);
        let most = MOST_READINGS * data.sessions.len();
        let data = data.thinned(most);
        let id = specimen_id(first, law.is_pooled());
        let read = Read {
            readings: law.readings(&data, rows),
            force_n: &data.force,
            session: data.session.clone(),
            stroke: data.strokes(),
            sessions: data.sessions.len(),
            strokes: data.strokes().into_iter().max().map_or(0, |k| k + 1),
        };
        muscle.campaign = read.readings.first().and_then(|r| r.campaign);
        muscle.readings = rows.len();
        muscle.in_law = law.specimens.contains(&id);
        muscle.sessions.clone_from(&data.sessions);
        muscle.condition(&read);
        muscle
    }

    /// The same muscle as if nobody had read it.
    pub fn without_readings(&self) -> Self {
        Self {
            length_sd_mm: self.length_sd_mm,
            ..Self::unread(self.law)
        }
    }

    /// The same where its length is known to this standard deviation, mm.
    pub fn with_length_sd(mut self, sd_mm: f64) -> Self {
        self.length_sd_mm = Some(sd_mm);
        self
    }

    /// Number of readings that were given, and of their sessions.
    pub fn count(&self) -> (usize, usize) {
        (self.readings, self.sessions.len())
    }

    /// Number of other specimens on which the law rests.
    pub fn others(&self) -> usize {
        self.law.specimens.len() - usize::from(self.in_law)
    }

    /// Whether its readings are some that the law was made of.
    pub fn is_in_law(&self) -> bool {
        self.in_law
    }

    fn first_own(&self) -> usize {
        self.law.parameters()
    }

    fn of_session(&self, session: usize) -> usize {
        self.first_own() + OWN + OF_SESSION * session
    }

    fn own(&self, mean: &[f64], session: Option<usize>) -> Own {
        let sd = &self.law.sd;
        let first = self.first_own();
        let of = |k: usize| session.map_or(0.0, |s| mean[self.of_session(s) + k]);
        Own {
            gain: sd.gain * mean[first + GAIN],
            campaign_gain: sd.campaign_gain * mean[first],
            length_mm: of(0),
            zero_n: sd.zero_n * of(1) + sd.campaign_zero_n * mean[first + 1],
        }
    }

    /// The views of the readings about a point.
    fn views(&self, mean: &[f64], read: &Read) -> Vec<View> {
        let of = |(reading, session): (&Reading, &usize)| {
            let mut own = self.own(mean, Some(*session));
            own.length_mm *= reading.set_length_mm();
            self.law.view(&self.base, reading, own)
        };
        read.readings.iter().zip(&read.session).map(of).collect()
    }

    /// The columns of a reading: (place, value) of those that are not 0 by construction.
    fn row(
        &self,
        view: &View,
        place: Option<(usize, usize)>,
        sessions: usize,
    ) -> Vec<(usize, f64)> {
        let first = self.first_own();
        let mut row: Vec<(usize, f64)> = view.parameters.iter().copied().enumerate().collect();
        let own = view.campaign.iter().chain(&view.specimen).copied();
        row.extend(own.enumerate().map(|(k, x)| (first + k, x)));
        if let Some((session, stroke)) = place {
            let of = self.of_session(session);
            row.extend(view.session.iter().enumerate().map(|(k, x)| (of + k, *x)));
            let of = self.of_session(sessions) + OF_STROKE * stroke;
            row.extend(view.stroke.iter().enumerate().map(|(k, x)| (of + k, *x)));
        }
        row
    }

    fn rows(&self, views: &[View], read: &Read) -> Vec<Vec<(usize, f64)>> {
        let of = |(i, view): (usize, &View)| {
            self.row(view, Some((read.session[i], read.stroke[i])), read.sessions)
        };
        views.iter().enumerate().map(of).collect()
    }

    /// Measured less what a point has, at views that were taken about another: gain, set length and zero act through the forward model, all else by its
    /// columns.
    fn left(&self, mean: &[f64], views: &[View], there: &[View], read: &Read) -> Vec<f64> {
        let rows = self.rows(views, read);
        let first = self.first_own();
        let nonlinear = |place: usize| {
            let of_session = place.checked_sub(self.of_session(0));
            let of_session = of_session.filter(|k| *k < OF_SESSION * read.sessions);
            (first..=first + GAIN).contains(&place)
                || of_session.is_some_and(|k| k % OF_SESSION < 2)
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
        let left = self.left(&mean, about.unwrap_or(&views), &views, read);
        let deviates = left.iter().zip(&views).map(|(l, v)| l / v.noise_n);
        let value = deviates.map(|d| d * d).sum::<f64>() + sum_of_squares(&mean);
        Stand { mean, views, value }
    }

    /// Mean and factor given readings: from nothing, and from where readings lead without misfit. Far from its mode a length that is off by millimetres
    /// is not straight, and the misfit takes its place.
    fn condition(&mut self, read: &Read) {
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
            let next_value = next.value;
            let fall = here.value - next_value;
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
        let left = self.left(&here.mean, &here.views, &here.views, read);
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

    /// The force of a steady reading in one more session.
    pub fn at(
        &self,
        [rest_length_m, contracted_length_m, length_m, pressure_kpa]: [f64; 4],
        whose: Whose,
    ) -> Forecast {
        let view = self.view_of(
            [rest_length_m, contracted_length_m, length_m, pressure_kpa],
            whose,
        );
        let row = self.row(&view, None, self.sessions.len());
        self.forecast(&view, &row)
    }

    fn state(&self, [rest_m, contracted_m, length_m, kpa]: [f64; 4], whose: Whose) -> Reading {
        let at = self.law.steady(rest_m, contracted_m, length_m, kpa);
        let length_sd_mm = self.length_sd_mm.unwrap_or(self.law.sd.set_length_mm);
        self.law.state(at, whose, self.campaign, length_sd_mm)
    }

    /// By how much each term of the law changes what the rig would read in one more session, N.
    pub fn changes(&self, [rest_m, contracted_m, length_m, kpa]: [f64; 4]) -> Vec<f64> {
        let state = self.state([rest_m, contracted_m, length_m, kpa], Whose::Rig);
        let own = self.own(&self.mean, None);
        let force = |reading: &Reading| {
            let view = self.law.view_of_state(&self.base, reading, own);
            view.force_n
        };
        let with = force(&state);
        let terms = 0..self.law.terms.len();
        terms.map(|t| with - force(&state.without(t))).collect()
    }

    fn view_of(&self, [rest_m, contracted_m, length_m, kpa]: [f64; 4], whose: Whose) -> View {
        let state = self.state([rest_m, contracted_m, length_m, kpa], whose);
        let own = self.own(&self.mean, None);
        self.law.view_of_state(&self.base, &state, own)
    }

    fn forecast(&self, view: &View, row: &[(usize, f64)]) -> Forecast {
        let first = self.first_own();
        // Gain and zero are in the force of the view already.
        let linear = row
            .iter()
            .filter(|(k, _)| !(first..=first + GAIN).contains(k));
        let mean_n = view.force_n + linear.map(|(k, x)| x * self.mean[*k]).sum::<f64>();
        let parts = self.parts(view, row);
        Forecast {
            mean_n,
            freedom: self.law.freedom(&parts, self.length_sd_mm.is_some()),
            parts,
        }
    }

    /// Where the variance in one more session is from.
    fn parts(&self, view: &View, row: &[(usize, f64)]) -> Parts {
        if self.sessions.is_empty() {
            return Parts::of_unread(view);
        }
        Parts {
            estimation_n: sum_of_squares(&self.whitened(row)).sqrt(),
            ..Parts::of_session(view)
        }
    }

    /// The forecast of some readings that are not known, in sessions of which others may be.
    pub fn forecast_of(&self, rows: &[&Row]) -> Vec<Forecast> {
        let data = Data::counted_from(rows, &self.law.origins);
        let readings = self.law.readings(&data, rows);
        let of = |(i, reading): (usize, &Reading)| {
            let id = &data.sessions[data.session[i]];
            let session = self.sessions.iter().position(|s| s == id);
            let mut own = self.own(&self.mean, session);
            own.length_mm *= reading.set_length_mm();
            let view = self.law.view(&self.base, reading, own);
            let mut row = self.row(&view, None, self.sessions.len());
            let mut parts = self.parts(&view, &row);
            if let Some(s) = session {
                let of = self.of_session(s);
                row.extend(view.session.iter().enumerate().map(|(k, x)| (of + k, *x)));
                parts = Parts {
                    estimation_n: sum_of_squares(&self.whitened(&row)).sqrt(),
                    noise_n: view.noise_n,
                    misfit_n: sum_of_squares(&view.stroke).sqrt(),
                    ..Parts::default()
                };
            }
            let first = self.first_own();
            let through = |k: usize| {
                (first..=first + GAIN).contains(&k)
                    || session
                        .is_some_and(|s| (self.of_session(s)..self.of_session(s) + 2).contains(&k))
            };
            let linear = row.iter().filter(|(k, _)| !through(*k));
            let mean_n =
                view.force_n + view.shown_n + linear.map(|(k, x)| x * self.mean[*k]).sum::<f64>();
            Forecast {
                mean_n,
                freedom: self.law.freedom(&parts, self.length_sd_mm.is_some()),
                parts,
            }
        };
        readings.iter().enumerate().map(of).collect()
    }

    /// L^-1 x: its products are covariances.
    fn whitened(&self, row: &[(usize, f64)]) -> Vec<f64> {
        let mut x = vec![0.0; self.mean.len()];
        row.iter().for_each(|(k, value)| x[*k] += value);
        self.factor.forward(&x)
    }

    fn estimate(&self, place: usize, unit: f64, session: Option<String>) -> Estimate {
        let sd = sum_of_squares(&self.whitened(&[(place, 1.0)])).sqrt();
        Estimate {
            session,
            value: unit * self.mean[place],
            sd: unit * sd,
            sd_before: unit,
        }
    }

    /// By how much the muscle is stronger than the law, relative.
    pub fn gain(&self) -> Estimate {
        let place = self.first_own() + GAIN;
        self.estimate(place, self.law.sd.gain, None)
    }

    /// Percentile of its gain among those of others.
    pub fn percentile(&self) -> f64 {
        100.0 * normal_cdf(self.mean[self.first_own() + GAIN])
    }

    /// The set length of each session less the one noted, mm.
    pub fn set_lengths(&self) -> Vec<Estimate> {
        let unit = self.law.sd.set_length_mm;
        let sessions = self.sessions.iter().enumerate();
        sessions
            .map(|(s, id)| self.estimate(self.of_session(s), unit, Some(id.clone())))
            .collect()
    }

    /// Of the readings that could be made next, each in a session of its own, the one that narrows the force at a state most.
    pub fn next(&self, wanted: [f64; 4], candidates: &[[f64; 4]]) -> Option<Next> {
        let of = |state: &[f64; 4]| {
            let view = self.view_of(*state, Whose::Rig);
            let row = self.row(&view, None, self.sessions.len());
            (
                self.whitened(&row),
                Parts::of_session(&view).variance(),
                view.noise_n,
            )
        };
        let (here, alike, noise_n) = of(&wanted);
        let alike = alike - noise_n * noise_n;
        let before = sum_of_squares(&here);
        let falls = candidates.iter().map(|state| {
            let (there, own, _) = of(state);
            let cross = dot(&here, &there);
            (state, cross * cross / (sum_of_squares(&there) + own))
        });
        let ([rest_m, _, length_m, kpa], fall) = falls.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Next {
            contraction: 1.0 - length_m / rest_m,
            pressure_kpa: *kpa,
            sd_before_n: (before + alike).sqrt(),
            sd_after_n: ((before - fall).max(0.0) + alike).sqrt(),
        })
    }
}

/// Numbers of a muscle itself: gain and zero of a campaign of its own, gain, resting and contracted length.
const OWN: usize = 5;
/// The place of its gain among them.
const GAIN: usize = 2;

fn weight_of(view: &View) -> f64 {
    1.0 / (view.noise_n * view.noise_n)
}

fn identity(n: usize) -> Matrix {
    let mut one = Matrix::zeros(n, n);
    (0..n).for_each(|k| one.column_mut(k)[k] = 1.0);
    one
}

/// Adds the products of a row.
fn add(normal: &mut Matrix, row: &[(usize, f64)], weight: f64) {
    for (j, x) in row {
        let column = normal.column_mut(*j);
        row.iter().for_each(|(i, y)| column[*i] += weight * x * y);
    }
}
