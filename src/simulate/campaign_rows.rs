//! A campaign as normalised rows, without files: what ingest, clean and normalize would make of it, in a few milliseconds.
//!
//! The readings are those of [`super::steady`]; the row of a reading is made by [`pipeline_base::normalized`], as in the stage normalize.

use super::draw::{DrawnSession, DrawnTruth};
use super::session_file::{log_name, notes};
use super::steady::{self, SteadyRow, sample_sd};
use super::truth::Truth;
use pipeline_base::columns::{FORCE, LENGTH, PRESSURE, TIME};
use pipeline_base::normalized;
use pipeline_base::reading::Reading;
use pipeline_base::row::Row;
use pipeline_base::session::{Constant, Kind, Sampling, Session, Specimen};
use std::collections::BTreeMap;

/// A campaign as rows.
#[derive(Clone, Debug)]
pub struct CampaignRows {
    /// What the rows do not say.
    pub drawn: DrawnTruth,
    /// The rows, as the stage normalize gives them.
    pub rows: Vec<Row>,
    /// The reading behind each row, with the forces of the generating model.
    pub readings: Vec<SteadyRow>,
}

/// Measures a campaign and gives its rows.
pub fn campaign_rows(truth: &Truth) -> CampaignRows {
    let (drawn, readings) = steady::rows(truth);
    let sessions: Vec<Session> = drawn.sessions.iter().map(|s| session(&drawn, s)).collect();
    let row = |r: &SteadyRow| normalized::row(&sessions[r.session], &reading(&drawn, r));
    let rows = readings.iter().map(row).collect();
    CampaignRows {
        drawn,
        rows,
        readings,
    }
}

/// The session as its `session.toml` would be read, its logs and columns aside.
fn session(drawn: &DrawnTruth, session: &DrawnSession) -> Session {
    let (truth, specimen) = (&drawn.truth, drawn.specimen(session));
    let length = Constant::Number(session.length_mm * 1e-3);
    Session {
        id: session.id.clone(),
        kind: Kind::Isometric,
        sampling: truth.sampling,
        campaign: truth.campaign.clone(),
        date: session.date.clone(),
        role: specimen.role,
        exclude: None,
        notes: Some(notes(truth)),
        specimen: Specimen {
            id: specimen.id.clone(),
            diameter_mm: f64::from(truth.diameter_mm),
            rest_length_m: specimen.rest_length_mm * 1e-3,
            contracted_length_m: specimen.contracted_length_mm * 1e-3,
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

fn reading(drawn: &DrawnTruth, row: &SteadyRow) -> Reading {
    let truth = &drawn.truth;
    let (rig, run) = (&truth.rig, truth.runs[row.run].number);
    let over_time = truth.sampling == Sampling::Timeseries;
    let mut values = BTreeMap::from([
        (PRESSURE.to_owned(), row.pressure_kpa),
        (FORCE.to_owned(), row.force_n),
    ]);
    if over_time || truth.schedule.has_clock() {
        values.insert(TIME.to_owned(), row.at.time_s);
    }
    let own = truth.schedule.own_column();
    let own = own.zip(truth.schedule.own_value(&row.at));
    values.extend(own.map(|(name, x)| (name.to_owned(), x)));
    let extras = truth.columns.iter().zip(&row.columns);
    values.extend(extras.map(|(c, x)| (c.name.clone(), *x)));
    let (samples, first_row) = if over_time {
        let samples = steady::samples(truth);
        let middle = 1e3 * row.at.time_s / rig.interval_ms;
        (samples as i64, (middle - 0.5 * samples) as i64 + 1)
    } else {
        // The header is line 1.
        (1, row.number as i64 + 2)
    };
    let sd = |noise: f64, quantum: f64| {
        if over_time {
            sample_sd(noise, quantum)
        } else {
            f64::NAN
        }
    };
    Reading {
        log: log_name(truth.sampling, run),
        run: Some(run),
        first_row,
        last_row: first_row + samples - 1,
        phase: (over_time || truth.schedule.both_directions).then_some(row.at.phase),
        samples,
        sd_force_n: sd(rig.force_noise_n, rig.force_quantum_n),
        zero_force_n: f64::NAN,
        zero_pressure_kpa: f64::NAN,
        sd_pressure_kpa: sd(rig.pressure_noise_kpa, rig.pressure_quantum_kpa),
        values,
        labels: BTreeMap::new(),
    }
}
