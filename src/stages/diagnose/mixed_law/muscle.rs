//! A muscle: without readings, or with some, which tell of its gain, its lengths, the lengths that were set, and of the law.
//!
//! Everything that is not known is one vector of independent standard normal numbers: parameters, gain and zero of a campaign of its own, gain and
//! lengths of the muscle, and for each session that was read its set length, zero and misfit, for each stroke its own.
//!
//! Readings that the law was made of do not tell of the parameters again: their joint distribution with what is the muscle's own has the
//! parameters' as it is.

use super::MixedLaw;
use super::parts::{Forecast, Parts};
use super::readings::Read;
use super::view::{Lengths, OF_SESSION, OF_STROKE, Own, OwnLengths, Reading, View, Whose};
use crate::base::Base;
use crate::data::{Data, specimen_id};
use crate::settings;
use pipeline_base::row::Row;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::distributions::normal_cdf;
use pipeline_numerics::matrix::{Matrix, dot, norm};
use pipeline_numerics::statistics::sum_of_squares;
use serde::Serialize;
use std::sync::Arc;

/// Most readings of one session that are used: neighbours of a log say the same.
const MOST_READINGS: usize = 40;

/// What the readings say of one number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Session, of set lengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub session: Option<String>,
    /// Posterior mean.
    pub value: f64,
    /// Mean before any reading.
    pub value_before: f64,
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
    pub(super) base: Arc<Base>,
    campaign: Option<usize>,
    /// How well its length is known where its force is asked for, mm; none as the rig sets it.
    length_sd_mm: Option<f64>,
    /// How well its own lengths are known; none as those of others.
    own_lengths: Option<OwnLengths>,
    /// By how many mm its contracted length is longer than noted if what is noted were all error.
    noted_off_mm: f64,
    sessions: Vec<String>,
    /// Units of the set length of each session, mm.
    units_mm: Vec<f64>,
    readings: usize,
    /// Whether the specimen is one of those that the law was fitted to: its readings then tell nothing more of the parameters.
    pub(super) in_law: bool,
    /// Root mean square of what is left of the readings, in units of their noise; 0 without any.
    pub(super) left: f64,
    /// Mean of what is not known, in standard deviations.
    pub(super) mean: Vec<f64>,
    /// Factor of the inverse of its covariance.
    pub(super) factor: Cholesky,
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
            own_lengths: None,
            noted_off_mm: 0.0,
            sessions: Vec::new(),
            units_mm: Vec::new(),
            readings: 0,
            in_law: false,
            left: 0.0,
            mean: vec![0.0; size],
            factor: Cholesky::new(&identity(size)),
        }
    }

    /// A muscle with readings, all of them its own; at most [`MOST_READINGS`] of a session are used.
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
        let lengths_m = [first.rest_length_m, first.contracted_length_m];
        muscle.in_law = law.is_of(&id, lengths_m);
        muscle.sessions.clone_from(&data.sessions);
        muscle.units_mm = vec![law.sd.set_length_mm; data.sessions.len()];
        for (reading, s) in read.readings.iter().zip(&read.session) {
            muscle.units_mm[*s] = reading.lengths().set_mm;
            muscle.own_lengths = Some(reading.lengths().own);
            muscle.noted_off_mm = law.noted_off_mm(reading);
        }
        muscle.condition(&read);
        muscle
    }

    /// The same muscle as if nobody had read it.
    pub fn without_readings(&self) -> Self {
        Self {
            length_sd_mm: self.length_sd_mm,
            own_lengths: self.own_lengths,
            noted_off_mm: self.noted_off_mm,
            ..Self::unread(self.law)
        }
    }

    /// The same where its length is known to this standard deviation, mm.
    pub fn with_length_sd(mut self, sd_mm: f64) -> Self {
        self.length_sd_mm = Some(sd_mm);
        self
    }

    /// The same where its contracted length is known: its contraction is the one asked for.
    pub fn with_known_contraction(mut self) -> Self {
        self.own_lengths = Some(OwnLengths {
            sd_mm: [self.law.sd.rest_length_mm, 0.0],
            contracted_is_declared: true,
        });
        self
    }

    /// Number of readings that were given, and of their sessions.
    pub fn count(&self) -> (usize, usize) {
        (self.readings, self.sessions.len())
    }

    /// Root mean square of what is left of its readings once everything of it is known, in units of their noise: about 1 where the model holds.
    pub fn left(&self) -> f64 {
        self.left
    }

    /// Number of other specimens on which the law rests.
    pub fn others(&self) -> usize {
        self.law.specimens.len() - usize::from(self.in_law)
    }

    /// Whether it is one of the specimens that the law was fitted to.
    pub fn is_in_law(&self) -> bool {
        self.in_law
    }

    pub(super) fn first_own(&self) -> usize {
        self.law.parameters()
    }

    pub(super) fn of_session(&self, session: usize) -> usize {
        self.first_own() + OWN + OF_SESSION * session
    }

    /// Gains and offsets at a mean, of a session or of one to come, where lengths are known so well.
    pub(super) fn own(&self, mean: &[f64], session: Option<usize>, lengths: Lengths) -> Own {
        let sd = &self.law.sd;
        let first = self.first_own();
        let of = |k: usize| session.map_or(0.0, |s| mean[self.of_session(s) + k]);
        Own {
            gain: sd.gain * mean[first + GAIN],
            campaign_gain: sd.campaign_gain * mean[first],
            length_mm: lengths.set_mm * of(0),
            zero_n: sd.zero_n * of(1) + sd.campaign_zero_n * mean[first + 1],
            contracted_mm: lengths.own.sd_mm[1] * mean[first + CONTRACTED],
        }
    }

    /// Whether a number of the muscle itself acts through the forward model, not by its column.
    pub(super) fn is_nonlinear(&self, place: usize) -> bool {
        let first = self.first_own();
        (first..=first + GAIN).contains(&place) || place == first + CONTRACTED
    }

    /// The columns of a reading: (place, value) of those that are not 0 by construction.
    pub(super) fn row(
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

    /// The force of a steady reading in one more session, at a state: resting, contracted and present length, m, and gauge pressure, kPa.
    pub fn at(&self, state: [f64; 4], whose: Whose) -> Forecast {
        let state = self.state(state, whose);
        let view = self.view_of(&state);
        let row = self.row(&view, None, self.sessions.len());
        let parts = self.parts(&view, &row);
        Forecast {
            law_n: view.force_n + self.moved(&row, |_| false),
            slack_n: self.slack(&state, &view),
            freedom: self.freedom(&parts, &view, &state),
            parts,
        }
    }

    /// What the mean of everything that acts by its columns adds, N; what acts through the forward model, of the muscle and `through` beside it, is in its
    /// force.
    fn moved(&self, row: &[(usize, f64)], through: impl Fn(usize) -> bool) -> f64 {
        let linear = row
            .iter()
            .filter(|(k, _)| !self.is_nonlinear(*k) && !through(*k));
        linear.map(|(k, x)| x * self.mean[*k]).sum()
    }

    fn state(&self, [rest_m, contracted_m, length_m, kpa]: [f64; 4], whose: Whose) -> Reading {
        let at = self.law.steady(rest_m, contracted_m, length_m, kpa);
        let lengths = Lengths {
            set_mm: self.length_sd_mm.unwrap_or(self.law.sd.set_length_mm),
            own: self
                .own_lengths
                .unwrap_or_else(|| self.law.usual_lengths(rest_m)),
        };
        self.law.state(at, whose, self.campaign, lengths)
    }

    /// By how much each term of the law changes what the rig would read in one more session at a state (as for [`Self::at`]), N.
    pub fn changes(&self, state: [f64; 4]) -> Vec<f64> {
        let state = self.state(state, Whose::Rig);
        let force = |reading: &Reading| {
            let view = self.view_of(reading);
            view.force_n.max(self.slack(reading, &view).0)
        };
        let with = force(&state);
        let terms = 0..self.law.terms.len();
        terms.map(|t| with - force(&state.without(t))).collect()
    }

    fn view_of(&self, state: &Reading) -> View {
        let own = self.own(&self.mean, None, state.lengths());
        self.law.view_of_state(&self.base, state, own)
    }

    fn slack(&self, state: &Reading, view: &View) -> (f64, f64) {
        let own = self.own(&self.mean, None, state.lengths());
        self.law.slack(&self.base, state, own, view)
    }

    /// Degrees of freedom: of what is not known of law and muscle together those that it had before any reading, which took nothing from them.
    fn freedom(&self, parts: &Parts, view: &View, reading: &Reading) -> f64 {
        let estimated = self.law.estimates_lengths(reading);
        let known = self.length_sd_mm.is_some();
        let of = |parts: &Parts, of_estimation: Option<f64>| {
            let law = self.law;
            law.freedom(parts, of_estimation, estimated, known)
        };
        let unread = Parts::of_unread(view);
        if self.sessions.is_empty() {
            return of(&unread, None);
        }
        of(parts, Some(of(&unread.of_muscle(), None)))
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
        if rows.is_empty() {
            return Vec::new();
        }
        let data = Data::counted_from(rows, &self.law.origins);
        let readings = self.law.readings(&data, rows);
        let of = |(i, reading): (usize, &Reading)| {
            let id = &data.sessions[data.session[i]];
            let session = self.sessions.iter().position(|s| s == id);
            let own = self.own(&self.mean, session, reading.lengths());
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
            let of_session = |k: usize| {
                session.is_some_and(|s| (self.of_session(s)..self.of_session(s) + 2).contains(&k))
            };
            Forecast {
                law_n: view.force_n + view.shown_n + self.moved(&row, of_session),
                slack_n: (f64::NEG_INFINITY, 0.0),
                freedom: self.freedom(&parts, &view, reading),
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
        self.estimate_of(0.0, &[(place, unit)], session)
    }

    /// A number that is linear in what is not known, and so much before any reading.
    fn estimate_of(
        &self,
        value_before: f64,
        row: &[(usize, f64)],
        session: Option<String>,
    ) -> Estimate {
        let sizes: Vec<f64> = row.iter().map(|(_, x)| *x).collect();
        let moved: f64 = row.iter().map(|(k, x)| x * self.mean[*k]).sum();
        Estimate {
            session,
            value: value_before + moved,
            value_before,
            sd: sum_of_squares(&self.whitened(row)).sqrt(),
            sd_before: norm(&sizes),
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

    /// The contracted length less the one noted, mm; none without readings.
    pub fn contracted_length(&self) -> Option<Estimate> {
        let [_, unit_mm] = self.own_lengths.filter(|_| self.readings > 0)?.sd_mm;
        let law = self.law;
        let mut of_noting = vec![0.0; law.parameters()];
        let (_, error_sd) = settings::NOTING_ERROR;
        of_noting[MixedLaw::noting_column()] = error_sd * self.noted_off_mm;
        let row = law.standardised(&of_noting).into_iter().enumerate();
        let row: Vec<(usize, f64)> = row
            .chain([(self.first_own() + CONTRACTED, unit_mm)])
            .collect();
        let as_noted = law.noting_error() * self.noted_off_mm;
        Some(self.estimate_of(as_noted, &row, None))
    }

    /// The set length of each session less the one noted, mm.
    pub fn set_lengths(&self) -> Vec<Estimate> {
        let sessions = self.sessions.iter().zip(&self.units_mm).enumerate();
        sessions
            .map(|(s, (id, unit))| self.estimate(self.of_session(s), *unit, Some(id.clone())))
            .collect()
    }

    /// Of the readings that could be made next, each in a session of its own, the one that narrows the force at a state most; states as for [`Self::at`].
    pub fn next(&self, wanted: [f64; 4], whose: Whose, candidates: &[[f64; 4]]) -> Option<Next> {
        let of = |state: &Reading| {
            let view = self.view_of(state);
            let row = self.row(&view, None, self.sessions.len());
            (self.whitened(&row), Parts::of_session(&view).variance())
        };
        // A reading to come is made on the rig, however well the length is known where the force is asked for.
        let on_rig = Self {
            length_sd_mm: None,
            ..self.clone()
        };
        let (here, alike) = of(&self.state(wanted, whose));
        let before = sum_of_squares(&here);
        let falls = candidates.iter().map(|state| {
            let (there, own) = of(&on_rig.state(*state, Whose::Rig));
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
/// That of its contracted length.
const CONTRACTED: usize = 4;

pub(super) fn identity(n: usize) -> Matrix {
    let mut one = Matrix::zeros(n, n);
    (0..n).for_each(|k| one.column_mut(k)[k] = 1.0);
    one
}
