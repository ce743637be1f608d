//! The log files of a session, as bytes.
//!
//! Two habits of the real rig make its clock, as far as the logs tell: the controller sends each row over a serial line at 117,647
//! baud, so that a row with more digits takes longer and the first rows, which a 64-byte buffer takes up, come faster; and its
//! millisecond counter advances by overflows of 1.024 ms, so that some milliseconds are missing. Stamps can repeat in the first
//! rows.

use super::chain::{Actuator, Channel};
use super::draw::{DrawnSession, DrawnTruth};
use super::number::{five_digits, fixed};
use super::rig_settings::LogUnit;
use super::staircase::Staircase;
use super::truth::Run;
use crate::base::random::Stream;
use crate::base::session::Phase;
use std::fmt::Write;

/// Time that one more digit takes on the line, ms (ten bits at 117,647 baud).
const DIGIT_MS: f64 = 0.085;
/// Digits of a row that takes the mean sampling interval.
const MEAN_DIGITS: f64 = 10.0;
/// What the buffer holds, ms on the line.
const BUFFER_MS: f64 = 64.0 * DIGIT_MS;
/// Time that the controller itself needs for a row, ms.
const SHORTEST_ROW_MS: f64 = 0.98;
/// Period of the controller's millisecond counter, ms.
const OVERFLOW_MS: f64 = 1.024;

/// When the rows of a log are taken.
#[derive(Default)]
struct Clock {
    now_ms: f64,
    line_free_ms: f64,
}

impl Clock {
    /// The stamp of the row that is taken now, ms.
    fn stamp_ms(&self) -> f64 {
        (OVERFLOW_MS * (self.now_ms / OVERFLOW_MS).floor()).floor()
    }

    /// Sends a row with so many digits; the next is taken as soon as the buffer has room again.
    fn send(&mut self, digits: usize, interval_ms: f64) {
        let line_ms = interval_ms + DIGIT_MS * (digits as f64 - MEAN_DIGITS);
        self.line_free_ms = self.line_free_ms.max(self.now_ms) + line_ms;
        let room_ms = self.line_free_ms - BUFFER_MS;
        self.now_ms = room_ms.max(self.now_ms + SHORTEST_ROW_MS);
    }
}

/// What is connected to the sensors during a log.
struct Bench<'a> {
    drawn: &'a DrawnTruth,
    force: Channel,
    pressure: Channel,
    noise: Stream,
}

/// The log of one run: filling, venting, waiting.
pub fn run_log(drawn: &DrawnTruth, session: &DrawnSession, run: Run) -> Vec<u8> {
    let number = run.number.to_string();
    let seed = drawn.truth.seed;
    let valve = Stream::new(seed, &["valve", &session.id, &number]);
    let mut staircase = Staircase::new(&drawn.truth.rig, session.air(run), valve);
    let actuator: Actuator = drawn.actuator(session);
    let length_m = session.length_mm * 1e-3;
    Bench::new(drawn, session, &number).record(drawn.truth.rig.rows, |time_s, phase| {
        staircase.advance(time_s, phase);
        let force = actuator.force(length_m, staircase.actuator(time_s));
        (force, staircase.sensor(time_s))
    })
}

/// The log without pressure, which declares the zero of the force channel.
pub fn zero_log(drawn: &DrawnTruth, session: &DrawnSession) -> Vec<u8> {
    Bench::new(drawn, session, "zero").record(drawn.truth.rig.zero_rows, |_, _| (0.0, 0.0))
}

/// Steady readings, one row a pressure: a header, then gauge pressure in kPa and force in N as the display shows them.
pub fn points_log(drawn: &DrawnTruth, session: &DrawnSession, run: Run) -> Vec<u8> {
    let mut bench = Bench::new(drawn, session, &run.number.to_string());
    let actuator = drawn.actuator(session);
    let mut text = String::from("pressure_kpa,force_n\n");
    for pressure in &drawn.truth.pressures_kpa {
        let force = actuator.force(session.length_mm * 1e-3, *pressure);
        let [force, pressure] = bench.display(force, *pressure).map(five_digits);
        text.push_str(&format!("{pressure},{force}\n"));
    }
    text.into_bytes()
}

impl<'a> Bench<'a> {
    fn new(drawn: &'a DrawnTruth, session: &DrawnSession, log: &str) -> Self {
        Self {
            drawn,
            force: drawn.force_channel(session),
            pressure: drawn.pressure_channel(),
            noise: Stream::new(drawn.truth.seed, &["noise", &session.id, log]),
        }
    }

    /// `rows` rows of force, pressure, time and phase; `state` gives force in N and pressure in kPa at a time in s.
    fn record(mut self, rows: usize, mut state: impl FnMut(f64, Phase) -> (f64, f64)) -> Vec<u8> {
        let rig = &self.drawn.truth.rig;
        let venting_from = (rows as f64 * rig.filling) as usize;
        let mut clock = Clock::default();
        let mut text = String::new();
        for row in 0..rows {
            let phase = if row < venting_from {
                Phase::Pressurizing
            } else {
                Phase::Depressurizing
            };
            let (force, pressure) = state(clock.now_ms * 1e-3, phase);
            let counts = [
                self.force.sample(force, &mut self.noise),
                self.pressure.sample(pressure, &mut self.noise),
            ];
            let stamp_ms = clock.stamp_ms();
            let [f, p] = self.cells(counts, rig.log_unit);
            let time = fixed(stamp_ms * 1e-3, 3);
            let _infallible = writeln!(text, "{f},{p},{time},{}", phase.code());
            let sent = counts.into_iter().chain([stamp_ms]);
            clock.send(sent.map(digits).sum(), rig.interval_ms);
        }
        text.into_bytes()
    }

    fn cells(&self, [force, pressure]: [f64; 2], unit: LogUnit) -> [String; 2] {
        match unit {
            LogUnit::Counts => [fixed(force, 0), fixed(pressure, 0)],
            LogUnit::Physical => [
                five_digits(self.force.value(force)),
                five_digits(self.pressure.value(pressure)),
            ],
        }
    }

    /// Force and pressure to the steps of the display, which neither clips nor ends.
    fn display(&mut self, force: f64, pressure: f64) -> [f64; 2] {
        [(&self.force, force), (&self.pressure, pressure)].map(|(channel, value)| {
            let shown = value + channel.zero + channel.noise_sd * self.noise.normal();
            channel.quantum * (shown / channel.quantum).round()
        })
    }
}

/// Decimal digits of a whole number from 0.
fn digits(x: f64) -> usize {
    const POWERS: [f64; 5] = [1e1, 1e2, 1e3, 1e4, 1e5];
    1 + POWERS.iter().take_while(|p| x >= **p).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_counter_skips_a_millisecond_now_and_then_and_never_runs_back() {
        let mut clock = Clock::default();
        let mut stamps = Vec::new();
        for _ in 0..5000 {
            stamps.push(clock.stamp_ms());
            clock.send(11, 1.87);
        }
        let mut share = [0; 4];
        for pair in stamps.windows(2) {
            share[(pair[1] - pair[0]) as usize] += 1;
        }
        assert!(
            share[2] > 3500 && share[1] > 200 && share[3] > 100,
            "{share:?}"
        );
    }

    #[test]
    fn digits_are_counted_as_they_are_sent() {
        assert_eq!(
            [0.0, 9.0, 10.0, 999.0, 12_345.0].map(digits),
            [1, 1, 2, 3, 5]
        );
    }
}
