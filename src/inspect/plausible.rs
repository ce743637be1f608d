//! Whether the readings of a session can be those of such an actuator at all.
//!
//! A run has nothing to compare a session with where a project has one specimen only. The published law of the diameter and the lengths noted are a
//! yardstick that is always there. Single actuators are a quarter stronger than that law, so that only what no actuator does is doubted here:
//! forces that are off by more than half of themselves, or fall where the law rises, an actuator that is stretched, and a pressure that rises in
//! the phase of venting. Which description of the columns would mend the forces is found as in [`crate::otherwise`], and only then are logs read
//! again.

use crate::files;
use crate::otherwise::{self, Otherwise, Suits};
use crate::population::{self, Known};
use pipeline_base::columns::{PHASE, TIME};
use pipeline_base::row::Row;
use pipeline_base::session::{Kind, Phase, Sampling, Session};
use pipeline_config::{CleanOptions, Config};
use pipeline_findings::ErrorKind;
use pipeline_formats::discover::Located;
use pipeline_numerics::statistics::{correlation, median, standard_deviation};
use serde::{Deserialize, Serialize};

/// Contraction below which an actuator is stretched by more than one bears: Festo allows 3% of its nominal length.
const STRETCHED: f64 = -0.05;
/// Median miss, as a share of the median force, above which the readings are no such actuator's.
const HALF: f64 = 0.5;
/// The same above which another description of the columns is looked for; there is a doubt only if one suits clearly better.
const QUARTER: f64 = 0.25;
/// Most that is then left of what is unusual about the session ([`population::Suit::off`]).
const CLEARLY: f64 = 0.5;
/// So many times the readings that are left has another description to give where these say nothing of the actuator.
const MORE: f64 = 1.2;
/// Share of F_620 that a miss, and the scatter of the expected forces, have to exceed: a slack actuator shows its zero and nothing else.
const OF_LARGEST: f64 = 0.1;
/// By so much a length may be off without a warning here, m, where the miss is below [`QUARTER`] of F_620: set lengths scatter by about 1 mm, and a
/// short actuator that is contracted hardly pulls any more within three of these.
const SET_AMISS_M: f64 = 3e-3;
/// Steps in which a length that would suit is looked for, and the largest contraction with it, of the resting length.
const STEP: f64 = 0.005;
/// See [`STEP`].
const LARGEST: f64 = 0.35;
/// Fewest readings of which a correlation says something, and fewest steps of the pressure that go the other way.
const FEWEST: usize = 5;

/// Why the readings of a session cannot be those of such an actuator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "doubt", rename_all = "snake_case")]
pub enum Doubt {
    /// The lengths noted stretch it.
    Stretched(Stretched),
    /// Its forces are not those of the published law.
    Unlike(Unlike),
    /// There are no readings, or a few of a slack actuator, and there would be with other columns.
    Lost {
        /// Readings that there are.
        left: usize,
        /// With which columns there would be more.
        columns: Otherwise,
        /// How many there would be.
        readings: usize,
    },
    /// Pressure goes the other way than the states of the phase say.
    Phases(Phases),
}

/// Steps of the pressure from reading to reading, beside the states of the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Phases {
    /// Steps to a reading of a phase in which pressure does not go so: up while venting, down while filling.
    pub against: usize,
    /// All steps.
    pub steps: usize,
}

/// An actuator that is longer than at rest by more than it bears.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stretched {
    /// Largest length of a reading, mm.
    pub length_mm: f64,
    /// Resting length noted, mm.
    pub rest_length_mm: f64,
    /// By how much the one exceeds the other, of 1.
    pub share: f64,
    /// Readings that are stretched by more than is allowed.
    pub readings: usize,
}

/// Forces that are not those of the published law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unlike {
    /// Diameter of the law, mm.
    pub diameter_mm: u32,
    /// Readings that were compared.
    pub readings: usize,
    /// Median miss of the law, N.
    pub miss_n: f64,
    /// Median force measured, N.
    pub force_n: f64,
    /// Largest force that the law gives of such an actuator, F_620, N.
    pub largest_n: f64,
    /// Correlation of measured and expected forces; none of few readings or of expected forces that hardly vary.
    pub correlation: Option<f64>,
    /// Columns with which the readings would suit the law, if any would.
    pub columns: Option<Otherwise>,
    /// Whether a shorter length than noted would suit the law, or a longer one; none where neither does. By how much is not said: readings that suit
    /// with the least change, mostly of an actuator that hardly pulls, do not tell the length.
    pub shorter: Option<bool>,
}

/// What is doubtful about a session with these readings, by the published law and its own lengths alone.
pub fn doubts(located: &Located, rows: &[Row], config: &Config) -> Vec<Doubt> {
    let session = &located.session;
    if session.kind != Kind::Isometric || session.exclude.is_some() {
        return Vec::new();
    }
    let stretched = stretched(session, rows).map(Doubt::Stretched);
    let known = Known {
        fit: config.fit.clone(),
        ..Known::default()
    };
    let of_forces = of_forces(located, rows, config, &known);
    let phases = phases(session, rows, &config.clean).map(Doubt::Phases);
    let all = [stretched, of_forces, phases];
    all.into_iter().flatten().collect()
}

/// Whether the states of the phase look exchanged: most steps of the pressure between neighbouring readings of a log go the other way. None without
/// such a column, and none of points without their time, which may stand in any order.
pub(crate) fn phases(session: &Session, rows: &[Row], options: &CleanOptions) -> Option<Phases> {
    session.column(PHASE)?;
    let are_points = session.sampling == Sampling::Points;
    if are_points {
        session.column(TIME)?;
    }
    let step = |pair: &[Row]| {
        let [before, now] = pair else { return None };
        let step_kpa = now.pressure_kpa - before.pressure_kpa;
        let is_next = before.log == now.log && (!are_points || now.time_s > before.time_s);
        let is_step = is_next && step_kpa.abs() > options.turning_kpa;
        let is_up = now.phase? == Phase::Pressurizing;
        is_step.then_some((step_kpa > 0.0) != is_up)
    };
    let steps: Vec<bool> = rows.windows(2).filter_map(step).collect();
    let against = steps.iter().filter(|against| **against).count();
    let is_exchanged = against >= FEWEST && 2 * against > steps.len();
    is_exchanged.then_some(Phases {
        against,
        steps: steps.len(),
    })
}

/// What is doubtful about the forces.
fn of_forces(located: &Located, rows: &[Row], config: &Config, known: &Known) -> Option<Doubt> {
    let session = &located.session;
    let otherwise = |readings: usize, suits: Suits| {
        let files = files(located, session);
        otherwise::best((located, session), &files, (readings, suits), config, known)
    };
    // Single actuators differ from the published law by more than from each other.
    let is_like: Suits = &|rows, _| unlike(rows, known, HALF).is_none();
    if let Some(found) = unlike(rows, known, HALF) {
        let longer_m = length_that_suits(rows, known);
        let columns = otherwise(found.readings, is_like).map(|(columns, _)| columns);
        // Exchanged columns and signs look like nothing else; of a force that hardly shows many a unit would suit.
        let is_near = longer_m.is_some_and(|m| m.abs() <= SET_AMISS_M);
        let is_unsure = columns.as_ref().is_none_or(|c| c.kind == ErrorKind::Unit);
        if is_near && is_unsure && found.miss_n < QUARTER * found.largest_n {
            return None;
        }
        return Some(Doubt::Unlike(Unlike {
            columns,
            shorter: longer_m.map(|m| m < 0.0),
            ..found
        }));
    }
    let suit = population::suit(session, rows, known).unwrap_or_default();
    if !suit.tells_gain() {
        let left = suit.readings;
        let is_more: Suits =
            &|rows, suit| is_like(rows, suit) && suit.readings as f64 > MORE * left as f64;
        let (columns, suit) = otherwise(left, is_more)?;
        return Some(Doubt::Lost {
            left,
            columns,
            readings: suit.readings,
        });
    }
    let found = unlike(rows, known, QUARTER)?;
    let is_clear: Suits =
        &|rows, other| unlike(rows, known, QUARTER).is_none() && other.off() < CLEARLY * suit.off();
    let columns = otherwise(found.readings, is_clear).map(|(columns, _)| columns);
    columns
        .is_some()
        .then_some(Doubt::Unlike(Unlike { columns, ..found }))
}

/// Whether readings are of a stretched actuator.
pub(crate) fn stretched(session: &Session, rows: &[Row]) -> Option<Stretched> {
    let stretched = rows.iter().filter(|r| is_stretched(r));
    let rest_length_m = session.specimen.rest_length_m;
    let longest = stretched
        .clone()
        .map(|r| r.length_m)
        .max_by(f64::total_cmp)?;
    Some(Stretched {
        length_mm: 1e3 * longest,
        rest_length_mm: 1e3 * rest_length_m,
        share: longest / rest_length_m - 1.0,
        readings: stretched.count(),
    })
}

fn is_stretched(row: &Row) -> bool {
    row.kind == Kind::Isometric && row.contraction < STRETCHED
}

/// Whether the forces are off the published law by more than this share of themselves, or fall where it rises; what else would suit is not asked.
/// None where no law is published.
fn unlike(rows: &[Row], known: &Known, share: f64) -> Option<Unlike> {
    let rows: Vec<&Row> = rows.iter().filter(|r| !is_stretched(r)).collect();
    let expected = population::by_law(&rows, known)?;
    let (measured, by_law): (Vec<f64>, Vec<f64>) = expected.forces.into_iter().unzip();
    let least_n = OF_LARGEST * expected.largest_n;
    let off = measured.iter().zip(&by_law).map(|(a, b)| (a - b).abs());
    let off_n = median(&off.collect::<Vec<f64>>());
    let force_n = median(&measured.iter().map(|f| f.abs()).collect::<Vec<f64>>());
    let varies = measured.len() >= FEWEST && standard_deviation(&by_law) > least_n;
    let correlation = varies.then(|| correlation(&measured, &by_law));
    let correlation = correlation.filter(|c| c.is_finite());
    let is_far = off_n > least_n && off_n > share * force_n;
    let falls = correlation.is_some_and(|c| c < 0.0);
    (is_far || falls).then_some(Unlike {
        diameter_mm: expected.diameter_mm,
        readings: measured.len(),
        miss_n: off_n,
        force_n,
        largest_n: expected.largest_n,
        correlation,
        columns: None,
        shorter: None,
    })
}

/// The least change of length with which the readings suit the law, m: positive where it makes the actuator longer.
fn length_that_suits(rows: &[Row], known: &Known) -> Option<f64> {
    let rest_length_m = rows.first()?.rest_length_m;
    let suits = |steps: i32, sign: f64| {
        let longer_m = sign * STEP * f64::from(steps) * rest_length_m;
        let with = |row: &Row| {
            let length_m = row.length_m + longer_m;
            Row {
                length_m,
                contraction: 1.0 - length_m / row.rest_length_m,
                ..row.clone()
            }
        };
        let rows: Vec<Row> = rows.iter().map(with).collect();
        let is_possible = rows.iter().all(|r| (0.0..LARGEST).contains(&r.contraction));
        is_possible && unlike(&rows, known, QUARTER).is_none()
    };
    let steps = 1..=(LARGEST / STEP) as i32;
    let mut both = steps.flat_map(|k| [(k, -1.0), (k, 1.0)]);
    both.find(|(k, sign)| suits(*k, *sign))
        .map(|(k, sign)| sign * STEP * f64::from(k) * rest_length_m)
}
