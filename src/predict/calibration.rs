//! A muscle of which some readings are known: what they say of its strength, of the lengths that were set, and of its force at other states.
//!
//! ```text
//! F_i = f(x_i; theta) (1 + u) + d_s df/dl + z_s + m_s(P_i) + e_i
//! ```
//! with the joint law f (Eq. 9), the gain u of the muscle, set length d_s (mm longer than noted) and zero z_s of each session, what neither
//! explains m_s, alike along the pressure within a session (a Gaussian process over [`ALIKE_KPA`]), and the noise e. All are normal about 0: the
//! coefficients theta as the jackknife over specimens has them, u with the scatter of the specimens' gains, d_s, z_s, m_s and e with the sizes
//! that the residual search found ([`Sizes`]). The readings condition them: shrinkage is the posterior mean, so that one reading says little where
//! specimens are alike. Set lengths enter by their slope where the posterior has them ([`STEPS`] times).
//!
//! A force is asked for at an exact length and without zero error, in a session of its own: d, z and m of the sessions that were read belong to
//! the rig and to those sessions. Only u and theta are carried over.

use crate::interval::{CONFIDENCE, Interval};
use pipeline_fit::GroupFit;
use pipeline_fit::engine::EquationFit;
use pipeline_mechanics::models::{P_620_KPA, new};
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::distributions::{normal_cdf, student_t_quantile};
use pipeline_numerics::matrix::{Matrix, dot};
use serde::Serialize;

/// Pressure over which what is left of a session is alike, kPa: that of the residual search's misfit of a session.
const ALIKE_KPA: f64 = 150.0;
/// Times that the slopes by set lengths are taken anew.
const STEPS: usize = 3;
/// Most readings of one session that are used, evenly spaced: neighbours of a log say the same.
const MOST_READINGS: usize = 40;
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
    /// Coefficients, and the deviations of each fold scaled to standard normal numbers.
    coefficients: Vec<f64>,
    deviations: Vec<Vec<f64>>,
    gain: f64,
    sizes: Sizes,
    freedom: f64,
    readings: Vec<Reading>,
    sessions: Vec<String>,
    /// Set lengths about which slopes are taken, mm.
    about: Vec<f64>,
    factor: Cholesky,
    /// C^-1 (y - f).
    weights: Vec<f64>,
    /// Readings that were given.
    given: usize,
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
    by_theta: Vec<f64>,
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
        let g = joint.folds.len() as f64;
        let scale = ((g - 1.0) / g).sqrt();
        let deviations = joint.folds.iter().map(|fold| {
            let pairs = fold.coefficients.iter().zip(&all);
            pairs.map(|(a, b)| scale * (a - b)).collect()
        });
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
            deviations: deviations.collect(),
            gain: scatter.between,
            sizes,
            freedom: scatter.freedom as f64,
            given: readings.len(),
            about: vec![0.0; sessions.len()],
            sessions,
            readings: used,
            factor: Cholesky::new(&Matrix::zeros(0, 0)),
            weights: Vec::new(),
        };
        for _ in 0..STEPS {
            calibration.condition();
            let lengths = calibration.set_lengths();
            calibration.about = lengths.iter().map(|l| l.value).collect();
        }
        calibration.condition();
        Some(calibration)
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

    fn force_with(&self, coefficients: &[f64], at: &At, longer_mm: f64) -> f64 {
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
        const MM: f64 = 0.01;
        let about = session.map_or(0.0, |s| self.about[s]);
        let force = self.force_with(&self.coefficients, at, about);
        let by_theta = self.deviations.iter().map(|deviation| {
            let moved: Vec<f64> = self
                .coefficients
                .iter()
                .zip(deviation)
                .map(|(c, d)| c + d)
                .collect();
            self.force_with(&moved, at, about) - force
        });
        let ends = [about + MM, about - MM].map(|x| self.force_with(&self.coefficients, at, x));
        Row {
            session,
            pressure_kpa: at.pressure_kpa,
            force,
            by_theta: by_theta.collect(),
            by_length: (ends[0] - ends[1]) / (2.0 * MM),
        }
    }

    /// Variance of what is left that is alike within a session, N^2.
    fn alike(&self) -> f64 {
        let left = self.sizes.left_n * self.sizes.left_n;
        (left - self.sizes.noise_n * self.sizes.noise_n).max(LEAST_ALIKE * left)
    }

    /// Covariance of two forces before any reading, noise apart.
    fn covariance(&self, a: &Row, b: &Row) -> f64 {
        let shared = dot(&a.by_theta, &b.by_theta) + self.gain * self.gain * a.force * b.force;
        if a.session.is_none() || a.session != b.session {
            return shared;
        }
        let Sizes {
            length_mm, zero_n, ..
        } = self.sizes;
        let apart = (a.pressure_kpa - b.pressure_kpa) / ALIKE_KPA;
        shared
            + length_mm * length_mm * a.by_length * b.by_length
            + zero_n * zero_n
            + self.alike() * libm::exp(-0.5 * apart * apart)
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

    /// The gain of the muscle over the mean of others, relative.
    pub fn gain(&self) -> Estimate {
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

    /// Percentile of the muscle among others, by its gain.
    pub fn percentile(&self) -> f64 {
        100.0 * normal_cdf(self.gain().value / self.gain)
    }

    /// The set length of each session less the one noted, mm.
    pub fn set_lengths(&self) -> Vec<Estimate> {
        let variance = self.sizes.length_mm * self.sizes.length_mm;
        let of = |(s, session): (usize, &String)| {
            let covariance: Vec<f64> = self
                .rows()
                .map(|r| match r.session {
                    Some(own) if own == s => variance * r.by_length,
                    _ => 0.0,
                })
                .collect();
            let (value, sd) = self.posterior(&covariance, variance);
            Estimate {
                session: Some(session.clone()),
                value,
                sd,
                sd_before: self.sizes.length_mm,
            }
        };
        self.sessions.iter().enumerate().map(of).collect()
    }

    /// Number of readings that were given, and of their sessions.
    pub fn count(&self) -> (usize, usize) {
        (self.given, self.sessions.len())
    }

    /// Mean and standard deviation of the force at a state, N: at an exact length in a session of its own, without noise.
    pub fn force(&self, at: &At) -> (f64, f64) {
        let row = self.row(at, None);
        let covariance: Vec<f64> = self.rows().map(|r| self.covariance(&r, &row)).collect();
        let own = self.covariance(&row, &row);
        let (change, sd) = self.posterior(&covariance, own);
        (
            (row.force + change).max(0.0),
            (sd * sd + self.alike()).sqrt(),
        )
    }

    /// Mean and standard deviation of a further reading in one of the sessions, N, noise included.
    pub fn reading(&self, session: &str, at: &At) -> (f64, f64) {
        let place = self.sessions.iter().position(|s| s == session);
        let row = self.row(at, place);
        let covariance: Vec<f64> = self.rows().map(|r| self.covariance(&r, &row)).collect();
        let (change, sd) = self.posterior(&covariance, self.covariance(&row, &row));
        let about = place.map_or(0.0, |s| self.about[s]);
        let noise = self.sizes.noise_n;
        (
            (row.force - about * row.by_length + change).max(0.0),
            (sd * sd + noise * noise).sqrt(),
        )
    }

    /// The interval of the force at a state; `contraction_620_n` is the part of an eps_620 that was not given.
    pub fn interval(&self, at: &At, contraction_620_n: f64) -> (f64, Interval) {
        let (mean, sd) = self.force(at);
        let alike = self.alike();
        let known = (sd * sd - alike).max(0.0).sqrt();
        let t = student_t_quantile(0.5 + 0.5 * CONFIDENCE, self.freedom);
        let half = t * (sd * sd + contraction_620_n * contraction_620_n).sqrt();
        (
            mean,
            Interval {
                low_n: (mean - half).max(0.0),
                high_n: mean + half,
                fit_n: 0.0,
                specimens_n: known,
                readings_n: alike.sqrt(),
                contraction_620_n,
                freedom: self.freedom as usize,
            },
        )
    }

    /// Of the readings that could be made next, each in a session of its own, the one that narrows the force at a state most.
    pub fn next(&self, wanted: &At, candidates: &[At]) -> Option<Next> {
        let row = self.row(wanted, None);
        let known: Vec<Row> = self.rows().collect();
        let of = |r: &Row| -> Vec<f64> { known.iter().map(|k| self.covariance(k, r)).collect() };
        let to_wanted = of(&row);
        let solved = self.factor.solve(&to_wanted);
        let before = self.covariance(&row, &row) - dot(&to_wanted, &solved);
        let Sizes {
            length_mm,
            zero_n,
            noise_n,
            ..
        } = self.sizes;
        let falls = candidates.iter().map(|at| {
            let r = self.row(at, None);
            let to_known = of(&r);
            let solved_own = self.factor.solve(&to_known);
            let own = self.covariance(&r, &r) - dot(&to_known, &solved_own)
                + length_mm * length_mm * r.by_length * r.by_length
                + zero_n * zero_n
                + self.alike()
                + noise_n * noise_n;
            let cross = self.covariance(&row, &r) - dot(&to_known, &solved);
            (at, cross * cross / own)
        });
        let (at, fall) = falls.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let alike = self.alike();
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
