//! What the numbers of a column say where its name says nothing: a clock only rises, a state has few values, and pressure ends near
//! 620 kPa.

use super::Guess;
use pipeline_base::columns::{self, FORCE, PHASE, PRESSURE, TIME};
use pipeline_base::session::Phase;
use pipeline_base::units::{Quantity, Unit};
use pipeline_formats::overview::Undescribed;
use std::collections::BTreeMap;

/// The pressure to which these actuators are filled, kPa, and how far from it a log may end.
const FULL_KPA: std::ops::RangeInclusive<f64> = 500.0..=750.0;

/// The units in which a pressure may be logged, the likeliest first.
const PRESSURES: [&str; 5] = ["kPa", "bar", "psi", "MPa", "Pa"];

/// The share of rows that have to agree: real clocks and states have bad cells.
const NEARLY_ALL: f64 = 0.99;

/// A state has no more values than this.
const MOST_STATES: usize = 4;

/// Fills in what names have left open.
pub fn guess(columns: &[Undescribed], guesses: &mut [Guess]) {
    if !has(guesses, TIME) {
        set_first(guesses, "time", "it only rises", |g| is_clock(&g.numbers));
    }
    if !has(guesses, PRESSURE) {
        let why = "it ends near the 620 kPa to which actuators are filled";
        set_first(guesses, "pressure", why, |g| pressure_unit(g).is_some());
    }
    if !has(guesses, PRESSURE) {
        guess_pressure_of_two(guesses);
    }
    guess_phase(columns, guesses);
    if !has(guesses, FORCE) && !has(guesses, columns::TORQUE) {
        set_first(guesses, "force", "no other quantity fits", is_measured);
    }
    for guess in guesses {
        if guess.unit.is_none() {
            guess_unit(guess);
        }
    }
}

fn has(guesses: &[Guess], column: &str) -> bool {
    guesses.iter().any(|g| g.column() == Some(column))
}

/// Gives a quantity to the first column that is none yet, has no name, and fits.
fn set_first(guesses: &mut [Guess], name: &str, why: &str, fits: impl Fn(&Guess) -> bool) {
    let open = |g: &&mut Guess| g.quantity.is_none() && is_nameless(g) && fits(g);
    if let Some(guess) = guesses.iter_mut().find(open) {
        guess.quantity = columns::by_quantity_name(name);
        guess.why = why.to_owned();
        // A clock is known by its steps; a voltage may have the size of a pressure.
        guess.doubtful = name != "time";
    }
}

/// In counts of a converter no column ends near 620 kPa; of two that are left the second is taken, as most rigs log force first.
fn guess_pressure_of_two(guesses: &mut [Guess]) {
    let mut open = guesses
        .iter_mut()
        .filter(|g| g.quantity.is_none() && is_nameless(g) && is_measured(g));
    if let (Some(_), Some(second), None) = (open.next(), open.next(), open.next()) {
        second.quantity = columns::by_quantity_name("pressure");
        second.doubtful = true;
        second.why =
            "the second of two columns; counts of a converter need gain and offset".to_owned();
    }
}

fn is_nameless(guess: &Guess) -> bool {
    matches!(guess.position, pipeline_base::session::Position::Index(_))
}

/// Numbers of more than a few values.
fn is_measured(guess: &Guess) -> bool {
    !guess.numbers.is_empty() && values(&guess.numbers, MOST_STATES).is_none()
}

fn finite(numbers: &[f64]) -> impl Iterator<Item = f64> {
    numbers.iter().copied().filter(|x| x.is_finite())
}

fn is_clock(numbers: &[f64]) -> bool {
    let times: Vec<f64> = finite(numbers).collect();
    let steps = times.len().saturating_sub(1);
    let rising = times.windows(2).filter(|t| t[1] >= t[0]).count();
    let moving = times.windows(2).filter(|t| t[1] > t[0]).count();
    steps > 2 && rising as f64 >= NEARLY_ALL * steps as f64 && 2 * moving >= steps
}

/// Median step from row to row; none for fewer than two numbers.
pub fn median_step(numbers: &[f64]) -> Option<f64> {
    let times: Vec<f64> = finite(numbers).collect();
    let mut steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

/// The value below which nearly all numbers lie: the largest may be a spike.
fn top(numbers: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = finite(numbers).collect();
    sorted.sort_by(f64::total_cmp);
    let place = (NEARLY_ALL * sorted.len() as f64) as usize;
    sorted
        .get(place.min(sorted.len().saturating_sub(1)))
        .copied()
}

fn pressure_unit(guess: &Guess) -> Option<Unit> {
    let top = top(&guess.numbers)?;
    PRESSURES
        .iter()
        .filter_map(|symbol| Quantity::Pressure.unit(symbol))
        .find(|unit| FULL_KPA.contains(&unit.to_inside(top)))
}

/// The unit of a quantity whose name does not say it.
fn guess_unit(guess: &mut Guess) {
    let Some(quantity) = guess.quantity.and_then(|q| q.quantity) else {
        return;
    };
    let top = top(&guess.numbers).unwrap_or(0.0);
    let symbol = match quantity {
        Quantity::Time => match median_step(&guess.numbers) {
            Some(step) if step >= 1.0 => "ms",
            _ => "s",
        },
        Quantity::Pressure => pressure_unit(guess).map_or("kPa", |u| u.symbol),
        Quantity::Length if top < 2.0 => "m",
        Quantity::Length if top < 60.0 => "cm",
        Quantity::Length => "mm",
        Quantity::Angle if top.abs() < 4.0 => "rad",
        Quantity::Angle => "deg",
        Quantity::Temperature if top > 200.0 => "K",
        Quantity::Temperature if top > 50.0 => "F",
        other => other.units().next().map_or("", |u| u.symbol),
    };
    guess.unit = quantity.unit(symbol);
    guess.doubtful |= quantity != Quantity::Time;
    guess.why += ", unit by the size of its numbers";
}

/// The values of a column that has few of them, bad cells aside.
fn values(numbers: &[f64], most: usize) -> Option<Vec<f64>> {
    let mut counts: Vec<(f64, usize)> = Vec::new();
    for x in finite(numbers) {
        match counts.iter().position(|(value, _)| *value == x) {
            Some(k) => counts[k].1 += 1,
            None if counts.len() > 4 * most => return None,
            None => counts.push((x, 1)),
        }
    }
    let rare = (1.0 - NEARLY_ALL) * numbers.len() as f64;
    counts.retain(|(_, count)| *count as f64 > rare);
    let mut values: Vec<f64> = counts.into_iter().map(|(value, _)| value).collect();
    values.sort_by(f64::total_cmp);
    (!values.is_empty() && values.len() <= most).then_some(values)
}

/// The phase: a column with a value in which pressure rises and one in which it falls.
fn guess_phase(columns: &[Undescribed], guesses: &mut [Guess]) {
    let Some(pressure) = guesses.iter().find(|g| g.column() == Some(PRESSURE)) else {
        return;
    };
    let pressure = pressure.numbers.clone();
    for (column, guess) in columns.iter().zip(guesses) {
        let named = guess.column() == Some(PHASE);
        if !named && (guess.quantity.is_some() || !is_nameless(guess)) {
            continue;
        }
        let states = states(&raw_states(column), &pressure);
        let both = states.values().any(|s| *s == Phase::Pressurizing)
            && states.values().any(|s| *s == Phase::Depressurizing);
        if both {
            guess.quantity = columns::by_quantity_name("phase");
            guess.why = "pressure rises in one of its states and falls in another".to_owned();
            guess.states = states;
        } else if named {
            guess.quantity = None;
            guess.doubtful = false;
            guess.why =
                "named like a state, but pressure does not rise and fall with it".to_owned();
        }
    }
}

/// What stands in each row, where a column has few values.
fn raw_states(column: &Undescribed) -> Vec<Option<String>> {
    if !column.words.is_empty() {
        return column.words.clone();
    }
    let Some(values) = values(&column.numbers, MOST_STATES) else {
        return Vec::new();
    };
    let state = |x: &f64| values.contains(x).then(|| x.to_string());
    column.numbers.iter().map(state).collect()
}

/// States by how pressure changes while they last; a state in which it stays has no phase.
fn states(raw: &[Option<String>], pressure: &[f64]) -> BTreeMap<String, Phase> {
    let mut change: BTreeMap<&str, f64> = BTreeMap::new();
    for (k, state) in raw.iter().enumerate().skip(1) {
        let (Some(state), Some([before, now])) = (state, pressure.get(k - 1..=k)) else {
            continue;
        };
        if (now - before).is_finite() {
            *change.entry(state).or_default() += now - before;
        }
        if change.len() > MOST_STATES {
            return BTreeMap::new();
        }
    }
    let span = top(pressure).unwrap_or(0.0).abs() / 2.0;
    let phase = |change: f64| {
        if change > span {
            Some(Phase::Pressurizing)
        } else if change < -span {
            Some(Phase::Depressurizing)
        } else {
            None
        }
    };
    let states = change.into_iter();
    states
        .filter_map(|(state, change)| Some((state.to_owned(), phase(change)?)))
        .collect()
}
