//! What a campaign draws before anything is measured: the specimens' gains, and each session's zeros and pressures.

use super::chain::{Actuator, Channel};
use super::effect_draws::{DrawnEffect, effects};
use super::staircase::Air;
use super::truth::{Run, SpecimenTruth, Truth};
use super::truth_lists::contraction_label;
use pipeline_base::random::Stream;
use pipeline_base::session::Sampling;
use serde::Serialize;

/// Schema of the file that tells the truth.
pub const SCHEMA: &str = "bpa-drawn-truth/1";

/// One session, before it is measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnSession {
    /// Id in `session.toml`.
    pub id: String,
    /// Folder below the campaign's, with a forward slash.
    pub folder: String,
    /// Place in [`DrawnTruth::sessions`].
    pub number: usize,
    /// Place in time: the sessions of the campaign that were measured before.
    pub place: usize,
    /// The sessions of the same specimen that were measured before.
    pub own_place: usize,
    /// Date in `session.toml`.
    pub date: Option<String>,
    /// The specimen's place in the truth file, counted from 0.
    pub specimen: usize,
    /// eps*, as the truth file has it; the length held is rounded to 0.01 mm.
    pub contraction_rel: f64,
    /// Length held, mm.
    pub length_mm: f64,
    /// Factor on the specimen's F_620: the same in all its sessions.
    pub gain: f64,
    /// F_620 of this specimen, gain included, N.
    pub f620_n: f64,
    /// Zero of the force channel, N; 0 for steady readings, which are taken with a tared display.
    pub force_zero_n: f64,
    /// Pressure that filling approaches, kPa.
    pub supply_kpa: f64,
    /// Pressure that venting approaches, kPa.
    pub floor_kpa: f64,
}

/// Everything that the logs do not say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnTruth {
    /// `bpa-drawn-truth/1`.
    pub schema: &'static str,
    /// The truth file as it was read, defaults included.
    pub truth: Truth,
    /// The sessions in the order in which they are written.
    pub sessions: Vec<DrawnSession>,
    /// The effects of the truth file, in its order, with their sizes as drawn.
    pub effects: Vec<DrawnEffect>,
}

impl DrawnTruth {
    /// Draws the sessions of a truth file: specimens in its order, and their contractions in its order.
    pub fn new(truth: &Truth) -> Self {
        let specimens = 0..truth.specimens.len();
        let mut sessions: Vec<DrawnSession> = specimens
            .flat_map(|k| {
                truth
                    .contractions
                    .iter()
                    .map(move |c| session(truth, k, *c))
            })
            .collect();
        place_in_time(truth, &mut sessions);
        let effects = effects(truth, &sessions);
        Self {
            schema: SCHEMA,
            truth: truth.clone(),
            sessions,
            effects,
        }
    }

    /// The specimen of a session.
    pub fn specimen(&self, session: &DrawnSession) -> &SpecimenTruth {
        &self.truth.specimens[session.specimen]
    }

    /// The specimen of a session, as far as its static force is concerned.
    pub fn actuator(&self, session: &DrawnSession) -> Actuator {
        let specimen = self.specimen(session);
        Actuator {
            surface: self.truth.coefficients.c,
            f620_n: session.f620_n,
            diameter_mm: f64::from(self.truth.diameter_mm),
            rest_length_m: specimen.rest_length_mm * 1e-3,
            contracted_length_m: specimen.contracted_length_mm * 1e-3,
        }
    }

    /// The force channel of a session.
    pub fn force_channel(&self, session: &DrawnSession) -> Channel {
        let rig = &self.truth.rig;
        Channel {
            zero: session.force_zero_n,
            noise_sd: rig.force_noise_n,
            quantum: rig.force_quantum_n,
            clip: rig.force_clip_n,
        }
    }

    /// The pressure channel, the same in all sessions.
    pub fn pressure_channel(&self) -> Channel {
        let rig = &self.truth.rig;
        Channel {
            zero: rig.pressure_zero_kpa,
            noise_sd: rig.pressure_noise_kpa,
            quantum: rig.pressure_quantum_kpa,
            clip: rig.pressure_clip_kpa,
        }
    }
}

impl DrawnSession {
    /// The air of one of its runs.
    pub fn air(&self, run: Run) -> Air {
        Air {
            supply_kpa: self.supply_kpa,
            floor_kpa: self.floor_kpa,
            speed: run.speed,
        }
    }
}

fn place_in_time(truth: &Truth, sessions: &mut [DrawnSession]) {
    let places = truth.calendar.places(truth.seed, sessions.len());
    let before = |k: usize, specimen_of: &[usize]| {
        let earlier = |j: &usize| specimen_of[*j] == specimen_of[k] && places[*j] < places[k];
        (0..places.len()).filter(earlier).count()
    };
    let specimen_of: Vec<usize> = sessions.iter().map(|s| s.specimen).collect();
    for (number, session) in sessions.iter_mut().enumerate() {
        session.number = number;
        session.place = places[number];
        session.own_place = before(number, &specimen_of);
        session.date = truth
            .date
            .clone()
            .or_else(|| truth.calendar.date(session.place));
    }
}

fn session(truth: &Truth, k: usize, contraction: f64) -> DrawnSession {
    let specimen = &truth.specimens[k];
    let label = contraction_label(contraction);
    let id = format!("{}-{}-{label}", truth.campaign, specimen.id);
    let shortening = specimen.rest_length_mm - specimen.contracted_length_mm;
    let length = specimen.rest_length_mm - contraction * shortening;
    let scatter = Stream::new(truth.seed, &["specimen", &specimen.id]).normal();
    let gain = (1.0 + truth.rig.specimen_scatter * scatter).max(0.1);
    let mut stream = Stream::new(truth.seed, &["session", &id]);
    let zero = truth.rig.zero_mean_n + truth.rig.zero_sd_n * stream.normal();
    let supply_kpa = truth.rig.supply_kpa + truth.rig.supply_sd_kpa * stream.normal();
    let floor = truth.rig.floor_kpa + truth.rig.floor_sd_kpa * stream.normal();
    let tared = truth.sampling == Sampling::Points;
    DrawnSession {
        folder: format!("{}/{label}", specimen.id),
        id,
        number: 0,
        place: 0,
        own_place: 0,
        date: None,
        specimen: k,
        contraction_rel: contraction,
        length_mm: (100.0 * length).round() / 100.0,
        gain,
        f620_n: gain * truth.coefficients.f620(specimen.rest_length_mm * 1e-3),
        force_zero_n: if tared { 0.0 } else { zero },
        supply_kpa,
        floor_kpa: floor.clamp(0.0, supply_kpa),
    }
}
