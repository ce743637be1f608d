//! The readings of a campaign, and their rows as the stage normalize gives them.

use super::draw::{COLUMNS, Drawn, SetUp};
use super::forward::{Departure, Forward, Place};
use super::schedule::instants;
use super::{CAMPAIGN, DIAMETER_MM, Settings};
use pipeline_base::columns::{FORCE, LENGTH, PRESSURE, TIME};
use pipeline_base::normalized;
use pipeline_base::reading::Reading;
use pipeline_base::row::Row;
use pipeline_base::session::{Constant, Kind, Sampling, Session, Specimen};
use std::collections::BTreeMap;

/// One reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// Session, run, when; the pressure is the true one plus the error of the reading: what an error-free sensor would have to show for
    /// the pressure that was read.
    pub place: Place,
    /// Number in its log.
    pub number: usize,
    /// As the sensor shows it, kPa.
    pub pressure_kpa: f64,
    /// As the sensor shows it, N.
    pub force_n: f64,
    /// What the generating model expects of a specimen and session that it has not seen, at the pressure as read, N.
    pub expected_force_n: f64,
}

/// Samples that make a reading, and what they scatter by, N: as in the laboratory's logs.
const SAMPLES: (i64, f64) = (25, 0.8);
/// Noise of the logged columns.
const COLUMN_NOISE: [f64; 3] = [0.05, 0.3, 0.0];

/// Takes the readings: sessions and runs in their order, then time.
pub fn measure(seed: u64, settings: &Settings, drawn: &Drawn) -> Vec<Taken> {
    let forward = Forward::new(settings, drawn, &settings.effects);
    let mut taken = Vec::new();
    for (k, setup) in drawn.setups.iter().enumerate() {
        for run in 0..settings.pace.runs() {
            let path = ["noise", &setup.id, &run.to_string()];
            let mut noise = settings.family.stream(seed, &path);
            let list = instants(seed, settings, &setup.id, run);
            taken.extend(list.into_iter().enumerate().map(|(number, at)| {
                let place = Place { setup: k, run, at };
                let errors = [noise.normal(), noise.normal()];
                read(&forward, drawn, place, number, errors)
            }));
        }
    }
    taken
}

fn read(
    forward: &Forward,
    drawn: &Drawn,
    place: Place,
    number: usize,
    [of_force, of_pressure]: [f64; 2],
) -> Taken {
    let setup = &drawn.setups[place.setup];
    let own = own(drawn, setup, place.at.pressure_kpa);
    let force_n = forward.force(&place, &own) + drawn.sizes.noise_n * of_force;
    let mut as_read = place;
    as_read.at.pressure_kpa += drawn.sizes.noise_kpa * of_pressure;
    Taken {
        place: as_read,
        number,
        pressure_kpa: forward.sensed_pressure(&place, as_read.at.pressure_kpa),
        force_n,
        expected_force_n: forward.force(&as_read, &Departure::default()),
    }
}

/// How a session departs from what is recorded of it.
fn own(drawn: &Drawn, setup: &SetUp, pressure_kpa: f64) -> Departure {
    let muscle = &drawn.muscles[setup.muscle];
    let functions = drawn.misfit.along(pressure_kpa);
    let misfit: f64 = functions
        .iter()
        .zip(&setup.weights)
        .map(|(f, w)| f * w)
        .sum();
    Departure {
        gain: muscle.gain,
        rest_mm: muscle.rest_error_mm,
        contracted_mm: muscle.contracted_error_mm,
        length_mm: setup.length_error_mm,
        zero_n: setup.zero_n,
        misfit: drawn.sizes.session * misfit,
    }
}

/// The rows of the readings.
pub fn rows(seed: u64, settings: &Settings, drawn: &Drawn, taken: &[Taken]) -> Vec<Row> {
    let sessions: Vec<Session> = drawn.setups.iter().map(|s| session(drawn, s)).collect();
    let forward = Forward::new(settings, drawn, &[]);
    let row = |t: &Taken| {
        normalized::row(
            &sessions[t.place.setup],
            &reading(seed, settings, drawn, &forward, t),
        )
    };
    taken.iter().map(row).collect()
}

/// The session as its `session.toml` would be read, its logs and columns aside.
fn session(drawn: &Drawn, setup: &SetUp) -> Session {
    let muscle = &drawn.muscles[setup.muscle];
    let length = Constant::Number(1e-3 * setup.length_mm);
    // Months of 28 days: every place in time has a date.
    let (month, day) = (1 + setup.place / 28, 1 + setup.place % 28);
    Session {
        id: setup.id.clone(),
        kind: Kind::Isometric,
        sampling: Sampling::Timeseries,
        campaign: CAMPAIGN.to_owned(),
        date: Some(format!("2026-{month:02}-{day:02}")),
        role: None,
        exclude: None,
        notes: Some("simulated".to_owned()),
        specimen: Specimen {
            id: muscle.id.clone(),
            diameter_mm: f64::from(DIAMETER_MM),
            rest_length_m: 1e-3 * muscle.rest_mm,
            contracted_length_m: 1e-3 * muscle.contracted_mm,
            rest_length_sd_m: None,
            contracted_length_sd_m: None,
        },
        setup: BTreeMap::from([(LENGTH.to_owned(), length)]),
        length_sd_m: None,
        joint: None,
        format: Default::default(),
        columns: Vec::new(),
        logs: Vec::new(),
    }
}

fn reading(
    seed: u64,
    settings: &Settings,
    drawn: &Drawn,
    forward: &Forward,
    taken: &Taken,
) -> Reading {
    let at = &taken.place.at;
    let mut values = BTreeMap::from([
        (PRESSURE.to_owned(), taken.pressure_kpa),
        (FORCE.to_owned(), taken.force_n),
        (TIME.to_owned(), at.time_s),
    ]);
    let own = settings.pace.column(at);
    values.extend(own.map(|(name, x)| (name.to_owned(), x)));
    values.extend(columns(seed, settings, drawn, forward, taken));
    let line = 1 + 100 * taken.number as i64;
    Reading {
        log: format!("run{}.csv", taken.place.run + 1),
        run: Some(taken.place.run as i64 + 1),
        first_row: line,
        last_row: line + SAMPLES.0 - 1,
        phase: Some(at.phase),
        samples: SAMPLES.0,
        sd_force_n: SAMPLES.1,
        zero_force_n: f64::NAN,
        zero_pressure_kpa: f64::NAN,
        sd_pressure_kpa: drawn.sizes.noise_kpa,
        values,
        labels: BTreeMap::new(),
    }
}

/// The logged columns as they are shown.
fn columns(
    seed: u64,
    settings: &Settings,
    drawn: &Drawn,
    forward: &Forward,
    taken: &Taken,
) -> Vec<(String, f64)> {
    let place = &taken.place;
    let setup = &drawn.setups[place.setup];
    let (run, number) = (place.run.to_string(), taken.number.to_string());
    let mut noise = settings
        .family
        .stream(seed, &["column noise", &setup.id, &run, &number]);
    let logged = forward.columns(place.setup);
    let shown = COLUMNS.iter().zip(COLUMN_NOISE).enumerate();
    shown
        .map(|(k, ((name, _), sd))| {
            let value = logged.value(k, place.at.share) + sd * noise.normal();
            ((*name).to_owned(), value)
        })
        .collect()
}
