//! What happened before a reading: time since the last step, rate and direction of the pressure and whether it has moved, cycles done. A column
//! of the log says it, or else the sequence of the readings.

use super::Data;
use super::extras::{CYCLES, RATE, SINCE_STEP, is_named};
use pipeline_base::row::Row;
use pipeline_effects::Conditions;
use std::collections::BTreeMap;

/// A change of pressure that is a step, kPa.
const STEP_KPA: f64 = 5.0;
/// A change of length that is a step, m.
const STEP_M: f64 = 2e-4;
fn named(row: &Row, names: &[&str]) -> Option<f64> {
    row.extras
        .iter()
        .find(|(name, _)| is_named(name, names))
        .map(|(_, value)| *value)
}

/// The cycles that a column of the log counts.
pub(super) fn counted_cycles(row: &Row) -> Option<f64> {
    named(row, CYCLES)
}

/// Logs that a specimen has done before each log: its cycles, where nobody counted them and the sessions have an order in time.
pub(super) fn cycles_before(data: &Data, dated: bool) -> Vec<f64> {
    let logs = data.log.iter().copied().max().map_or(0, |k| k + 1);
    let mut before = vec![0.0; logs];
    if !dated {
        return before;
    }
    let mut specimen = vec![0; logs];
    for (log, k) in data.log.iter().zip(&data.specimen) {
        specimen[*log] = *k;
    }
    let mut done = vec![0.0; data.specimens.len()];
    for log in 0..logs {
        before[log] = done[specimen[log]];
        done[specimen[log]] += 1.0;
    }
    before
}

/// Time since the last step and rate of the pressure, from the sequence of readings in each log, where no column says them.
pub(super) fn histories(rows: &[&Row], data: &Data, conditions: &mut [Conditions]) {
    // Logs in the order of their session, by which their rows come.
    let mut logs: Vec<Vec<usize>> = Vec::new();
    let mut place_of = BTreeMap::new();
    for (i, log) in data.log.iter().enumerate() {
        let place = *place_of.entry(*log).or_insert_with(|| {
            logs.push(Vec::new());
            logs.len() - 1
        });
        logs[place].push(i);
    }
    for places in &mut logs {
        places.sort_by(|a, b| rows[*a].time_s.total_cmp(&rows[*b].time_s).then(a.cmp(b)));
        let timed = places.iter().all(|&i| rows[i].time_s.is_finite());
        directions_by_sequence(rows, places, conditions);
        movements(rows, places, conditions);
        let pressures = places.iter().map(|i| rows[*i].pressure_kpa);
        let highest = pressures.fold(f64::NEG_INFINITY, f64::max);
        places
            .iter()
            .for_each(|i| conditions[*i].highest_kpa = highest);
        let mut level_began = f64::NAN;
        for (k, &i) in places.iter().enumerate() {
            let row = rows[i];
            let before = k.checked_sub(1).map(|k| rows[places[k]]);
            if let (Some(b), true) = (before, timed) {
                let step = (row.pressure_kpa - b.pressure_kpa).abs() > STEP_KPA
                    || (row.length_m - b.length_m).abs() > STEP_M;
                if step {
                    level_began = b.time_s;
                }
            }
            let since = row.time_s - level_began;
            conditions[i].since_step_s =
                named(row, SINCE_STEP).unwrap_or(if since.is_finite() { since } else { 0.0 });
            // On a plateau the pressure stands still, however soon the next one follows.
            let is_plateau = row.samples > 1;
            let by_sequence = || {
                if timed && !is_plateau {
                    rate(rows, places, k)
                } else {
                    0.0
                }
            };
            conditions[i].rate_kpa_per_s = named(row, RATE).unwrap_or_else(by_sequence);
        }
    }
    first_fillings(rows, data, &logs, conditions);
}

/// What was done since the length of a session was set.
#[derive(Clone, Copy)]
struct SinceSet {
    length_m: f64,
    /// Pressure of the last reading.
    pressure_kpa: f64,
    vented: bool,
}

/// Whether a reading is of the first filling after its length was set in its session: nothing was vented at this length before, neither in a
/// reading nor between two of them.
fn first_fillings(rows: &[&Row], data: &Data, logs: &[Vec<usize>], conditions: &mut [Conditions]) {
    let nothing = SinceSet {
        length_m: f64::NAN,
        pressure_kpa: f64::NAN,
        vented: false,
    };
    let mut sessions = vec![nothing; data.sessions.len()];
    for &i in logs.iter().flatten() {
        let since = &mut sessions[data.session[i]];
        let stayed = (rows[i].length_m - since.length_m).abs() <= STEP_M;
        let pressure_kpa = rows[i].pressure_kpa;
        let fell = since.pressure_kpa - pressure_kpa > STEP_KPA;
        *since = SinceSet {
            length_m: if stayed {
                since.length_m
            } else {
                rows[i].length_m
            },
            pressure_kpa,
            vented: stayed && (since.vented || fell) || conditions[i].direction < 0.0,
        };
        conditions[i].first_filling = !since.vented && conditions[i].direction > 0.0;
    }
}

/// The direction where nobody says it: that of the pressure from reading to reading, if the log goes down as well as up.
fn directions_by_sequence(rows: &[&Row], places: &[usize], conditions: &mut [Conditions]) {
    const LEAST_SHARE: f64 = 0.25;
    if places.iter().any(|&i| rows[i].phase.is_some()) || places.len() < 3 {
        return;
    }
    let mut steps: Vec<f64> = places
        .windows(2)
        .map(|w| {
            let step = rows[w[1]].pressure_kpa - rows[w[0]].pressure_kpa;
            if step.abs() > STEP_KPA {
                step.signum()
            } else {
                0.0
            }
        })
        .collect();
    let share =
        |sign: f64| steps.iter().filter(|s| **s == sign).count() as f64 / steps.len() as f64;
    // A log that starts again from below after each run has one step down a run: no venting.
    if share(-1.0) < LEAST_SHARE || share(1.0) < LEAST_SHARE {
        return;
    }
    // A repeated reading has the direction of the step before it, the first one that of the step after it.
    for k in 1..steps.len() {
        if steps[k] == 0.0 {
            steps[k] = steps[k - 1];
        }
    }
    conditions[places[0]].direction = steps[0];
    for (step, &i) in steps.iter().zip(&places[1..]) {
        conditions[i].direction = *step;
    }
}

/// Which way the pressure moved last: the direction of a reading, once the pressure has gone that way by a step since it went the other. A log that
/// begins with a filling begins vented.
fn movements(rows: &[&Row], places: &[usize], conditions: &mut [Conditions]) {
    let (mut moved, mut turned_kpa) = (0.0, 0.0);
    for &i in places {
        let (direction, pressure_kpa) = (conditions[i].direction, rows[i].pressure_kpa);
        let from_top = moved == 0.0 && direction < 0.0;
        if from_top || (pressure_kpa - turned_kpa) * direction > STEP_KPA {
            moved = direction;
        }
        if direction == moved {
            turned_kpa = pressure_kpa;
        }
        conditions[i].moved = moved;
    }
}

/// Mean rate of the pressure from the reading before to the one after, within one direction.
fn rate(rows: &[&Row], places: &[usize], k: usize) -> f64 {
    let same = |j: usize| {
        rows[places[j]].phase == rows[places[k]].phase
            && rows[places[j]].length_m == rows[places[k]].length_m
    };
    let from = k.checked_sub(1).filter(|j| same(*j)).unwrap_or(k);
    let to = Some(k + 1)
        .filter(|j| *j < places.len() && same(*j))
        .unwrap_or(k);
    let (a, b) = (rows[places[from]], rows[places[to]]);
    let seconds = b.time_s - a.time_s;
    if seconds > 0.0 {
        (b.pressure_kpa - a.pressure_kpa) / seconds
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::{RATE, SINCE_STEP, is_named};
    use crate::data::Data;
    use pipeline_base::row::Row;
    use pipeline_base::session::Phase;
    use pipeline_simulate::rig_like;

    #[test]
    fn a_pressure_that_fell_between_two_readings_ends_the_first_filling() {
        let up = &[200.0, 400.0, 600.0][..];
        let mut rows = session(&[("run1", 0.19, up), ("run2", 0.19, up), ("run3", 0.18, up)]);
        rows.iter_mut()
            .for_each(|r| r.phase = Some(Phase::Pressurizing));
        let rows: Vec<&Row> = rows.iter().collect();
        let data = Data::new(&rows);
        let first = data.conditions.iter().map(|c| c.first_filling);
        let expected = [true, true, true, false, false, false, true, true, true];
        assert_eq!(first.collect::<Vec<bool>>(), expected);
    }

    /// A session of logs with these pressures, each at a length; rising ones are filled, falling ones vented.
    fn session(logs: &[(&str, f64, &[f64])]) -> Vec<Row> {
        let some = rig_like::campaign(1, &rig_like::Settings::default()).rows;
        let mut rows = Vec::new();
        for (log, length_m, pressures) in logs {
            let mut before = 0.0;
            for (k, pressure) in pressures.iter().enumerate() {
                let phase = if *pressure > before {
                    Phase::Pressurizing
                } else {
                    Phase::Depressurizing
                };
                before = *pressure;
                rows.push(Row {
                    log: (*log).to_owned(),
                    length_m: *length_m,
                    time_s: k as f64,
                    pressure_kpa: *pressure,
                    phase: Some(phase),
                    ..some[0].clone()
                });
            }
        }
        rows
    }

    #[test]
    fn a_column_means_what_its_name_says_not_what_it_begins_like() {
        for name in ["rate", "Rate_kPa_per_s", "ramp1", "dP_dt (kPa/s)"] {
            assert!(is_named(name, RATE), "{name}");
        }
        for name in ["rated_load", "ramps", "holder", "kpa_rate"] {
            assert!(
                !is_named(name, RATE) && !is_named(name, SINCE_STEP),
                "{name}"
            );
        }
    }

    #[test]
    fn on_a_plateau_the_pressure_stands_still() {
        let rates = |samples: i64| -> Vec<f64> {
            let mut rows = session(&[("run1", 0.19, &[100.0, 200.0, 400.0])]);
            for row in &mut rows {
                row.samples = samples;
                row.extras.clear();
            }
            let rows: Vec<&Row> = rows.iter().collect();
            let data = Data::new(&rows);
            data.conditions.iter().map(|c| c.rate_kpa_per_s).collect()
        };
        assert_eq!(rates(1), [100.0, 150.0, 200.0]);
        assert_eq!(rates(50), [0.0; 3]);
    }

    #[test]
    fn a_reading_that_begins_a_filling_has_not_been_filled() {
        let twice = &[0.4, 200.0, 400.0, 399.0, 200.0, 0.6, 0.7, 200.0, 50.0][..];
        let mut rows = session(&[("run1", 0.19, twice)]);
        let up = [true, true, true, false, false, false, true, true, false];
        for (row, up) in rows.iter_mut().zip(up) {
            row.phase = Some(if up {
                Phase::Pressurizing
            } else {
                Phase::Depressurizing
            });
        }
        let rows: Vec<&Row> = rows.iter().collect();
        let data = Data::new(&rows);
        let moved: Vec<f64> = data.conditions.iter().map(|c| c.moved).collect();
        assert_eq!(moved, [0.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, -1.0]);
    }

    #[test]
    fn a_filling_is_the_first_until_something_was_vented_at_its_length() {
        let up_and_down = &[200.0, 400.0, 300.0, 100.0][..];
        let rows = session(&[
            ("run9", 0.19, up_and_down),
            ("run10", 0.19, up_and_down),
            ("run11", 0.18, &[150.0, 500.0]),
            ("run12", 0.18, &[200.0]),
        ]);
        let rows: Vec<&Row> = rows.iter().collect();
        let data = Data::new(&rows);
        let places = 0..data.conditions.len();
        let first: Vec<usize> = places
            .filter(|i| data.conditions[*i].first_filling)
            .collect();
        assert_eq!(first, [0, 1, 8, 9]);
        let highest: Vec<f64> = data.conditions.iter().map(|c| c.highest_kpa).collect();
        assert_eq!(highest[..8], [400.0; 8]);
        assert_eq!(highest[8..], [500.0, 500.0, 200.0]);
    }
}
