#![warn(missing_docs)]
//! A first `session.toml` for a log: which column may be which quantity, in which unit, logged how often.
//!
//! Everything here is a guess for a person to correct, and says what it rests on. What no log can say (the lengths of the actuator), and what
//! rests on the size of numbers alone, is marked to be filled in; a session with such a mark is left out of a run.
//!
//! | module | what |
//! |---|---|
//! | [`names`] | what the name of a column says of quantity and unit |
//! | [`magnitudes`] | what its numbers say, where the name says nothing |
//! | [`text`] | the `session.toml` |

pub mod magnitudes;
pub mod names;
pub mod text;

use pipeline_base::columns::{ANGLE, FORCE, KnownColumn, PRESSURE, TIME, TORQUE};
use pipeline_base::session::{Kind, Part, Phase, Position, Sampling, TextFormat};
use pipeline_base::units::Unit;
use pipeline_formats::overview::Undescribed;
use std::collections::BTreeMap;

/// A log with at least so many rows may be one over time.
const FEWEST_SAMPLES: usize = 200;

/// What one column may be.
#[derive(Clone, Debug)]
pub struct Guess {
    /// Where it stands.
    pub position: Position,
    /// The quantity; none for a column of the user's own.
    pub quantity: Option<&'static KnownColumn>,
    /// Its unit, where the quantity has one.
    pub unit: Option<Unit>,
    /// For a phase: what stands in the log, and the state that it may be.
    pub states: BTreeMap<String, Phase>,
    /// What the guess rests on.
    pub why: String,
    /// Whether it rests on so little that a person has to confirm it: on the size of the numbers.
    pub doubtful: bool,
    /// Its numbers, as logged; nothing where it holds words.
    pub numbers: Vec<f64>,
}

impl Guess {
    /// A guess of which nothing is known but the place.
    fn unknown(column: &Undescribed) -> Self {
        Self {
            position: column.position.clone(),
            quantity: None,
            unit: None,
            states: BTreeMap::new(),
            why: String::new(),
            doubtful: false,
            numbers: column.numbers.clone(),
        }
    }

    /// The column's name inside, if it is a quantity.
    pub fn column(&self) -> Option<&'static str> {
        self.quantity.map(|q| q.column)
    }

    /// Smallest and largest number; none where there is no number.
    pub fn range(&self) -> Option<(f64, f64)> {
        let finite = || self.numbers.iter().copied().filter(|x| x.is_finite());
        Some((finite().reduce(f64::min)?, finite().reduce(f64::max)?))
    }

    /// How many cells are no numbers.
    pub fn not_numbers(&self) -> usize {
        self.numbers.iter().filter(|x| !x.is_finite()).count()
    }
}

/// What a log may be.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Name of the log file.
    pub file: String,
    /// Which of its tables, where one was named.
    pub part: Option<Part>,
    /// What it needs before it is a table.
    pub format: TextFormat,
    /// Its columns, in their order.
    pub guesses: Vec<Guess>,
    /// What was measured.
    pub kind: Kind,
    /// How it was logged.
    pub sampling: Sampling,
    /// Median step of time, s, where there is a time.
    pub interval_s: Option<f64>,
    /// Number of rows.
    pub rows: usize,
}

impl Draft {
    /// Guesses what a log is from its columns.
    pub fn of(file: &str, part: Option<Part>, columns: &[Undescribed]) -> Self {
        let mut guesses: Vec<Guess> = columns.iter().map(names::guess).collect();
        magnitudes::guess(columns, &mut guesses);
        keep_first_of_each(&mut guesses);
        let rows = columns.iter().map(|c| c.numbers.len().max(c.words.len()));
        let rows = rows.max().unwrap_or(0);
        let has = |column| guesses.iter().any(|g| g.column() == Some(column));
        let interval_s = interval_s(&guesses);
        let over_time = interval_s.is_some() && rows >= FEWEST_SAMPLES;
        Self {
            kind: if has(TORQUE) || has(ANGLE) {
                Kind::KneeTorque
            } else {
                Kind::Isometric
            },
            sampling: if over_time {
                Sampling::Timeseries
            } else {
                Sampling::Points
            },
            file: file.to_owned(),
            part,
            format: TextFormat::default(),
            interval_s,
            rows,
            guesses,
        }
    }

    /// The guess of a quantity.
    pub fn quantity(&self, column: &str) -> Option<&Guess> {
        self.guesses.iter().find(|g| g.column() == Some(column))
    }

    /// The columns that this kind and sampling need and nobody was found for.
    pub fn missing(&self) -> Vec<&'static str> {
        let mut needed = match self.kind {
            Kind::Isometric => vec![FORCE, PRESSURE],
            Kind::KneeTorque => vec![TORQUE, ANGLE, PRESSURE],
        };
        if self.sampling == Sampling::Timeseries {
            needed.push(TIME);
        }
        needed.retain(|column| self.quantity(column).is_none());
        needed
    }
}

/// Of two columns that may be one quantity the first stays; the other is one of the user's own.
fn keep_first_of_each(guesses: &mut [Guess]) {
    let mut seen: Vec<&str> = Vec::new();
    for guess in guesses {
        match guess.column() {
            Some(column) if seen.contains(&column) => {
                guess.quantity = None;
                guess.unit = None;
                guess.states.clear();
                guess.doubtful = false;
                guess.why = format!("a second {column}");
            }
            Some(column) => seen.push(column),
            None => {}
        }
    }
}

fn interval_s(guesses: &[Guess]) -> Option<f64> {
    let time = guesses.iter().find(|g| g.column() == Some(TIME))?;
    let unit = time.unit?;
    magnitudes::median_step(&time.numbers).map(|step| unit.to_inside(step))
}
