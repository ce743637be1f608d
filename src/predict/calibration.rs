//! A muscle of which some readings are known: what they say of its gain, of the lengths that were set, and of its force at other states.
//!
//! ```text
//! F_i = f(x_i; theta, l + D + d_s) (1 + u) + z_s + m_s(P_i) + e_i
//! ```
//! with the joint law f (Eq. 9), the gain u of the muscle, D by how much its lengths are other than noted in all of its sessions and d_s in one
//! (mm longer), the zero z_s of each session, what none of these explains m_s, alike along the pressure within a session (a Gaussian process over
//! [`ALIKE_KPA`]), and the noise e. All are normal about 0: u with the scatter of the specimens' gains and the uncertainty of the law at this length
//! (jackknife over the specimens, at resting length and 620 kPa), the others with the sizes that the residual search found ([`Sizes`]); of the
//! variance of set lengths [`OF_MUSCLE`] is the muscle's. The readings condition them: shrinkage is the posterior mean, so that one reading says
//! little where specimens are alike. Lengths enter by their slope where the posterior has them ([`STEPS`] times); the force is the law itself at the
//! posterior mean.
//!
//! The coefficients stay: told by one muscle they take its set lengths for a law of another shape, and its other sessions are missed by more than
//! without any reading (200 N on the laboratory's rig).
//!
//! A force is asked for in a session of its own: d, z and m of the sessions that were read belong to the rig and to those sessions, and what they
//! scatter is part of the interval. u and D are carried over.

use crate::interval::{CONFIDENCE, Interval};
use pipeline_fit::GroupFit;
use pipeline_fit::engine::EquationFit;
use pipeline_mechanics::models::{P_620_KPA, new};
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::distributions::{normal_cdf, student_t_quantile};
use pipeline_numerics::matrix::{Matrix, dot};
use serde::Serialize;

/// Pressure over which what is left of a session is alike, kPa: longer than that of the residual search's misfit of a session (100), because the law
/// is without effects here. Another value was not tried.
const ALIKE_KPA: f64 = 150.0;
/// Times that the slopes by set lengths are taken anew.
const STEPS: usize = 3;
/// Most readings of one session that are used, evenly spaced: neighbours of a log say the same.
const MOST_READINGS: usize = 40;
/// Share of the variance of set lengths that all sessions of a muscle have in common: its own lengths are noted once. On the laboratory's rig, each
/// session in turn from the three others of its actuator: see `docs/predict.md`.
const OF_MUSCLE: f64 = 0.5;
/// Least share of what is left that is alike within a session.
const LEAST_ALIKE: f64 = 0.5;

/// How sessions and readings scatter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sizes {
    /// Standard deviation of set lengths, mm.
    pub length_mm: f64,
    /// Of the zero of the force of a session, N.
    pub zero_n: f64,
    /// Of what gain, set length and zero of its own leave of a muscle, N.
    pub left_n: f64,
    /// Of the noise of readings, N.
    pub noise_n: f64,
}

impl Sizes {
    /// What is usual where no search was: lengths set to 1 mm, a zero of 1 N, and a fit's own scatter of readings about the curve of a specimen, N.
    pub fn usual(within_n: f64) -> Self {
        Self {
            length_mm: 1.0,
            zero_n: 1.0,
            left_n: within_n,
            noise_n: 0.3 * within_n,
        }
    }
}

/// A state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_rest - l_620, m.
    pub stroke_m: f64,
    /// Present length, m.
    pub length_m: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
}

/// A reading of the muscle.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Session.
    pub session: String,
    /// State.
    pub at: At,
    /// Force, N.
    pub force_n: f64,
}

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

/// A muscle of which readings are known.
#[derive(Clone, Debug)]
pub struct Calibration<'a> {
    fit: &'a GroupFit,
    /// Coefficients; standard deviation of the muscle's gain about the law with them.
    coefficients: Vec<f64>,
    gain: f64,
    sizes: Sizes,
    freedom: f64,
    readings: Vec<Reading>,
    sessions: Vec<String>,
    /// Lengths about which slopes are taken, mm longer than noted: of every session, and of a session of its own.
    about: Vec<f64>,
    about_new: f64,
    /// Posterior mean of the gain.
    gain_here: f64,
    factor: Cholesky,
    /// C^-1 (y - f).
    weights: Vec<f64>,
    /// Readings that were given.
    given: usize,
    /// Whether the muscle is one of the fit.
    is_of_fit: bool,
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

/// How a state moves with what is not known.
struct Row {
    session: Option<usize>,
    pressure_kpa: f64,
    force: f64,
    by_length: f64,
}

impl<'a> Calibration<'a> {
    /// The law of a fit, conditioned on readings of a muscle; its own fold where the muscle is one of the fit. None where the fit has too few
    /// specimens to say how they scatter, or there is no reading.
    pub fn new(
        fit: &'a GroupFit,
        joint: &EquationFit,
        specimen: Option<&str>,
        sizes: Sizes,
        readings: &[Reading],
    ) -> Option<Self> {
        let scatter = fit.scatter.as_ref()?;
        let own = specimen.and_then(|id| joint.folds.iter().find(|f| f.left_out == id));
        let all = joint.values();
        let coefficients = own.map_or_else(|| all.clone(), |fold| fold.coefficients.clone());
        let used = thinned(readings);
        let mut sessions: Vec<String> = used.iter().map(|r| r.session.clone()).collect();
        sessions.sort();
        sessions.dedup();
        if used.is_empty() {
            return None;
        }
        let mut calibration = Self {
            fit,
            coefficients,
            gain: 0.0,
            sizes,
            freedom: scatter.freedom as f64,
            given: readings.len(),
            is_of_fit: own.is_some(),
            about: vec![0.0; sessions.len()],
            about_new: 0.0,
            gain_here: 0.0,
            sessions,
            readings: used,
            factor: Cholesky::new(&Matrix::zeros(0, 0)),
            weights: Vec::new(),
        };
        let law = calibration.uncertainty(joint);
        calibration.gain = (scatter.between * scatter.between + law * law).sqrt();
        for _ in 0..STEPS {
            calibration.condition();
            let lengths: Vec<f64> = calibration.set_lengths().iter().map(|l| l.value).collect();
            calibration.about_new = calibration.own_length();
            calibration.about = lengths;
        }
        calibration.condition();
        calibration.gain_here = calibration.specimen_gain().value;
        Some(calibration)
    }

    /// Standard deviation of the law itself at this length, at resting length and 620 kPa, relative: jackknife over the specimens.
    fn uncertainty(&self, joint: &EquationFit) -> f64 {
        let rest_length_m = self
            .readings
            .first()
            .map_or(f64::NAN, |r| r.at.rest_length_m);
        let f620 = |c: &[f64]| new::f620(c[0], c[1], self.fit.cap_length_m, rest_length_m);
        let whole = f620(&joint.values());
        let g = joint.folds.len() as f64;
        let off = joint
            .folds
            .iter()
            .map(|fold| f620(&fold.coefficients) / whole - 1.0);
        ((g - 1.0) / g * off.map(|x| x * x).sum::<f64>()).sqrt()
    }

    /// Conditions on the readings, slopes taken about the set lengths.
    fn condition(&mut self) {
        let rows: Vec<Row> = (0..self.readings.len()).map(|i| self.row_of(i)).collect();
        let n = rows.len();
        let mut covariance = Matrix::zeros(n, n);
        for (i, a) in rows.iter().enumerate() {
            for (j, b) in rows.iter().enumerate() {
                covariance.column_mut(j)[i] = self.covariance(a, b);
            }
            covariance.column_mut(i)[i] += self.sizes.noise_n * self.sizes.noise_n;
        }
        let left: Vec<f64> = rows
            .iter()
            .zip(&self.readings)
            .map(|(row, reading)| {
                let about = row.session.map_or(0.0, |s| self.about[s]);
                reading.force_n - row.force + about * row.by_length
            })
            .collect();
        self.factor = Cholesky::new(&covariance);
        self.weights = self.factor.solve(&left);
    }

    fn row_of(&self, i: usize) -> Row {
        let reading = &self.readings[i];
        let session = self.sessions.iter().position(|s| *s == reading.session);
        self.row(&reading.at, session)
    }

    /// The law of the others at a length so many mm longer than noted, N.
    fn law(&self, at: &At, longer_mm: f64) -> f64 {
        let coefficients = &self.coefficients;
        let contraction_rel = (at.rest_length_m - at.length_m - 1e-3 * longer_mm) / at.stroke_m;
        let f620 = new::f620(
            coefficients[0],
            coefficients[1],
            self.fit.cap_length_m,
            at.rest_length_m,
        );
        let c = [coefficients[2], coefficients[3], coefficients[4]];
        new::force(c, f620, contraction_rel, at.pressure_kpa / P_620_KPA)
    }

    fn row(&self, at: &At, session: Option<usize>) -> Row {
        let about = session.map_or(self.about_new, |s| self.about[s]);
        self.row_about(at, session, about)
    }

    /// The slope is taken about this length, mm longer than noted.
    fn row_about(&self, at: &At, session: Option<usize>, about: f64) -> Row {
        const MM: f64 = 0.01;
        let force = self.law(at, about);
        let ends = [about + MM, about - MM].map(|x| self.law(at, x));
        Row {
            session,
            pressure_kpa: at.pressure_kpa,
            force,
            by_length: (ends[0] - ends[1]) / (2.0 * MM),
        }
    }

    /// Variance of what is left that is alike within a session, N^2.
    fn alike(&self) -> f64 {
        let left = self.sizes.left_n * self.sizes.left_n;
        (left - self.sizes.noise_n * self.sizes.noise_n).max(LEAST_ALIKE * left)
    }

    /// Variances of set lengths: of all sessions of the muscle together, and of one, mm^2.
    fn length_variances(&self) -> (f64, f64) {
        let all = self.sizes.length_mm * self.sizes.length_mm;
        (OF_MUSCLE * all, (1.0 - OF_MUSCLE) * all)
    }

    /// Covariance of two forces before any reading, noise apart.
    fn covariance(&self, a: &Row, b: &Row) -> f64 {
        let (of_muscle, _) = self.length_variances();
        let shared =
            self.gain * self.gain * a.force * b.force + of_muscle * a.by_length * b.by_length;
        if a.session.is_none() || a.session != b.session {
            return shared;
        }
        let apart = (a.pressure_kpa - b.pressure_kpa) / ALIKE_KPA;
        shared + self.of_session(a, b, libm::exp(-0.5 * apart * apart))
    }

    /// What two readings of one session have in common beyond the muscle.
    fn of_session(&self, a: &Row, b: &Row, alike: f64) -> f64 {
        let (_, of_session) = self.length_variances();
        let zero = self.sizes.zero_n * self.sizes.zero_n;
        of_session * a.by_length * b.by_length + zero + alike * self.alike()
    }

    /// Mean and standard deviation of a number given the readings, from its covariance with each of them and its own variance.
    fn posterior(&self, covariance: &[f64], variance: f64) -> (f64, f64) {
        let explained = dot(covariance, &self.factor.solve(covariance));
        let sd = (variance - explained).max(0.0).sqrt();
        (dot(covariance, &self.weights), sd)
    }

    fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        (0..self.readings.len()).map(|i| self.row_of(i))
    }

    /// By how much the muscle is stronger than the law of the others, relative.
    pub fn specimen_gain(&self) -> Estimate {
        let variance = self.gain * self.gain;
        let covariance: Vec<f64> = self.rows().map(|r| variance * r.force).collect();
        let (value, sd) = self.posterior(&covariance, variance);
        Estimate {
            session: None,
            value,
            sd,
            sd_before: self.gain,
        }
    }

    /// Percentile of a gain among those of others.
    pub fn percentile(gain: &Estimate) -> f64 {
        100.0 * normal_cdf(gain.value / gain.sd_before)
    }

    /// The length of the muscle less the one noted, mm, as a session of its own has it.
    fn own_length(&self) -> f64 {
        let (of_muscle, _) = self.length_variances();
        let covariance: Vec<f64> = self.rows().map(|r| of_muscle * r.by_length).collect();
        dot(&covariance, &self.weights)
    }

    /// The set length of each session less the one noted, mm.
    pub fn set_lengths(&self) -> Vec<Estimate> {
        let (of_muscle, of_session) = self.length_variances();
        let of = |(s, session): (usize, &String)| {
            let of_reading = |r: Row| match r.session {
                Some(own) if own == s => (of_muscle + of_session) * r.by_length,
                _ => of_muscle * r.by_length,
            };
            let covariance: Vec<f64> = self.rows().map(of_reading).collect();
            let (value, sd) = self.posterior(&covariance, of_muscle + of_session);
            Estimate {
                session: Some(session.clone()),
                value,
                sd,
                sd_before: self.sizes.length_mm,
            }
        };
        self.sessions.iter().enumerate().map(of).collect()
    }

    /// Number of specimens on which the law rests.
    pub fn others(&self) -> usize {
        let all = self.fit.specimens.len();
        all - usize::from(self.is_of_fit)
    }

    /// Number of readings that were given, and of their sessions.
    pub fn count(&self) -> (usize, usize) {
        (self.given, self.sessions.len())
    }

    /// Mean and standard deviation of the force at a state, N: in a session of its own, without noise.
    pub fn force(&self, at: &At) -> (f64, f64) {
        let row = self.row(at, None);
        let covariance: Vec<f64> = self.rows().map(|r| self.covariance(&r, &row)).collect();
        let (_, sd) = self.posterior(&covariance, self.covariance(&row, &row));
        let law = self.law(at, self.about_new);
        let of_session = self.of_session(&row, &row, 1.0);
        ((1.0 + self.gain_here) * law, (sd * sd + of_session).sqrt())
    }

    /// The same before any reading.
    pub fn force_before(&self, at: &At) -> (f64, f64) {
        let row = self.row_about(at, None, 0.0);
        let variance = self.covariance(&row, &row) + self.of_session(&row, &row, 1.0);
        (row.force, variance.sqrt())
    }

    /// Mean and standard deviation of a further reading in one of the sessions, N, noise included.
    pub fn reading(&self, session: &str, at: &At) -> (f64, f64) {
        let place = self.sessions.iter().position(|s| s == session);
        let row = self.row(at, place);
        let covariance: Vec<f64> = self.rows().map(|r| self.covariance(&r, &row)).collect();
        let (change, sd) = self.posterior(&covariance, self.covariance(&row, &row));
        let about = place.map_or(self.about_new, |s| self.about[s]);
        let noise = self.sizes.noise_n;
        (
            (row.force - about * row.by_length + change).max(0.0),
            (sd * sd + noise * noise).sqrt(),
        )
    }

    /// The interval of the force at a state, and the one before any reading; `contraction_620_n` is the part of an eps_620 that was not given.
    pub fn intervals(&self, at: &At, contraction_620_n: f64) -> [(f64, Interval); 2] {
        let t = student_t_quantile(0.5 + 0.5 * CONFIDENCE, self.freedom);
        let left = self.alike();
        [self.force(at), self.force_before(at)].map(|(mean, sd)| {
            let half = t * (sd * sd + contraction_620_n * contraction_620_n).sqrt();
            let interval = Interval {
                low_n: (mean - half).max(0.0),
                high_n: mean + half,
                // What is not known of the law is part of the muscle's gain here.
                fit_n: 0.0,
                specimens_n: (sd * sd - left).max(0.0).sqrt(),
                readings_n: left.sqrt(),
                contraction_620_n,
                freedom: self.freedom as usize,
            };
            (mean, interval)
        })
    }

    /// Of the readings that could be made next, each in a session of its own, the one that narrows the force at a state most.
    pub fn next(&self, wanted: &At, candidates: &[At]) -> Option<Next> {
        let row = self.row(wanted, None);
        let known: Vec<Row> = self.rows().collect();
        let of = |r: &Row| -> Vec<f64> { known.iter().map(|k| self.covariance(k, r)).collect() };
        let to_wanted = of(&row);
        let solved = self.factor.solve(&to_wanted);
        let before = self.covariance(&row, &row) - dot(&to_wanted, &solved);
        let noise_n = self.sizes.noise_n;
        let falls = candidates.iter().map(|at| {
            let r = self.row(at, None);
            let to_known = of(&r);
            let solved_own = self.factor.solve(&to_known);
            let own = self.covariance(&r, &r) - dot(&to_known, &solved_own)
                + self.of_session(&r, &r, 1.0)
                + noise_n * noise_n;
            let cross = self.covariance(&row, &r) - dot(&to_known, &solved);
            (at, cross * cross / own)
        });
        let (at, fall) = falls.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let alike = self.of_session(&row, &row, 1.0);
        Some(Next {
            contraction: 1.0 - at.length_m / at.rest_length_m,
            pressure_kpa: at.pressure_kpa,
            sd_before_n: (before.max(0.0) + alike).sqrt(),
            sd_after_n: ((before - fall).max(0.0) + alike).sqrt(),
        })
    }
}

/// No more readings of a session than say something of their own.
fn thinned(readings: &[Reading]) -> Vec<Reading> {
    let mut sessions: Vec<&str> = readings.iter().map(|r| r.session.as_str()).collect();
    sessions.sort_unstable();
    sessions.dedup();
    let mut used = Vec::new();
    for session in sessions {
        let own: Vec<&Reading> = readings.iter().filter(|r| r.session == session).collect();
        let most = own.len().min(MOST_READINGS);
        used.extend((0..most).map(|k| own[k * own.len() / most].clone()));
    }
    used
}
