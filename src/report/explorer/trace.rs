//! The trace of a log as the page draws it: lowest and highest of every stretch of samples, with more stretches at the plateaus than between them.

use super::encode::words;
use pipeline_base::columns::{FORCE, PRESSURE, TIME, TORQUE};
use pipeline_base::frame::Frame;
use serde::Serialize;

/// Stretches that the traces of a page have together, about.
const STRETCHES: usize = 60_000;
/// Fewest and most stretches of a plateau, and of what lies between two.
const OF_PLATEAU: (usize, usize) = (2, 6);
const BETWEEN: (usize, usize) = (3, 14);
/// What stands for a sample that is no number.
const NONE: u16 = u16::MAX;

/// The trace of one log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trace {
    /// Session id.
    pub session: String,
    /// Log file.
    pub log: String,
    /// Line of the first sample in the file.
    pub first_line: u64,
    /// Samples in the log.
    pub samples: usize,
    /// Whether the log has times; else they are lines.
    pub timed: bool,
    /// "force_n" or "torque_nm".
    pub channel: &'static str,
    /// Ends of the scales of time (s, or lines), pressure (kPa) and channel, that the whole numbers span.
    pub scales: [[f64; 2]; 3],
    /// Times, lowest and highest pressures, lowest and highest of the channel, one after the other: 16-bit numbers in base64.
    pub u16: String,
}

/// A log of which a trace is wanted.
pub struct Log<'a> {
    /// Session id.
    pub session: &'a str,
    /// Log file.
    pub log: String,
    /// Line of the first sample in the file.
    pub first_line: u64,
    /// First and last line of each plateau, rising.
    pub plateaus: Vec<(i64, i64)>,
}

/// The trace of a log; none without pressure, or with neither force nor torque. `plateaus` are those of all logs of the page.
pub fn trace(log: &Log, samples: &Frame, plateaus: usize) -> Option<Trace> {
    let pressure = samples.numbers(PRESSURE)?;
    let mut channels = [FORCE, TORQUE].into_iter();
    let (channel, measured) = channels.find_map(|name| Some((name, samples.numbers(name)?)))?;
    let lines: Vec<f64> = (0..pressure.len())
        .map(|k| (log.first_line + k as u64) as f64)
        .collect();
    let time = samples.numbers(TIME);
    let stretches = stretches(log, pressure.len(), plateaus);
    let middle = |(from, to): &(usize, usize)| time.unwrap_or(&lines)[(from + to) / 2];
    let times: Vec<f64> = stretches.iter().map(middle).collect();
    let ends = |values: &[f64]| -> [Vec<f64>; 2] {
        let of = |pick: fn(f64, f64) -> f64| {
            let stretch = |(from, to): &(usize, usize)| {
                values[*from..*to].iter().copied().fold(f64::NAN, pick)
            };
            stretches.iter().map(stretch).collect()
        };
        [of(f64::min), of(f64::max)]
    };
    let (pressures, channel_ends) = (ends(pressure), ends(measured));
    let scales = [
        scale([&times, &times]),
        scale([&pressures[0], &pressures[1]]),
        scale([&channel_ends[0], &channel_ends[1]]),
    ];
    let one = |values: &[f64], k: usize| -> Vec<u16> {
        values.iter().map(|x| whole(*x, scales[k])).collect()
    };
    let all = [
        one(&times, 0),
        one(&pressures[0], 1),
        one(&pressures[1], 1),
        one(&channel_ends[0], 2),
        one(&channel_ends[1], 2),
    ];
    Some(Trace {
        session: log.session.to_owned(),
        log: log.log.clone(),
        first_line: log.first_line,
        samples: pressure.len(),
        timed: time.is_some(),
        channel,
        scales,
        u16: words(all.into_iter().flatten()),
    })
}

/// First sample of each stretch and the one after its last.
fn stretches(log: &Log, samples: usize, plateaus: usize) -> Vec<(usize, usize)> {
    let share = STRETCHES / plateaus.max(1);
    let of_plateau = (share / 4).clamp(OF_PLATEAU.0, OF_PLATEAU.1);
    let between = (share - share / 4).clamp(BETWEEN.0, BETWEEN.1);
    let place = |line: i64| {
        let place = line.saturating_sub_unsigned(log.first_line).max(0);
        (place as usize).min(samples)
    };
    let (mut found, mut at) = (Vec::new(), 0);
    let mut cut = |from: usize, to: usize, most: usize| {
        let parts = most.min(to - from);
        let edge = |k: usize| from + (to - from) * k / parts;
        found.extend((0..parts).map(|k| (edge(k), edge(k + 1))));
    };
    for (first, last) in &log.plateaus {
        let (from, to) = (place(*first).max(at), place(last + 1));
        if to > from {
            cut(at, from, between);
            cut(from, to, of_plateau);
            at = to;
        }
    }
    cut(at, samples, between);
    found
}

/// Lowest and highest of all numbers.
fn scale(of: [&[f64]; 2]) -> [f64; 2] {
    let all = || of.into_iter().flatten().copied();
    let ends = [
        all().fold(f64::NAN, f64::min),
        all().fold(f64::NAN, f64::max),
    ];
    if ends[0].is_nan() { [0.0, 1.0] } else { ends }
}

/// A number as one of 65,535 steps of a scale.
fn whole(x: f64, [low, high]: [f64; 2]) -> u16 {
    if x.is_nan() {
        return NONE;
    }
    let share = if high > low {
        (x - low) / (high - low)
    } else {
        0.0
    };
    (share * f64::from(NONE - 1)).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_base::frame::Values;

    fn log(plateaus: Vec<(i64, i64)>) -> Log<'static> {
        Log {
            session: "s",
            log: "1.csv".to_owned(),
            first_line: 2,
            plateaus,
        }
    }

    #[test]
    fn stretches_follow_each_other_over_the_whole_log_and_end_at_plateaus() {
        let log = log(vec![(102, 151), (502, 551)]);
        let all = stretches(&log, 1000, 2);
        assert_eq!((all[0].0, all[all.len() - 1].1), (0, 1000));
        assert!(all.windows(2).all(|w| w[0].1 == w[1].0 && w[0].0 < w[0].1));
        for edge in [100, 150, 500, 550] {
            assert!(all.iter().any(|s| s.0 == edge), "{edge}");
        }
    }

    #[test]
    fn a_spike_of_one_sample_is_in_the_trace() {
        let mut force = vec![10.0; 1000];
        force[333] = 99.0;
        force[10] = f64::NAN;
        let samples = Frame::default()
            .with(PRESSURE, Values::Number(vec![100.0; 1000]))
            .with(FORCE, Values::Number(force));
        let trace = trace(&log(vec![(602, 651)]), &samples, 1).unwrap();
        assert_eq!(trace.scales[2], [10.0, 99.0]);
        assert!(!trace.timed);
        assert_eq!(trace.scales[1], [100.0, 100.0]);
        assert!(super::trace(&log(Vec::new()), &Frame::default(), 1).is_none());
    }
}
