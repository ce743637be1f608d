//! Columns that the user added, and their levels where they name groups.

use super::Data;
use pipeline_base::columns::TEMPERATURE;
use pipeline_base::row::{Row, label_names};
use pipeline_inference::decisions::{FEWEST, MOST_LEVELS};
use pipeline_numerics::statistics::mean;
use std::collections::BTreeSet;

/// Names under which laboratories log the time since the last step, the rate of the pressure, and the cycles done. What follows them in a column's
/// name, such as a unit, begins with another sign than a letter.
pub(super) const SINCE_STEP: &[&str] = &["time_since_step", "since_step", "dwell", "hold"];
pub(super) const RATE: &[&str] = &["pressure_rate", "rate", "dp_dt", "dpdt", "ramp"];
pub(super) const CYCLES: &[&str] = &["cycle", "n_cycle", "cycles", "ncycles", "cycle_count"];

/// Whether a column's name is one of these.
pub(super) fn is_named(column: &str, names: &[&str]) -> bool {
    let lower = column.to_ascii_lowercase();
    let rest = names.iter().filter_map(|n| lower.strip_prefix(n));
    let mut next = rest.map(|rest| rest.chars().next());
    next.any(|sign| !sign.is_some_and(char::is_alphabetic))
}

/// Name of the column that says in which sessions the zero is not known: its second level.
pub const ZERO_UNKNOWN: &str = "zero_unknown";

/// An extra column, on which the force may depend in a way that no effect of the library has.
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

impl Data {
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
}

/// The columns that the user added and that are no history of the actuator, if they vary. The temperature is among them: the library has what it does to
/// the size of the force, and not that it moves the zero of a load cell.
pub(super) fn extras(rows: &[&Row], data: &Data) -> Vec<Extra> {
    let words = label_names(rows.iter().copied());
    let names = rows.iter().flat_map(|r| r.extras.keys());
    let names: BTreeSet<&String> = names.filter(|n| !words.contains(*n)).collect();
    let is_history = |name: &str| {
        let histories = [SINCE_STEP, RATE, CYCLES];
        histories.iter().any(|names| is_named(name, names))
    };
    names
        .into_iter()
        .filter(|n| !is_history(n))
        .filter_map(|n| extra(rows, data, n))
        .collect()
}

/// Whether a zero was taken off the force of a session, where that differs: of some sessions the zero is known (from a zero log, or because
/// the actuator went slack), of others not.
pub(super) fn zero_unknown(rows: &[&Row], data: &Data) -> Option<Extra> {
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
    let mut extra = column(data, name, raw)?;
    // Whole degrees name no group.
    extra.names_groups &= name != TEMPERATURE;
    Some(extra)
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
            && distinct.len() <= MOST_LEVELS
            && FEWEST * distinct.len() <= data.sessions.len(),
        words: Vec::new(),
    })
}
