//! Steady readings without logs: what a perfect plateau search would give, a thousand times faster.
//!
//! Kept: the staircase with its jitter, relaxation and leak; the model's force, gains included; the noise of a mean over the
//! samples of a plateau, rounding included; the error of the declared zero, common to a session; the readings that clipping
//! takes away.
//!
//! Skipped: the samples themselves, hence pressure waves and heavy tails, which no plateau mean shows; the pace of the serial line
//! (the switch to venting may fall into the neighbouring step); the clipping bias of a zero that lies near the clipping level.

use super::draw::{DrawnSession, DrawnTruth};
use super::logged_columns;
use super::moment::Instant;
use super::setting::{Setting, Whose};
use super::staircase::{STEP_S, Staircase};
use super::truth::{Run, Truth};
use pipeline_base::random::Stream;
use pipeline_base::session::{Phase, Sampling};

/// The part of a step, counted from its beginning, over which a reading is averaged, s.
const WINDOW_S: (f64, f64) = (0.25, STEP_S);
/// Pressure by which two readings of one log differ at least, kPa.
const DISTINCT_KPA: f64 = 5.0;

/// One steady reading.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyRow {
    /// Place of the session in [`DrawnTruth::sessions`].
    pub session: usize,
    /// Place of the run in the truth file.
    pub run: usize,
    /// Place of the reading among those of the run, the clipped ones counted too.
    pub number: usize,
    /// The true state of the air, and when: the middle of the window.
    pub at: Instant,
    /// As the sensor shows it, kPa.
    pub pressure_kpa: f64,
    /// As the sensor shows it, less the declared zero, N.
    pub force_n: f64,
    /// The same without noise and without the zero log's error: everything that the generating model knows, what was drawn included, N.
    pub true_force_n: f64,
    /// What the generating model expects of a specimen and session that it has not seen, at the pressure as read: mean gain, every
    /// drawn size at its mean, N. The error of this is what no model can beat.
    pub expected_force_n: f64,
    /// What the generating model says that knows what was drawn (the specimen's gain among it), at the pressure as read, N.
    pub known_force_n: f64,
    /// The declared columns as they are shown, in the order of the truth file.
    pub columns: Vec<f64>,
}

/// The steady readings of a campaign: sessions and runs in the order of the truth file, then time.
pub fn rows(truth: &Truth) -> (DrawnTruth, Vec<SteadyRow>) {
    let drawn = DrawnTruth::new(truth);
    let mut rows = Vec::new();
    for session in &drawn.sessions {
        let zero_error = zero_error(&drawn, session);
        for run in 0..truth.runs.len() {
            let mut reader = Reader::new(&drawn, session, run, zero_error);
            let instants = match truth.sampling {
                Sampling::Timeseries => levels(&drawn, session, truth.runs[run]),
                Sampling::Points => truth.schedule.instants(run),
            };
            let readings = instants.into_iter().enumerate();
            rows.extend(readings.filter_map(|(number, at)| reader.read(number, at)));
        }
    }
    (drawn, rows)
}

/// Samples that make a reading.
pub fn samples(truth: &Truth) -> f64 {
    match truth.sampling {
        Sampling::Timeseries => (WINDOW_S.1 - WINDOW_S.0) * 1e3 / truth.rig.interval_ms,
        Sampling::Points => 1.0,
    }
}

fn levels(drawn: &DrawnTruth, session: &DrawnSession, run: Run) -> Vec<Instant> {
    let rig = &drawn.truth.rig;
    let valve = Stream::new(
        drawn.truth.seed,
        &["valve", &session.id, &run.number.to_string()],
    );
    let mut staircase = Staircase::new(rig, session.air(run), valve);
    let end_s = rig.rows as f64 * rig.interval_ms * 1e-3;
    let mut levels: Vec<Instant> = Vec::new();
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
            .is_none_or(|l| (l.pressure_kpa - pressure).abs() >= DISTINCT_KPA)
        {
            levels.push(staircase.instant(middle_s, phase, pressure, middle_s / end_s));
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
pub fn sample_sd(noise: f64, quantum: f64) -> f64 {
    (noise * noise + quantum * quantum / 12.0).sqrt()
}

struct Reader<'a> {
    drawn: &'a DrawnTruth,
    session: &'a DrawnSession,
    run: usize,
    own: Setting,
    expected: Setting,
    zero_error: f64,
    samples: f64,
    noise: Stream,
    column_noise: Stream,
}

impl<'a> Reader<'a> {
    fn new(drawn: &'a DrawnTruth, session: &'a DrawnSession, run: usize, zero_error: f64) -> Self {
        let number = drawn.truth.runs[run].number.to_string();
        let path = ["steady", &session.id, &number];
        Self {
            drawn,
            session,
            run,
            own: Setting::new(drawn, session, run, Whose::Own),
            expected: Setting::new(drawn, session, run, Whose::Expected),
            zero_error,
            samples: samples(&drawn.truth),
            noise: Stream::new(drawn.truth.seed, &path),
            column_noise: logged_columns::noise(drawn, session, &format!("steady {number}")),
        }
    }

    /// The reading at an instant, unless the force lies where samples clip.
    fn read(&mut self, number: usize, at: Instant) -> Option<SteadyRow> {
        let force_channel = self.drawn.force_channel(self.session);
        let pressure_channel = self.drawn.pressure_channel();
        let mut error = |noise: f64, quantum: f64| {
            sample_sd(noise, quantum) / self.samples.sqrt() * self.noise.normal()
        };
        let force_error = error(force_channel.noise_sd, force_channel.quantum);
        let pressure_error = error(pressure_channel.noise_sd, pressure_channel.quantum);
        let force = self.own.force(at);
        let as_read = Instant {
            pressure_kpa: at.pressure_kpa + pressure_error,
            ..at
        };
        let shown = force + self.session.force_zero_n;
        let clipped = shown - 2.0 * force_channel.noise_sd < force_channel.clip;
        let columns = &mut self.column_noise;
        let columns = (self.own.columns).shown(self.drawn, at.share, self.samples, columns);
        let sensed = self.own.sensed_pressure(at, at.pressure_kpa);
        (!clipped).then_some(SteadyRow {
            session: self.session.number,
            run: self.run,
            number,
            at,
            pressure_kpa: sensed + pressure_channel.zero + pressure_error,
            force_n: force + force_error - self.zero_error,
            true_force_n: force,
            expected_force_n: self.expected.force(as_read),
            known_force_n: self.own.force(as_read),
            columns,
        })
    }
}
