//! The log files of a session, as bytes.
//!
//! Two habits of the real rig make its clock, as far as the logs tell: the controller sends each row over a serial line at 117,647
//! baud, so that a row with more digits takes longer and the first rows, which a 64-byte buffer takes up, come faster; and its
//! millisecond counter advances by overflows of 1.024 ms, so that some milliseconds are missing. Stamps can repeat in the first
//! rows.

use super::chain::Channel;
use super::draw::{DrawnSession, DrawnTruth};
use super::logged_columns::{self, LogColumns};
use super::moment::Instant;
use super::number::{five_digits, fixed};
use super::rig_settings::LogUnit;
use super::setting::{Setting, Whose};
use super::staircase::Staircase;
use pipeline_base::random::Stream;
use pipeline_base::session::Phase;
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
    columns: &'a LogColumns,
    column_noise: Stream,
}

/// The log of one run: filling, venting, waiting. `run` is its place in the truth file.
pub fn run_log(drawn: &DrawnTruth, session: &DrawnSession, run: usize) -> Vec<u8> {
    let setting = Setting::new(drawn, session, run, Whose::Own);
    let number = drawn.truth.runs[run].number.to_string();
    let rig = &drawn.truth.rig;
    let valve = Stream::new(drawn.truth.seed, &["valve", &session.id, &number]);
    let mut staircase = Staircase::new(rig, session.air(drawn.truth.runs[run]), valve);
    let rows = rig.rows;
    let bench = Bench::new(drawn, session, &number, &setting.columns);
    bench.record(rows, |time_s, share, phase| {
        staircase.advance(time_s, phase);
        let pressure = staircase.actuator(time_s);
        let at = staircase.instant(time_s, phase, pressure, share);
        let sensed = setting.sensed_pressure(at, staircase.sensor(time_s));
        (setting.force(at), sensed)
    })
}

/// The log without pressure, which declares the zero of the force channel. It was taken before anything happened to that channel, or
/// its zero would take the effect off again; the pressure channel is as in the runs.
pub fn zero_log(drawn: &DrawnTruth, session: &DrawnSession) -> Vec<u8> {
    let setting = Setting::new(drawn, session, 0, Whose::Own);
    let sensed = setting.sensed_pressure(Instant::START, 0.0);
    let rows = drawn.truth.rig.zero_rows;
    let bench = Bench::new(drawn, session, "zero", &setting.columns);
    bench.record(rows, |_, _, _| (0.0, sensed))
}

/// Steady readings, one row a reading: a header, then gauge pressure in kPa and force in N as the display shows them, and what the
/// schedule and the truth file add.
pub fn points_log(drawn: &DrawnTruth, session: &DrawnSession, run: usize) -> Vec<u8> {
    let truth = &drawn.truth;
    let setting = Setting::new(drawn, session, run, Whose::Own);
    let number = truth.runs[run].number.to_string();
    let mut bench = Bench::new(drawn, session, &number, &setting.columns);
    let mut text = points_header(drawn);
    for at in truth.schedule.instants(run) {
        let sensed = setting.sensed_pressure(at, at.pressure_kpa);
        let [force, pressure] = bench.display(setting.force(at), sensed).map(five_digits);
        let _infallible = write!(text, "{pressure},{force}");
        if truth.schedule.has_clock() {
            let _infallible = write!(text, ",{}", fixed(at.time_s, 3));
        }
        if truth.schedule.both_directions {
            let _infallible = write!(text, ",{}", at.phase.code());
        }
        if let Some(value) = truth.schedule.own_value(&at) {
            let _infallible = write!(text, ",{}", five_digits(value));
        }
        bench.write_columns(&mut text, at.share);
        text.push('\n');
    }
    text.into_bytes()
}

fn points_header(drawn: &DrawnTruth) -> String {
    let schedule = &drawn.truth.schedule;
    let mut names = vec!["pressure_kpa", "force_n"];
    names.extend(schedule.has_clock().then_some("time_s"));
    names.extend(schedule.both_directions.then_some("phase"));
    names.extend(schedule.own_column());
    names.extend(drawn.truth.columns.iter().map(|c| c.name.as_str()));
    names.join(",") + "\n"
}

impl<'a> Bench<'a> {
    fn new(
        drawn: &'a DrawnTruth,
        session: &DrawnSession,
        log: &str,
        columns: &'a LogColumns,
    ) -> Self {
        Self {
            drawn,
            force: drawn.force_channel(session),
            pressure: drawn.pressure_channel(),
            noise: Stream::new(drawn.truth.seed, &["noise", &session.id, log]),
            columns,
            column_noise: logged_columns::noise(drawn, session, log),
        }
    }

    /// `rows` rows of force, pressure, time, phase and the columns; `state` gives force in N and pressure in kPa at a time in s, of
    /// which the rows so far are a share.
    fn record(
        mut self,
        rows: usize,
        mut state: impl FnMut(f64, f64, Phase) -> (f64, f64),
    ) -> Vec<u8> {
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
            let share = row as f64 / (rows - 1) as f64;
            let (force, pressure) = state(clock.now_ms * 1e-3, share, phase);
            let counts = [
                self.force.sample(force, &mut self.noise),
                self.pressure.sample(pressure, &mut self.noise),
            ];
            let stamp_ms = clock.stamp_ms();
            let [f, p] = self.cells(counts, rig.log_unit);
            let time = fixed(stamp_ms * 1e-3, 3);
            let _infallible = write!(text, "{f},{p},{time},{}", phase.code());
            self.write_columns(&mut text, share);
            text.push('\n');
            let sent = counts.into_iter().chain([stamp_ms]);
            clock.send(sent.map(digits).sum(), rig.interval_ms);
        }
        text.into_bytes()
    }

    /// The columns of a row, each after a comma.
    fn write_columns(&mut self, text: &mut String, share: f64) {
        let noise = &mut self.column_noise;
        for value in self.columns.shown(self.drawn, share, 1.0, noise) {
            let _infallible = write!(text, ",{}", five_digits(value));
        }
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
