//! Set points and when they are read: three ways, of which each shows what the others cannot.

use super::families::Family;
use super::{CAMPAIGN, Settings};
use crate::moment::Instant;
use pipeline_base::random::Stream;
use pipeline_base::session::Phase;

/// How set points are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pace {
    /// Three runs of twelve set points up and twelve down, each read once after it has settled.
    Staircase,
    /// Two runs of half of the set points up and down, each held and read 2, 20 and 120 s after the step.
    Dwell,
    /// Three runs up and down, read in passing at three rates.
    Ramp,
}

/// Column of the time since the step, s.
pub const DWELL: &str = "dwell_s";
/// Column of the rate, kPa/s.
pub const RATE: &str = "rate_kpa_per_s";

/// Time from one step of a staircase to the next, s, and from the step to the reading.
const STEP_S: (f64, f64) = (2.0, 1.5);
/// Times after a step at which a pressure that is held is read, s.
const DWELLS_S: [f64; 3] = [2.0, 20.0, 120.0];
/// Rates of the ramps, kPa/s.
const RATES: [f64; 3] = [5.0, 20.0, 60.0];
/// Standard deviation by which a regulator misses a set point, kPa.
const MISSED_KPA: f64 = 4.0;

impl Pace {
    /// Runs of a session.
    pub fn runs(self) -> usize {
        match self {
            Pace::Dwell => 2,
            Pace::Staircase | Pace::Ramp => 3,
        }
    }

    /// The column that it adds, with its value.
    pub fn column(self, at: &Instant) -> Option<(&'static str, f64)> {
        match self {
            Pace::Staircase => None,
            Pace::Dwell => Some((DWELL, at.since_step_s)),
            Pace::Ramp => Some((RATE, at.rate_kpa_per_s)),
        }
    }
}

/// The readings of a run, the pressures as the regulator gives them.
pub fn instants(seed: u64, settings: &Settings, session: &str, run: usize) -> Vec<Instant> {
    let path = ["set points", CAMPAIGN, session, &run.to_string()];
    let mut stream = settings.family.stream(seed, &path);
    let levels = levels(settings.family, settings.pace, &mut stream);
    let mut readings = match settings.pace {
        Pace::Staircase => held(&levels, STEP_S.0, &[STEP_S.1]),
        Pace::Dwell => held(&levels, DWELLS_S[2] + 1.0, &DWELLS_S),
        Pace::Ramp => passed(&levels, RATES[run]),
    };
    let end = readings.last().map_or(1.0, |r| r.time_s);
    let mut peak = 0.0_f64;
    for reading in &mut readings {
        peak = peak.max(reading.pressure_kpa);
        reading.peak_kpa = peak;
        reading.share = reading.time_s / end;
    }
    readings
}

fn levels(family: Family, pace: Pace, stream: &mut Stream) -> Vec<(Phase, f64)> {
    let all = family.set_points_kpa();
    let half = all.iter().skip(1).step_by(2);
    let up: Vec<f64> = match pace {
        Pace::Dwell => half.copied().collect(),
        Pace::Staircase | Pace::Ramp => all.to_vec(),
    };
    let down = up.iter().rev();
    let up = up.iter().map(|p| (Phase::Pressurizing, *p));
    let down = down.map(|p| (Phase::Depressurizing, *p - 8.0));
    up.chain(down)
        .map(|(phase, p)| (phase, p + MISSED_KPA * stream.normal()))
        .collect()
}

fn held(levels: &[(Phase, f64)], step_s: f64, dwells: &[f64]) -> Vec<Instant> {
    let level = |(k, (phase, pressure_kpa)): (usize, &(Phase, f64))| {
        let (phase, pressure_kpa) = (*phase, *pressure_kpa);
        let began = k as f64 * step_s;
        dwells.iter().map(move |dwell| Instant {
            time_s: began + dwell,
            since_step_s: *dwell,
            phase,
            pressure_kpa,
            ..Instant::START
        })
    };
    levels.iter().enumerate().flat_map(level).collect()
}

fn passed(levels: &[(Phase, f64)], rate: f64) -> Vec<Instant> {
    let mut time_s = 0.0;
    let mut before = 0.0;
    let reading = |(phase, pressure_kpa): &(Phase, f64)| {
        let sign = match phase {
            Phase::Pressurizing => 1.0,
            Phase::Depressurizing => -1.0,
        };
        time_s += (pressure_kpa - before).abs() / rate;
        before = *pressure_kpa;
        Instant {
            time_s,
            rate_kpa_per_s: sign * rate,
            phase: *phase,
            pressure_kpa: *pressure_kpa,
            ..Instant::START
        }
    };
    levels.iter().map(reading).collect()
}
