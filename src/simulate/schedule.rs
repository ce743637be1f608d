//! The schedule of steady readings taken as points: which pressures, in which direction, when.
//!
//! ```toml
//! pressures_kpa = [100, 200, 300, 620]
//! directions = "up-down"           # optional; "up" where it is left out. Down again without repeating the highest; adds a phase
//! reading_every_s = 5              # optional: a clock; every pressure is read so long after the step to it
//! dwell_s = [2, 20, 120]           # or: every pressure is read at these times after the step to it
//! ramp_kpa_per_s = [2, 10, 40]     # or: read in passing, while the pressure changes at this rate; one number, or one a run
//! ```
//!
//! Any of the last three adds a column of time. Dwelling adds the column `dwell_s`, a ramp the column `rate_kpa_per_s` (negative on
//! the way down): the operator knows them, as a laboratory does.

use super::moment::Instant;
use super::rig_settings::within;
use super::truth::Run;
use pipeline_base::session::{Phase, Sampling};
use pipeline_base::toml_reader::{Entry, Section};
use serde::Serialize;

/// Column of the time since the step, s.
pub const DWELL: &str = "dwell_s";
/// Column of the ramp's rate, kPa/s.
pub const RATE: &str = "rate_kpa_per_s";
/// The columns that a schedule adds to points.
pub const OWN_COLUMNS: [&str; 2] = [DWELL, RATE];
/// Time that the regulator takes from one pressure to the next, s.
const STEP_S: f64 = 1.0;

/// When a pressure is read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    /// By hand, without a clock.
    ByHand,
    /// At times after the step to it, s.
    Dwell(Vec<f64>),
    /// In passing, at a rate for each run, kPa/s.
    Ramp(Vec<f64>),
}

/// The schedule of points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Schedule {
    /// Pressures on the way up, kPa; empty for logs over time.
    pub pressures_kpa: Vec<f64>,
    /// Whether they are read on the way down as well.
    pub both_directions: bool,
    /// When they are read.
    pub pace: Pace,
}

/// Keys of the schedule.
const KEYS: [&str; 4] = ["directions", "reading_every_s", DWELL, "ramp_kpa_per_s"];

/// Takes the schedule's keys for known without reading them: what they need is mistaken itself.
pub fn pass(root: &Section) {
    for key in KEYS {
        root.get(key);
    }
}

impl Schedule {
    /// Reads the schedule's keys; logs over time have none of them.
    pub fn read(
        root: &Section,
        pressures_kpa: Vec<f64>,
        sampling: Sampling,
        runs: &[Run],
    ) -> Option<Self> {
        let mut schedule = Self {
            pressures_kpa,
            both_directions: false,
            pace: Pace::ByHand,
        };
        if sampling == Sampling::Timeseries {
            return Some(schedule);
        }
        let words = [("up", false), ("up-down", true)];
        let both = root.get("directions").map_or(Some(false), |e| {
            let both = e.choice(&words)?;
            let rising = schedule.pressures_kpa.windows(2).all(|p| p[0] < p[1]);
            if both && !rising {
                e.reject("rising `pressures_kpa` beside it", "sort them");
                return None;
            }
            Some(both)
        });
        let every = root.get("reading_every_s");
        let every = every.map(|e| Some(Pace::Dwell(vec![seconds(&e)?])));
        let dwell = root.get("dwell_s").map(|e| dwell(&e));
        let ramp = root.get("ramp_kpa_per_s").map(|e| ramp(&e, runs.len()));
        let mut paces = [every, dwell, ramp].into_iter().flatten();
        schedule.pace = paces.next().unwrap_or(Some(Pace::ByHand))?;
        if paces.next().is_some() {
            let path = root.path_of("dwell_s");
            let expected = "one of reading_every_s, dwell_s and ramp_kpa_per_s";
            let reader = root.reader();
            reader.report(
                root.line(),
                &path,
                "several paces",
                expected,
                "leave out the others",
            );
            return None;
        }
        schedule.both_directions = both?;
        Some(schedule)
    }

    /// Whether the readings have a clock.
    pub fn has_clock(&self) -> bool {
        self.pace != Pace::ByHand
    }

    /// The column that the pace adds, if any.
    pub fn own_column(&self) -> Option<&'static str> {
        match &self.pace {
            Pace::Dwell(times) if times.len() > 1 => Some(DWELL),
            Pace::Ramp(_) => Some(RATE),
            _ => None,
        }
    }

    /// The value of that column.
    pub fn own_value(&self, at: &Instant) -> Option<f64> {
        self.own_column().map(|name| match name {
            DWELL => at.since_step_s,
            _ => at.rate_kpa_per_s,
        })
    }

    /// The readings of a run, `run` being its place in the truth file.
    pub fn instants(&self, run: usize) -> Vec<Instant> {
        let mut readings = match &self.pace {
            Pace::ByHand => self.dwelling(&[0.0]),
            Pace::Dwell(times) => self.dwelling(times),
            Pace::Ramp(rates) => self.passing(rates[run]),
        };
        let last = readings.len().saturating_sub(1).max(1) as f64;
        let mut peak = 0.0_f64;
        for (k, reading) in readings.iter_mut().enumerate() {
            peak = peak.max(reading.pressure_kpa);
            reading.peak_kpa = peak;
            reading.share = k as f64 / last;
            if !self.has_clock() {
                reading.time_s = 0.0;
            }
        }
        readings
    }

    fn levels(&self) -> impl Iterator<Item = (Phase, f64)> {
        let up = self.pressures_kpa.iter();
        let down = self.pressures_kpa.iter().rev().skip(1);
        let down = down.filter(|_| self.both_directions);
        up.map(|p| (Phase::Pressurizing, *p))
            .chain(down.map(|p| (Phase::Depressurizing, *p)))
    }

    fn dwelling(&self, times: &[f64]) -> Vec<Instant> {
        let longest = times.last().copied().unwrap_or(0.0);
        let level = |(k, (phase, pressure_kpa)): (usize, (Phase, f64))| {
            let step_s = k as f64 * (longest + STEP_S) + STEP_S;
            times.iter().map(move |dwell| Instant {
                time_s: step_s + dwell,
                since_step_s: *dwell,
                phase,
                pressure_kpa,
                ..Instant::START
            })
        };
        self.levels().enumerate().flat_map(level).collect()
    }

    fn passing(&self, rate: f64) -> Vec<Instant> {
        let top = self.pressures_kpa.last().copied().unwrap_or(0.0);
        let reading = |(phase, pressure_kpa): (Phase, f64)| {
            let (way, sign) = match phase {
                Phase::Pressurizing => (pressure_kpa, 1.0),
                Phase::Depressurizing => (2.0 * top - pressure_kpa, -1.0),
            };
            Instant {
                time_s: way / rate,
                rate_kpa_per_s: sign * rate,
                phase,
                pressure_kpa,
                ..Instant::START
            }
        };
        self.levels().map(reading).collect()
    }
}

fn seconds(entry: &Entry) -> Option<f64> {
    within(entry, 0.01, 1e5, "s", "time since the step in pressure")
}

fn dwell(entry: &Entry) -> Option<Pace> {
    let times: Option<Vec<f64>> = entry.list()?.iter().map(seconds).collect();
    let times = times?;
    if times.is_empty() || times.windows(2).any(|t| t[0] >= t[1]) {
        entry.reject("rising times in s", "write [2, 20, 120]");
        return None;
    }
    Some(Pace::Dwell(times))
}

fn ramp(entry: &Entry, runs: usize) -> Option<Pace> {
    let rate = |e: &Entry| {
        within(
            e,
            0.01,
            1e4,
            "kPa/s",
            "a rate above zero, in both directions",
        )
    };
    if entry.as_number().is_some() {
        return Some(Pace::Ramp(vec![rate(entry)?; runs]));
    }
    let rates: Option<Vec<f64>> = entry.list()?.iter().map(rate).collect();
    let rates = rates?;
    if rates.len() != runs {
        entry.reject(&format!("{runs} numbers, one a run"), "count the runs");
        return None;
    }
    Some(Pace::Ramp(rates))
}
