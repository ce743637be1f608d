//! Steady readings without logs: what a perfect plateau search would give, a thousand times faster.
//!
//! Kept: the staircase with its jitter, relaxation and leak; the model's force, strengths included; the noise of a mean over the
//! samples of a plateau, rounding included; the error of the declared zero, common to a session; the readings that clipping
//! takes away.
//!
//! Skipped: the samples themselves, hence pressure waves and heavy tails, which no plateau mean shows; the pace of the serial line
//! (the switch to venting may fall into the neighbouring step); the clipping bias of a zero that lies near the clipping level.

use super::draw::{DrawnSession, DrawnTruth};
use super::staircase::{STEP_S, Staircase};
use super::truth::{Run, Truth};
use crate::base::random::Stream;
use crate::base::session::{Phase, Sampling};

/// The part of a step, counted from its beginning, over which a reading is averaged, s.
const WINDOW_S: (f64, f64) = (0.25, STEP_S);
/// Pressure by which two readings of one log differ at least, kPa.
const DISTINCT_KPA: f64 = 5.0;

/// One steady reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyRow {
    /// Place of the session in [`DrawnTruth::sessions`].
    pub session: usize,
    /// Number of the run.
    pub run: i64,
    /// Middle of the window, s; 0 for steady readings taken by hand.
    pub time_s: f64,
    /// Whether the rig was filling or venting.
    pub phase: Phase,
    /// As the sensor shows it, kPa.
    pub pressure_kpa: f64,
    /// As the sensor shows it, less the declared zero, N.
    pub force_n: f64,
}

/// The steady readings of a campaign: sessions and runs in the order of the truth file, then time.
pub fn rows(truth: &Truth) -> (DrawnTruth, Vec<SteadyRow>) {
    let drawn = DrawnTruth::new(truth);
    let mut rows = Vec::new();
    for (k, session) in drawn.sessions.iter().enumerate() {
        let zero_error = zero_error(&drawn, session);
        for run in &truth.runs {
            let mut reader = Reader::new(&drawn, k, *run, zero_error);
            let levels = match truth.sampling {
                Sampling::Timeseries => levels(&drawn, session, *run),
                Sampling::Points => points(truth),
            };
            rows.extend(levels.into_iter().filter_map(|level| reader.read(level)));
        }
    }
    (drawn, rows)
}

/// Time in s, phase and true pressure in kPa of a steady reading.
type Level = (f64, Phase, f64);

fn points(truth: &Truth) -> Vec<Level> {
    let level = |p: &f64| (0.0, Phase::Pressurizing, *p);
    truth.pressures_kpa.iter().map(level).collect()
}

fn levels(drawn: &DrawnTruth, session: &DrawnSession, run: Run) -> Vec<Level> {
    let rig = &drawn.truth.rig;
    let valve = Stream::new(
        drawn.truth.seed,
        &["valve", &session.id, &run.number.to_string()],
    );
    let mut staircase = Staircase::new(rig, session.air(run), valve);
    let end_s = rig.rows as f64 * rig.interval_ms * 1e-3;
    let mut levels: Vec<Level> = Vec::new();
    for step in 0..(end_s / STEP_S) as usize {
        let start_s = step as f64 * STEP_S;
        let phase = if start_s < rig.filling * end_s {
            Phase::Pressurizing
        } else {
            Phase::Depressurizing
        };
        staircase.advance(start_s, phase);
        let middle_s = start_s + 0.5 * (WINDOW_S.0 + WINDOW_S.1);
        let pressure = staircase.bulk(middle_s);
        if levels
            .last()
            .is_none_or(|l| (l.2 - pressure).abs() >= DISTINCT_KPA)
        {
            levels.push((middle_s, phase, pressure));
        }
    }
    levels
}

/// Error of the zero that the zero log declares, N.
fn zero_error(drawn: &DrawnTruth, session: &DrawnSession) -> f64 {
    if drawn.truth.sampling == Sampling::Points {
        return 0.0;
    }
    let rig = &drawn.truth.rig;
    let sd = sample_sd(rig.force_noise_n, rig.force_quantum_n) / (rig.zero_rows as f64).sqrt();
    sd * Stream::new(drawn.truth.seed, &["steady zero", &session.id]).normal()
}

/// Standard deviation of one sample, rounding included.
fn sample_sd(noise: f64, quantum: f64) -> f64 {
    (noise * noise + quantum * quantum / 12.0).sqrt()
}

struct Reader<'a> {
    drawn: &'a DrawnTruth,
    k: usize,
    run: i64,
    zero_error: f64,
    samples: f64,
    noise: Stream,
}

impl<'a> Reader<'a> {
    fn new(drawn: &'a DrawnTruth, k: usize, run: Run, zero_error: f64) -> Self {
        let truth = &drawn.truth;
        let path = ["steady", &drawn.sessions[k].id, &run.number.to_string()];
        let samples = match truth.sampling {
            Sampling::Timeseries => (WINDOW_S.1 - WINDOW_S.0) * 1e3 / truth.rig.interval_ms,
            Sampling::Points => 1.0,
        };
        Self {
            drawn,
            k,
            run: run.number,
            zero_error,
            samples,
            noise: Stream::new(truth.seed, &path),
        }
    }

    /// The reading at a level, unless the force lies where samples clip.
    fn read(&mut self, (time_s, phase, pressure): Level) -> Option<SteadyRow> {
        let session = &self.drawn.sessions[self.k];
        let actuator = self.drawn.actuator(session);
        let (force_channel, pressure_channel) = (
            self.drawn.force_channel(session),
            self.drawn.pressure_channel(),
        );
        let mut error = |noise: f64, quantum: f64| {
            sample_sd(noise, quantum) / self.samples.sqrt() * self.noise.normal()
        };
        let force_error = error(force_channel.noise_sd, force_channel.quantum);
        let pressure_error = error(pressure_channel.noise_sd, pressure_channel.quantum);
        let force = actuator.force(session.length_mm * 1e-3, pressure);
        let shown = force + session.force_zero_n;
        let clipped = shown - 2.0 * force_channel.noise_sd < force_channel.clip;
        (!clipped).then_some(SteadyRow {
            session: self.k,
            run: self.run,
            time_s,
            phase,
            pressure_kpa: pressure + pressure_channel.zero + pressure_error,
            force_n: force + force_error - self.zero_error,
        })
    }
}
