//! The readings of one campaign as the search sees them: numbers, groups, and what is known of each reading.

use super::labels;
use crate::base::columns::TEMPERATURE;
use crate::base::random::Stream;
use crate::base::row::{Row, label_names};
use crate::base::session::Phase;
use crate::effects::{Conditions, Need};
use crate::numerics::statistics::{mean, median};
use std::collections::{BTreeMap, BTreeSet};

/// A change of pressure that is a step, kPa.
const STEP_KPA: f64 = 5.0;
/// A change of length that is a step, m.
const STEP_M: f64 = 2e-4;
/// A zero that differs from the campaign's median by so many robust standard deviations, and by so many N, is no drift.
const ZERO_STANDS_OUT: (f64, f64) = (5.0, 3.0);
/// Names under which laboratories log the time since the last step, the rate of the pressure, and the cycles done. Only the beginning
/// of a column's name counts.
const SINCE_STEP: &[&str] = &["time_since_step", "since_step", "dwell", "hold"];
const RATE: &[&str] = &["pressure_rate", "rate", "dp_dt", "dpdt", "ramp"];
const CYCLES: &[&str] = &["cycle", "n_cycle", "cycles", "ncycles", "cycle_count"];

/// Name of the shuffled copy of a column, which must never be chosen.
pub const PLACEBO: &str = "placebo";
/// Name of the column that says in which sessions the zero is not known: its second level.
pub const ZERO_UNKNOWN: &str = "zero_unknown";

/// An extra column that no effect of the library has a name for.
#[derive(Clone, Debug, PartialEq)]
pub struct Extra {
    /// Name, as the session's author gave it.
    pub name: String,
    /// One value a reading, less the mean and divided by the standard deviation.
    pub values: Vec<f64>,
    /// Mean and standard deviation before that.
    pub scale: (f64, f64),
    /// One value a session.
    pub constant_in_sessions: bool,
    /// Few whole numbers, constant within a session: it names a group (a load cell, a bench), it does not measure.
    pub names_groups: bool,
    /// The words that stand for the numbers 0, 1, 2, …; empty for a column of numbers.
    pub words: Vec<String>,
}

/// The readings of a campaign.
#[derive(Clone, Debug, Default)]
pub struct Data {
    /// What is known of each reading.
    pub conditions: Vec<Conditions>,
    /// Measured force, N.
    pub force: Vec<f64>,
    /// Place of the reading's session in `sessions`.
    pub session: Vec<usize>,
    /// Place of the reading's specimen in `specimens`.
    pub specimen: Vec<usize>,
    /// A number for the log, unique over the campaign.
    pub log: Vec<usize>,
    /// Session ids, in the order of time (date, then id).
    pub sessions: Vec<String>,
    /// Specimen ids, by name.
    pub specimens: Vec<String>,
    /// Extra columns.
    pub extras: Vec<Extra>,
    /// Why a quantity is not known.
    pub missing: BTreeMap<Need, String>,
    /// Columns of words that are not searched, and why.
    pub notes: Vec<String>,
}

impl Data {
    /// The readings of rows that are usable (the caller sees to that).
    pub fn new(rows: &[&Row]) -> Self {
        let mut by_time: Vec<(&str, &str)> = rows
            .iter()
            .map(|r| (r.date.as_deref().unwrap_or(""), r.session.as_str()))
            .collect();
        by_time.sort_unstable();
        by_time.dedup();
        let sessions: Vec<String> = by_time.iter().map(|(_, id)| (*id).to_owned()).collect();
        let dates: BTreeSet<&str> = by_time.iter().map(|(date, _)| *date).collect();
        let specimens: BTreeSet<&str> = rows.iter().map(|r| r.specimen.as_str()).collect();
        let specimens: Vec<String> = specimens.into_iter().map(str::to_owned).collect();
        let place = |list: &[String], id: &str| list.iter().position(|x| x == id).unwrap_or(0);
        let logs: BTreeSet<(usize, &str)> = rows
            .iter()
            .map(|r| (place(&sessions, &r.session), r.log.as_str()))
            .collect();
        let logs: BTreeMap<(usize, &str), usize> = logs
            .into_iter()
            .enumerate()
            .map(|(k, log)| (log, k))
            .collect();
        let mut data = Data {
            force: rows.iter().map(|r| r.force_n).collect(),
            session: rows.iter().map(|r| place(&sessions, &r.session)).collect(),
            specimen: rows
                .iter()
                .map(|r| place(&specimens, &r.specimen))
                .collect(),
            sessions,
            specimens,
            ..Data::default()
        };
        data.log = rows
            .iter()
            .zip(&data.session)
            .map(|(r, s)| logs[&(*s, r.log.as_str())])
            .collect();
        data.conditions = conditions(rows, &data, dates.len() > 1);
        data.extras = extras(rows, &data);
        data.extras.extend(zero_unknown(rows, &data));
        data.note_what_is_missing(dates.len() > 1);
        let (labels, notes) = labels::labels(rows, &data);
        data.extras.extend(labels);
        data.notes = notes;
        data
    }

    /// The same with a shuffled copy of a column, which must never be chosen: the first extra column (the pressure where there is none). What
    /// differs mostly between sessions is permuted among them, what differs mostly within them within the logs.
    pub fn with_placebo(mut self, seed: u64) -> Self {
        let mut stream = Stream::new(seed, &["placebo"]);
        let copied = self.extras.iter().find(|e| !e.names_groups).cloned();
        let mut extra = copied.unwrap_or_else(|| Extra {
            name: String::new(),
            values: standardised(self.conditions.iter().map(|c| c.pressure_kpa).collect()),
            scale: (0.0, 1.0),
            constant_in_sessions: false,
            names_groups: false,
            words: Vec::new(),
        });
        extra.name = PLACEBO.to_owned();
        let by_session = members(&self.session, self.sessions.len());
        extra.values = if between_share(&extra.values, &by_session) > 0.5 {
            permuted(&extra.values, &by_session, &mut stream)
        } else {
            let logs = self.log.iter().copied().max().map_or(0, |k| k + 1);
            let mut values = extra.values;
            for places in members(&self.log, logs) {
                let mut of: Vec<f64> = places.iter().map(|i| values[*i]).collect();
                shuffle(&mut of, &mut stream);
                for (i, x) in places.into_iter().zip(of) {
                    values[i] = x;
                }
            }
            values
        };
        self.extras.push(extra);
        self
    }

    /// Number of readings.
    pub fn len(&self) -> usize {
        self.force.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.force.is_empty()
    }

    /// The readings at these places; sessions, specimens and logs keep their numbers.
    pub fn select(&self, places: &[usize]) -> Data {
        let pick = |v: &[usize]| places.iter().map(|&i| v[i]).collect();
        Data {
            conditions: places.iter().map(|&i| self.conditions[i]).collect(),
            force: places.iter().map(|&i| self.force[i]).collect(),
            session: pick(&self.session),
            specimen: pick(&self.specimen),
            log: pick(&self.log),
            sessions: self.sessions.clone(),
            specimens: self.specimens.clone(),
            extras: self
                .extras
                .iter()
                .map(|e| Extra {
                    values: places.iter().map(|&i| e.values[i]).collect(),
                    ..e.clone()
                })
                .collect(),
            missing: self.missing.clone(),
            notes: self.notes.clone(),
        }
    }

    /// At most so many readings: of every session an equal share, evenly spread.
    pub fn thinned(&self, most: usize) -> Data {
        let mut of_session: Vec<Vec<usize>> = vec![Vec::new(); self.sessions.len()];
        for (i, s) in self.session.iter().enumerate() {
            of_session[*s].push(i);
        }
        let share = (most / self.sessions.len().max(1)).max(8);
        let mut places: Vec<usize> = of_session
            .into_iter()
            .flat_map(|list| {
                let step = (list.len() as f64 / share as f64).max(1.0);
                let kept = (list.len() as f64 / step).floor() as usize;
                (0..kept)
                    .map(move |k| list[(k as f64 * step) as usize])
                    .collect::<Vec<usize>>()
            })
            .collect();
        places.sort_unstable();
        self.select(&places)
    }

    /// The specimen of each session.
    pub fn specimen_of_session(&self) -> Vec<usize> {
        let mut of = vec![0; self.sessions.len()];
        for (s, k) in self.session.iter().zip(&self.specimen) {
            of[*s] = *k;
        }
        of
    }

    /// For each session the number of the level of an extra column that names groups (none for the first level), and how many.
    pub fn levels(&self, column: usize) -> (Vec<Option<usize>>, usize) {
        let levels = self.level_values(column);
        let mut of_session = vec![None; self.sessions.len()];
        for (x, s) in self.extras[column].values.iter().zip(&self.session) {
            let place = levels.iter().position(|l| l == x);
            of_session[*s] = place.and_then(|p| p.checked_sub(1));
        }
        (of_session, levels.len() - 1)
    }

    /// The levels of an extra column that names groups, as its author wrote them.
    pub fn level_names(&self, column: usize) -> Vec<String> {
        let extra = &self.extras[column];
        let (middle, sd) = extra.scale;
        let levels = self.level_values(column);
        let name = |x: &f64| {
            let number = format!("{:.0}", middle + sd * x);
            let place: Option<usize> = number.parse().ok();
            let word = place.and_then(|k| extra.words.get(k));
            word.cloned().unwrap_or(number)
        };
        levels.iter().map(name).collect()
    }

    fn level_values(&self, column: usize) -> Vec<f64> {
        let mut levels = self.extras[column].values.clone();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    }

    fn note_what_is_missing(&mut self, dated: bool) {
        let varies = |f: fn(&Conditions) -> f64, least: f64| {
            let values: Vec<f64> = self.conditions.iter().map(f).collect();
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            high - low > least
        };
        let known = [
            (Need::Direction, varies(|c| c.direction, 1.5)),
            (Need::LogTime, varies(|c| c.log_time_s, 1e-6)),
            (Need::CampaignTime, dated),
            (
                Need::SinceStep,
                varies(|c| libm::log1p(c.since_step_s), 0.2),
            ),
            (Need::Rate, varies(|c| c.rate_kpa_per_s, 1e-6)),
            (Need::Temperature, varies(|c| c.temperature_c, 1e-6)),
            (Need::Cycles, varies(|c| c.cycles, 0.5)),
            (Need::RestLengths, varies(|c| c.rest_length_m, 1e-6)),
            (Need::Zeros, self.zeros_stand_out()),
        ];
        self.missing = known
            .into_iter()
            .filter(|(_, known)| !known)
            .map(|(need, _)| (need, format!("the campaign lacks {}", need.words())))
            .collect();
    }
}

/// The places of each group.
fn members(group: &[usize], groups: usize) -> Vec<Vec<usize>> {
    let mut members = vec![Vec::new(); groups];
    for (i, g) in group.iter().enumerate() {
        members[*g].push(i);
    }
    members
}

/// Share of the variance of standardised values that is between groups.
fn between_share(values: &[f64], groups: &[Vec<usize>]) -> f64 {
    let square = |places: &Vec<usize>| {
        let sum: f64 = places.iter().map(|i| values[*i]).sum();
        sum * sum / places.len().max(1) as f64
    };
    groups.iter().map(square).sum::<f64>() / values.len().max(1) as f64
}

/// Every group with the values of another, one after the other and again from the first.
fn permuted(values: &[f64], groups: &[Vec<usize>], stream: &mut Stream) -> Vec<f64> {
    let present: Vec<&Vec<usize>> = groups.iter().filter(|g| !g.is_empty()).collect();
    let mut order: Vec<usize> = (0..present.len()).collect();
    for k in (1..order.len()).rev() {
        let other = stream.below(k + 1);
        order.swap(k, other);
    }
    let mut out = values.to_vec();
    for (to, from) in present.iter().zip(&order) {
        let source = present[*from];
        for (k, i) in to.iter().enumerate() {
            out[*i] = values[source[k % source.len()]];
        }
    }
    out
}

fn shuffle(values: &mut [f64], stream: &mut Stream) {
    for k in (1..values.len()).rev() {
        let other = stream.below(k + 1);
        values.swap(k, other);
    }
}

/// Less the mean, by the standard deviation.
fn standardised(mut values: Vec<f64>) -> Vec<f64> {
    let middle = mean(&values);
    let n = values.len() as f64;
    let variance = values
        .iter()
        .map(|x| (x - middle) * (x - middle))
        .sum::<f64>()
        / n;
    let sd = variance.sqrt().max(f64::MIN_POSITIVE);
    for x in &mut values {
        *x = (*x - middle) / sd;
    }
    values
}

fn named(row: &Row, names: &[&str]) -> Option<f64> {
    let lower = |n: &str| n.to_ascii_lowercase();
    row.extras
        .iter()
        .find(|(name, _)| names.iter().any(|n| lower(name).starts_with(n)))
        .map(|(_, value)| *value)
}

fn conditions(rows: &[&Row], data: &Data, dated: bool) -> Vec<Conditions> {
    let finite =
        |values: Vec<f64>| -> Vec<f64> { values.into_iter().filter(|x| x.is_finite()).collect() };
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let lengths: Vec<f64> = lengths.into_iter().map(f64::from_bits).collect();
    let middle = 0.5
        * (lengths.iter().copied().fold(f64::INFINITY, f64::min)
            + lengths.iter().copied().fold(0.0, f64::max));
    let temperature = |r: &Row| r.extras.get(TEMPERATURE).copied().unwrap_or(f64::NAN);
    let temperatures = finite(rows.iter().map(|r| temperature(r)).collect());
    let mean_temperature = mean(&temperatures);
    let cycles_before = cycles_before(data, dated);
    let usual_zero = usual_zero(rows, data);
    let last = (data.sessions.len() - 1).max(1) as f64;
    let zero_if_nan = |x: f64| if x.is_finite() { x } else { 0.0 };
    let mut conditions: Vec<Conditions> = rows
        .iter()
        .enumerate()
        .map(|(i, r)| Conditions {
            pressure_kpa: r.pressure_kpa,
            length_m: r.length_m,
            rest_length_m: r.rest_length_m,
            contracted_length_m: r.contracted_length_m,
            diameter_mm: r.diameter_mm,
            middle_rest_length_m: middle,
            direction: match r.phase {
                Some(Phase::Pressurizing) => 1.0,
                Some(Phase::Depressurizing) => -1.0,
                None => 0.0,
            },
            log_time_s: zero_if_nan(r.time_s),
            campaign_time: if dated {
                data.session[i] as f64 / last
            } else {
                0.0
            },
            since_step_s: 0.0,
            rate_kpa_per_s: 0.0,
            temperature_c: zero_if_nan(temperature(r) - mean_temperature),
            zero_force_n: zero_if_nan(r.zero_force_n - usual_zero),
            cycles: named(r, CYCLES).unwrap_or(cycles_before[data.log[i]]),
        })
        .collect();
    histories(rows, data, &mut conditions);
    conditions
}

impl Data {
    /// Whether the zero that was taken off differs in some sessions from that of the others by more than zeros wander.
    fn zeros_stand_out(&self) -> bool {
        let mut zeros = vec![0.0; self.sessions.len()];
        for (c, s) in self.conditions.iter().zip(&self.session) {
            zeros[*s] = c.zero_force_n.abs();
        }
        let usual = 1.4826 * median(&zeros);
        let least = ZERO_STANDS_OUT.1.max(ZERO_STANDS_OUT.0 * usual);
        zeros.iter().any(|z| *z > least)
    }
}

/// Median over the sessions of the zero that was taken off the force, N.
fn usual_zero(rows: &[&Row], data: &Data) -> f64 {
    let mut zeros = vec![f64::NAN; data.sessions.len()];
    for (r, s) in rows.iter().zip(&data.session) {
        zeros[*s] = r.zero_force_n;
    }
    zeros.retain(|z| z.is_finite());
    if zeros.is_empty() {
        f64::NAN
    } else {
        median(&zeros)
    }
}

/// Logs that a specimen has done before each log: its cycles, where nobody counted them and the sessions have an order in time.
fn cycles_before(data: &Data, dated: bool) -> Vec<f64> {
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
fn histories(rows: &[&Row], data: &Data, conditions: &mut [Conditions]) {
    let mut by_log: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, log) in data.log.iter().enumerate() {
        by_log.entry(*log).or_default().push(i);
    }
    for mut places in by_log.into_values() {
        places.sort_by(|a, b| rows[*a].time_s.total_cmp(&rows[*b].time_s).then(a.cmp(b)));
        let timed = places.iter().all(|&i| rows[i].time_s.is_finite());
        directions_by_sequence(rows, &places, conditions);
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
            conditions[i].rate_kpa_per_s = named(row, RATE)
                .unwrap_or_else(|| if timed { rate(rows, &places, k) } else { 0.0 });
        }
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

/// The columns that the user added and no effect claims, if they vary.
fn extras(rows: &[&Row], data: &Data) -> Vec<Extra> {
    let words = label_names(rows.iter().copied());
    let names = rows.iter().flat_map(|r| r.extras.keys());
    let names: BTreeSet<&String> = names.filter(|n| !words.contains(*n)).collect();
    let claimed = |name: &str| {
        let lower = name.to_ascii_lowercase();
        name == TEMPERATURE
            || [SINCE_STEP, RATE, CYCLES]
                .concat()
                .iter()
                .any(|n| lower.starts_with(n))
    };
    names
        .into_iter()
        .filter(|n| !claimed(n))
        .filter_map(|n| extra(rows, data, n))
        .collect()
}

/// Whether a zero was taken off the force of a session, where that differs: of some sessions the zero is known (from a zero log, or because
/// the actuator went slack), of others not.
fn zero_unknown(rows: &[&Row], data: &Data) -> Option<Extra> {
    let known = |r: &&Row| r.zero_force_n.is_finite();
    // Whole numbers that are constant within sessions: they name two groups.
    let unknown = rows.iter().map(|r| f64::from(u8::from(!known(r))));
    column(data, ZERO_UNKNOWN, unknown.collect())
}

fn extra(rows: &[&Row], data: &Data, name: &str) -> Option<Extra> {
    let raw: Vec<f64> = rows
        .iter()
        .map(|r| r.extras.get(name).copied().unwrap_or(f64::NAN))
        .collect();
    column(data, name, raw)
}

fn column(data: &Data, name: &str, raw: Vec<f64>) -> Option<Extra> {
    let known: Vec<f64> = raw.iter().copied().filter(|x| x.is_finite()).collect();
    if known.len() < raw.len() / 2 {
        return None;
    }
    let middle = mean(&known);
    let sd = (known
        .iter()
        .map(|x| (x - middle) * (x - middle))
        .sum::<f64>()
        / known.len() as f64)
        .sqrt();
    if sd <= 1e-9 * (1.0 + middle.abs()) {
        return None;
    }
    let distinct: BTreeSet<i64> = known.iter().map(|x| x.round() as i64).collect();
    let whole = known.iter().all(|x| x.fract() == 0.0);
    let mut of_session: Vec<Option<f64>> = vec![None; data.sessions.len()];
    let mut constant = true;
    for (x, s) in raw.iter().zip(&data.session) {
        constant &= of_session[*s].is_none_or(|y| y == *x);
        of_session[*s] = Some(*x);
    }
    Some(Extra {
        name: name.to_owned(),
        values: raw
            .iter()
            .map(|x| {
                if x.is_finite() {
                    (x - middle) / sd
                } else {
                    0.0
                }
            })
            .collect(),
        scale: (middle, sd),
        constant_in_sessions: constant,
        names_groups: whole
            && constant
            && distinct.len() <= 4
            && 3 * distinct.len() <= data.sessions.len(),
        words: Vec::new(),
    })
}
