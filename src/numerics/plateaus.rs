//! Steady plateaus of a staircase of pressure.
//!
//! The rig opens a valve for 50 ms of each 500 ms. At every opening the pressure jumps, the sensor near the inlet overshoots and
//! rings for some 150 ms, and only then do force and pressure belong together. The search looks at the pressure alone:
//!
//! 1. Bins of 20 ms (at least three samples) and their medians: a single spike does not move a median.
//! 2. A bin *moves* where the central difference of the medians exceeds the step rate, or five times the log's own scatter of
//!    that rate, whichever is more: a noisy sensor raises its own bar.
//! 3. A run of bins that do not move is a segment. Its first `settle_s` are left out, and its last `window_s` before the next step
//!    are the plateau: there the ringing is over and the slow leak has had the same time in every step.
//! 4. A long segment (the slow approach to the supply pressure, or an emptied actuator) is searched backwards for further windows,
//!    each of which must differ from the one after it by `distinct_kpa`: ten seconds at one pressure are one reading, not forty.
//!
//! Whether the actuator was being filled or vented follows from the sequence of plateaus, by turning points with a hysteresis, so it
//! is known for rigs that do not log it.

use crate::distributions::NORMAL_50;
use crate::statistics;
use std::ops::Range;

/// What counts as steady.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateauOptions {
    /// Width of a bin, s.
    pub bin_s: f64,
    /// Rate of pressure above which a valve must be open, kPa/s.
    pub step_rate_kpa_per_s: f64,
    /// Time after a step that is left out, s.
    pub settle_s: f64,
    /// Length of a plateau's window, s.
    pub window_s: f64,
    /// Shortest window that is used, s.
    pub shortest_window_s: f64,
    /// Pressure by which two windows of one segment must differ to be two readings, kPa.
    pub distinct_kpa: f64,
    /// A pause in the clock longer than this ends a segment, s.
    pub longest_gap_s: f64,
}

/// A steady stretch of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plateau {
    /// The samples to average.
    pub window: Range<usize>,
    /// All samples of the segment in which the window lies.
    pub segment: Range<usize>,
}

/// What the search found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plateaus {
    /// Steady windows in the order of time.
    pub plateaus: Vec<Plateau>,
    /// Segments that are steady but too short to be used.
    pub too_short: Vec<Range<usize>>,
}

/// Finds the plateaus of a log. `time` (s, not decreasing) and `pressure` (kPa) have one length; samples at which the pressure is
/// not finite are ignored.
pub fn find_plateaus(time: &[f64], pressure: &[f64], options: &PlateauOptions) -> Plateaus {
    let mut found = Plateaus::default();
    for stretch in stretches(time, options.longest_gap_s) {
        let bins = bins(&time[stretch.clone()], options.bin_s, stretch.start);
        let medians: Vec<f64> = bins.iter().map(|b| median(&pressure[b.clone()])).collect();
        let centres: Vec<f64> = bins
            .iter()
            .map(|b| 0.5 * (time[b.start] + time[b.end - 1]))
            .collect();
        for run in steady_runs(&centres, &medians, options.step_rate_kpa_per_s) {
            let segment = bins[run.start].start..bins[run.end - 1].end;
            let follows_step = run.start > 0;
            windows(time, pressure, segment, follows_step, options, &mut found);
        }
    }
    found
}

/// The log between pauses of its clock.
fn stretches(time: &[f64], longest_gap_s: f64) -> Vec<Range<usize>> {
    let mut stretches = Vec::new();
    let mut start = 0;
    for k in 1..time.len() {
        if time[k] - time[k - 1] > longest_gap_s {
            stretches.push(start..k);
            start = k;
        }
    }
    if start < time.len() {
        stretches.push(start..time.len());
    }
    stretches
}

/// Consecutive bins of `width` seconds that hold at least three samples each; indices counted from `first`.
fn bins(time: &[f64], width: f64, first: usize) -> Vec<Range<usize>> {
    const FEWEST: usize = 3;
    let mut bins = Vec::new();
    let mut start = 0;
    for k in 0..time.len() {
        if time[k] - time[start] >= width && k - start >= FEWEST {
            bins.push(first + start..first + k);
            start = k;
        }
    }
    if time.len() - start >= FEWEST {
        bins.push(first + start..first + time.len());
    }
    bins
}

/// Runs of bins at which the pressure does not move.
fn steady_runs(centres: &[f64], medians: &[f64], step_rate: f64) -> Vec<Range<usize>> {
    let n = medians.len();
    let rates: Vec<f64> = (0..n)
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(n - 1));
            (medians[b] - medians[a]) / (centres[b] - centres[a]).max(f64::MIN_POSITIVE)
        })
        .collect();
    let absolute: Vec<f64> = rates.iter().map(|r| r.abs()).collect();
    let limit = step_rate.max(5.0 * median(&absolute) / NORMAL_50);
    let mut runs = Vec::new();
    let mut start = None;
    for (k, rate) in absolute.iter().enumerate() {
        let moving = rate.is_nan() || *rate > limit;
        match (moving, start) {
            (false, None) => start = Some(k),
            (true, Some(s)) => {
                runs.push(s..k);
                start = None;
            }
            _ => {}
        }
    }
    runs.extend(start.map(|s| s..n));
    runs
}

/// Cuts the windows of one segment, last first, and files them in the order of time.
fn windows(
    time: &[f64],
    pressure: &[f64],
    segment: Range<usize>,
    follows_step: bool,
    options: &PlateauOptions,
    found: &mut Plateaus,
) {
    let settle = if follows_step { options.settle_s } else { 0.0 };
    let begin = time[segment.start] + settle;
    let mut end = segment.end;
    let mut cut = Vec::new();
    let mut last_pressure = f64::NAN;
    while end > segment.start {
        let t_end = time[end - 1];
        let t_start = begin.max(t_end - options.window_s);
        if t_end - t_start < options.shortest_window_s {
            break;
        }
        let start = segment.start + time[segment.start..end].partition_point(|t| *t < t_start);
        let level = median(&pressure[start..end]);
        if last_pressure.is_nan() || (level - last_pressure).abs() >= options.distinct_kpa {
            cut.push(Plateau {
                window: start..end,
                segment: segment.clone(),
            });
            last_pressure = level;
        }
        end = start;
    }
    if cut.is_empty() {
        found.too_short.push(segment);
    }
    found.plateaus.extend(cut.into_iter().rev());
}

/// For every level of a sequence whether it was reached by filling (`true`) or venting: turning points that exceed `hysteresis`.
pub fn rising(levels: &[f64], hysteresis: f64) -> Vec<bool> {
    let mut directions = vec![true; levels.len()];
    let Some(&first) = levels.first() else {
        return directions;
    };
    let (mut up, mut extreme, mut at) = (None, first, 0);
    let (mut low, mut high) = (first, first);
    for (k, &level) in levels.iter().enumerate() {
        (low, high) = (low.min(level), high.max(level));
        match up {
            None if level - low > hysteresis => (up, extreme, at) = (Some(true), level, k),
            None if high - level > hysteresis => {
                (up, extreme, at) = (Some(false), level, k);
                directions[..=k].fill(false);
            }
            Some(rises) => {
                let ahead = if rises {
                    level - extreme
                } else {
                    extreme - level
                };
                if ahead >= 0.0 {
                    (extreme, at) = (level, k);
                } else if ahead < -hysteresis {
                    up = Some(!rises);
                    directions[at + 1..=k].fill(!rises);
                    (extreme, at) = (level, k);
                }
            }
            None => {}
        }
        if let Some(rises) = up {
            directions[k] = rises;
        }
    }
    directions
}

/// The median of what is finite; NaN of nothing.
fn median(values: &[f64]) -> f64 {
    let mut finite = Vec::with_capacity(values.len());
    finite.extend(values.iter().copied().filter(|x| x.is_finite()));
    statistics::quantile_in_place(&mut finite, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: PlateauOptions = PlateauOptions {
        bin_s: 0.02,
        step_rate_kpa_per_s: 60.0,
        settle_s: 0.15,
        window_s: 0.25,
        shortest_window_s: 0.1,
        distinct_kpa: 5.0,
        longest_gap_s: 0.1,
    };

    /// Steps of 40 kPa each half second with a ringing overshoot, up to `top` and down again.
    fn staircase(steps: usize) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..steps * 2 * 250).map(|k| k as f64 * 0.002).collect();
        let pressure = time
            .iter()
            .map(|t| {
                let step = (t / 0.5).floor();
                let since = t - step * 0.5;
                let up = step.min(steps as f64) - (step - steps as f64).max(0.0);
                let sign = if step < steps as f64 { 1.0 } else { -1.0 };
                40.0 * up + sign * 60.0 * libm::exp(-since / 0.03) * libm::cos(since * 200.0)
            })
            .collect();
        (time, pressure)
    }

    #[test]
    fn every_step_of_a_staircase_is_one_plateau_at_its_level() {
        let (time, pressure) = staircase(10);
        let found = find_plateaus(&time, &pressure, &OPTIONS);
        assert_eq!(found.plateaus.len(), 20, "{:?}", found.plateaus);
        for (k, p) in found.plateaus.iter().enumerate() {
            let expected = 40.0 * if k < 10 { k as f64 } else { 20.0 - k as f64 };
            let level = median(&pressure[p.window.clone()]);
            assert!((level - expected).abs() < 0.2, "step {k}: {level}");
        }
    }

    #[test]
    fn a_spike_does_not_split_a_plateau_and_a_pause_of_the_clock_does() {
        let mut time: Vec<f64> = (0..1000).map(|k| k as f64 * 0.002).collect();
        let mut pressure = vec![300.0; 1000];
        pressure[500] = 53_152.0;
        assert_eq!(find_plateaus(&time, &pressure, &OPTIONS).plateaus.len(), 1);
        time[600..].iter_mut().for_each(|t| *t += 1.0);
        let found = find_plateaus(&time, &pressure, &OPTIONS);
        assert_eq!(found.plateaus.len(), 2);
        assert_eq!(found.plateaus[0].segment.end, 600);
    }

    #[test]
    fn a_long_level_is_one_reading_and_a_slow_rise_is_several() {
        let time: Vec<f64> = (0..5000).map(|k| k as f64 * 0.002).collect();
        let level = find_plateaus(&time, &vec![73.0; 5000], &OPTIONS);
        assert_eq!(level.plateaus.len(), 1);
        let rise: Vec<f64> = time.iter().map(|t| 600.0 + 3.0 * t).collect();
        let found = find_plateaus(&time, &rise, &OPTIONS);
        assert!(
            (5..=6).contains(&found.plateaus.len()),
            "{}",
            found.plateaus.len()
        );
    }

    #[test]
    fn too_few_samples_give_nothing_and_do_not_panic() {
        for n in 0..5 {
            let x: Vec<f64> = (0..n).map(f64::from).collect();
            assert!(find_plateaus(&x, &x, &OPTIONS).plateaus.is_empty());
        }
        let nan = vec![f64::NAN; 100];
        let time: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.002).collect();
        assert!(find_plateaus(&time, &nan, &OPTIONS).plateaus.is_empty());
    }

    #[test]
    fn filling_and_venting_are_told_apart_without_a_state_column() {
        let levels = [
            9.0, 60.0, 120.0, 300.0, 299.5, 301.0, 300.2, 250.0, 180.0, 73.0, 73.4,
        ];
        let expected: Vec<bool> = (0..11).map(|k| k <= 5).collect();
        assert_eq!(rising(&levels, 3.0), expected);
        assert_eq!(rising(&[500.0, 400.0, 300.0], 3.0), [false, false, false]);
        assert_eq!(rising(&[5.0, 5.5, 5.0], 3.0), [true, true, true]);
        assert!(rising(&[], 3.0).is_empty());
        let twice = [0.0, 100.0, 200.0, 100.0, 0.0, 100.0];
        assert_eq!(rising(&twice, 3.0), [true, true, true, false, false, true]);
    }
}
