//! Each log by itself.

use crate::{Check, Seen, State};
use pipeline_base::columns::{FORCE, PRESSURE, TIME};
use pipeline_base::reject::Extent;
use pipeline_base::session::{Sampling, Session};
use pipeline_clean::Cleaned;
use pipeline_clean::zero::is_clipped;
use pipeline_ingest::LogSamples;
use pipeline_numerics::statistics::median;

/// Share of rows left out from which somebody should look.
const ROWS: f64 = 0.01;
/// Share of samples at the converter's limit from which somebody should look: a slack actuator below the range of the converter is usual, so what
/// counts is the share of the plateaus ([`Seen::Plateaus`]) and a zero log ([`Seen::Zero`]); half of a log is a channel that does not work.
const CLIPPED: f64 = 0.5;
/// Pressures beyond this share of the highest are high.
const HIGH: f64 = 0.8;
/// Of a force or pressure that is cut off, so many samples in a row have the log's highest value, and so many times as many as ever have another
/// one: noise ends such runs after a few samples, as many as the resolution of the converter lets pass.
const FLAT_SAMPLES: usize = 50;
const FLAT_RATIO: usize = 3;
/// A step of the clock that is so many usual ones long has lost samples.
const GAP: f64 = 3.5;
/// Share of unsettled plateaus from which somebody should look.
const UNSETTLED: f64 = 0.25;

/// The checks of every log.
pub fn checks(session: &Session, logs: &[LogSamples], cleaned: &Cleaned) -> Vec<Check> {
    let series = session.sampling == Sampling::Timeseries;
    let mut all = Vec::new();
    for log in logs {
        let name = log.spec.name();
        let mut push = |state, seen| {
            all.push(Check {
                log: Some(name.clone()),
                state,
                seen,
            });
        };
        let rejects = || cleaned.header.rejects.iter().filter(|r| r.log == name);
        let whole = rejects().find(|r| r.extent == Extent::Log);
        if let Some(reject) = whole {
            let reason = reject.reason.clone();
            push(State::Bad, Seen::LeftOut { reason });
        }
        let rows = || rejects().filter(|r| r.extent == Extent::Row);
        let left_out: u64 = rows().map(|r| r.count).sum();
        let share = left_out as f64 / log.len().max(1) as f64;
        push(
            state_from(share, ROWS),
            Seen::Rows {
                rows: log.len(),
                left_out,
                reason: rows().max_by_key(|r| r.count).map(|r| r.reason.clone()),
            },
        );
        if let Some([share, at_pressure]) = clipped(session, log).filter(|_| !log.spec.is_zero) {
            let seen = Seen::Clipping { share, at_pressure };
            push(state_from(share.max(at_pressure), CLIPPED), seen);
        }
        let flat = [FORCE, PRESSURE].map(|column| flat_top(session, log, column));
        for seen in flat.into_iter().flatten().filter(|_| series) {
            push(State::Look, seen);
        }
        if let Some(clock) = clock(log).filter(|_| series) {
            push(state_if(clock.1 > 0), clock.0);
        }
        if series && !log.spec.is_zero && whole.is_none() {
            let of_log = cleaned.readings.iter().filter(|r| r.log == name);
            let steady = of_log.count();
            let unsettled = rejects().filter(|r| r.extent == Extent::Plateau && drifts(&r.reason));
            let unsettled: usize = unsettled.count();
            let share = unsettled as f64 / (steady + unsettled).max(1) as f64;
            push(
                state_if(share > UNSETTLED),
                Seen::Plateaus { steady, unsettled },
            );
        }
    }
    all
}

fn state_from(share: f64, limit: f64) -> State {
    state_if(share >= limit)
}

fn state_if(look: bool) -> State {
    if look { State::Look } else { State::Fine }
}

/// Whether a plateau was left out because it had not settled.
fn drifts(reason: &str) -> bool {
    [
        pipeline_clean::steady::PRESSURE_DRIFTS,
        pipeline_clean::steady::FORCE_DRIFTS,
    ]
    .contains(&reason)
}

/// Share of the samples of the force at the converter's limit, of all and of those at high pressure, where an actuator pulls most; none where no
/// limit is declared.
fn clipped(session: &Session, log: &LogSamples) -> Option<[f64; 2]> {
    let column = session.column(FORCE)?;
    if column.saturation_low.is_none() && column.saturation_high.is_none() {
        return None;
    }
    let force = log.column(FORCE)?;
    let share = |places: &[usize]| {
        let clipped = places.iter().filter(|i| is_clipped(column, force[**i]));
        clipped.count() as f64 / places.len().max(1) as f64
    };
    let all: Vec<usize> = (0..force.len()).collect();
    let pressure = log.column(PRESSURE).unwrap_or_default();
    let highest = pressure.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let is_high = |i: &usize| pressure.get(*i).is_some_and(|p| *p > HIGH * highest);
    let high: Vec<usize> = all.iter().copied().filter(is_high).collect();
    (!force.is_empty()).then(|| [share(&all), share(&high)])
}

/// The highest force or pressure, where it stands still as neither does: an amplifier or a converter cuts it off below the limit that is declared, if
/// any is.
fn flat_top(session: &Session, log: &LogSamples, name: &str) -> Option<Seen> {
    let (column, values) = (session.column(name)?, log.column(name)?);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    if !highest.is_finite() || lowest == highest || is_clipped(column, highest) {
        return None;
    }
    let runs = || {
        values
            .chunk_by(|a, b| a == b)
            .map(|run| (run[0], run.len()))
    };
    let longest = |of: &dyn Fn(f64) -> bool| {
        let lengths = runs().filter(|(value, _)| of(*value)).map(|(_, n)| n);
        lengths.max().unwrap_or(0)
    };
    let samples = longest(&|value| value == highest);
    let others = longest(&|value| value != highest && value != lowest);
    let is_cut = samples >= FLAT_SAMPLES && samples > FLAT_RATIO * others;
    is_cut.then_some(match name {
        PRESSURE => Seen::PressureFlatTop {
            at_kpa: highest,
            samples,
        },
        _ => Seen::FlatTop {
            at_n: highest,
            samples,
        },
    })
}

/// The clock, and how many gaps it has; none where there is no clock.
fn clock(log: &LogSamples) -> Option<(Seen, usize)> {
    let time = log.column(TIME)?;
    let steps: Vec<f64> = time
        .windows(2)
        .map(|w| w[1] - w[0])
        .filter(|s| s.is_finite() && *s > 0.0)
        .collect();
    if steps.len() < 2 {
        return None;
    }
    let step_s = median(&steps);
    let gaps: Vec<f64> = steps.into_iter().filter(|s| *s > GAP * step_s).collect();
    let longest_s = gaps.iter().copied().fold(0.0, f64::max);
    let seen = Seen::Clock {
        step_s,
        gaps: gaps.len(),
        longest_s,
    };
    Some((seen, gaps.len()))
}
