//! The readings of one campaign as the search sees them: numbers, groups, and what is known of each reading.

mod extras;
mod histories;
mod origins;
mod placebo;

pub use extras::{Extra, ZERO_UNKNOWN};
pub use origins::Origins;
pub use placebo::PLACEBO;

use super::base::Base;
use super::labels;
use pipeline_base::columns::TEMPERATURE;
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_base::session::Phase;
use pipeline_effects::{Conditions, Need};
use pipeline_inference::decisions::STANDS_OUT;
use pipeline_numerics::statistics::sd_by_median;
use std::collections::{BTreeMap, BTreeSet};

/// A zero that differs from the campaign's median by no more than this, N, is drift.
const LARGEST_DRIFT_N: f64 = 3.0;

/// The readings of a campaign.
#[derive(Clone, Debug, Default)]
pub struct Data {
    /// What is known of each reading.
    pub conditions: Vec<Conditions>,
    /// Place of the reading among the rows that the data were made of.
    pub place: Vec<usize>,
    /// Measured force, N.
    pub force: Vec<f64>,
    /// Place of the reading's session in `sessions`.
    pub session: Vec<usize>,
    /// Place of the reading's specimen in `specimens`.
    pub specimen: Vec<usize>,
    /// A number for the log, unique over the campaign.
    pub log: Vec<usize>,
    /// Place of the reading's campaign in `campaigns`.
    pub campaign: Vec<usize>,
    /// Campaign ids, by name.
    pub campaigns: Vec<String>,
    /// Session ids, in the order of time (date, then id).
    pub sessions: Vec<String>,
    /// Date of each session; empty where it has none.
    pub dates: Vec<String>,
    /// Specimen ids, by name.
    pub specimens: Vec<String>,
    /// Extra columns.
    pub extras: Vec<Extra>,
    /// Why a quantity is not known.
    pub missing: BTreeMap<Need, String>,
    /// Columns of words that are not searched, and why.
    pub notes: Vec<String>,
    /// What each session's zero log shows of the pressure, kPa; not a number where there is none.
    pub zero_pressure_kpa: Vec<f64>,
    /// Declared standard deviation of each session's set length, mm; not a number where none is declared.
    pub set_length_sd_mm: Vec<f64>,
    /// The same of each specimen's resting and contracted length.
    pub specimen_lengths_sd_mm: Vec<[f64; 2]>,
    /// What conditions are counted from.
    pub origins: Origins,
}

impl Data {
    /// The readings of rows that are usable (the caller sees to that).
    pub fn new(rows: &[&Row]) -> Self {
        let (dates, sessions) = sessions_by_time(rows);
        // A session without a date has no place in time.
        let is_dated = dates.iter().all(|d| !d.is_empty()) && dates.first() != dates.last();
        let campaigns: BTreeSet<&str> = rows.iter().map(|r| r.campaign.as_str()).collect();
        let campaigns: Vec<String> = campaigns.into_iter().map(str::to_owned).collect();
        let of_specimen: Vec<String> = rows
            .iter()
            .map(|r| specimen_id(r, campaigns.len() > 1))
            .collect();
        let specimens: BTreeSet<&String> = of_specimen.iter().collect();
        let specimens: Vec<String> = specimens.into_iter().cloned().collect();
        let place = |list: &[String], id: &str| list.iter().position(|x| x == id).unwrap_or(0);
        let mut data = Data {
            place: (0..rows.len()).collect(),
            force: rows.iter().map(|r| r.force_n).collect(),
            session: rows.iter().map(|r| place(&sessions, &r.session)).collect(),
            specimen: of_specimen.iter().map(|s| place(&specimens, s)).collect(),
            campaign: rows
                .iter()
                .map(|r| place(&campaigns, &r.campaign))
                .collect(),
            campaigns,
            sessions,
            dates,
            specimens,
            ..Data::default()
        };
        data.log = log_numbers(rows, &data.session);
        data.origins = Origins::of(rows, &data, is_dated);
        data.conditions = conditions(rows, &data, is_dated);
        data.extras = extras::extras(rows, &data);
        data.extras.extend(extras::zero_unknown(rows, &data));
        data.zero_pressure_kpa = zero_pressures(rows, &data);
        data.note_what_is_declared(rows);
        data.note_what_is_missing(is_dated);
        let (labels, notes) = labels::labels(rows, &data);
        data.extras.extend(labels);
        data.notes = notes;
        data
    }

    /// Resting length of every specimen, mm.
    pub fn rest_lengths_mm(&self) -> Vec<f64> {
        let mut lengths = vec![f64::NAN; self.specimens.len()];
        for (k, at) in self.specimen.iter().zip(&self.conditions) {
            lengths[*k] = 1e3 * at.rest_length_m;
        }
        lengths
    }

    /// Whether somebody declared how well the contracted length of a specimen is known.
    pub fn contracted_is_declared(&self, specimen: usize) -> bool {
        self.specimen_lengths_sd_mm[specimen][1].is_finite()
    }

    /// The contractions at 620 kPa that are noted of specimens whose contracted length nobody declares; none of the others.
    pub fn noted_contractions(&self) -> Vec<Option<f64>> {
        let mut noted = vec![None; self.specimens.len()];
        for (k, at) in self.specimen.iter().zip(&self.conditions) {
            if !self.contracted_is_declared(*k) {
                noted[*k] = Some(contraction_620(at));
            }
        }
        noted
    }

    /// Notes the declared standard deviations of lengths.
    fn note_what_is_declared(&mut self, rows: &[&Row]) {
        self.set_length_sd_mm = vec![f64::NAN; self.sessions.len()];
        self.specimen_lengths_sd_mm = vec![[f64::NAN; 2]; self.specimens.len()];
        for (i, r) in rows.iter().enumerate() {
            // The smallest that any session declares; a session that declares none (not a number) takes nothing back.
            let of_session = &mut self.set_length_sd_mm[self.session[i]];
            *of_session = of_session.min(1e3 * r.length_sd_m);
            let [rest, contracted] = &mut self.specimen_lengths_sd_mm[self.specimen[i]];
            *rest = rest.min(1e3 * r.rest_length_sd_m);
            *contracted = contracted.min(1e3 * r.contracted_length_sd_m);
        }
    }

    /// What the zero logs show of the pressure, one value a session that has one, rising, kPa.
    pub fn zero_pressures(&self) -> Vec<f64> {
        let known = self.zero_pressure_kpa.iter().copied();
        let mut known: Vec<f64> = known.filter(|p| p.is_finite()).collect();
        known.sort_by(f64::total_cmp);
        known
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
            place: pick(&self.place),
            force: places.iter().map(|&i| self.force[i]).collect(),
            session: pick(&self.session),
            specimen: pick(&self.specimen),
            log: pick(&self.log),
            campaign: pick(&self.campaign),
            campaigns: self.campaigns.clone(),
            sessions: self.sessions.clone(),
            dates: self.dates.clone(),
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
            zero_pressure_kpa: self.zero_pressure_kpa.clone(),
            set_length_sd_mm: self.set_length_sd_mm.clone(),
            specimen_lengths_sd_mm: self.specimen_lengths_sd_mm.clone(),
            origins: self.origins.clone(),
        }
    }

    /// Readings that were no part of a campaign, with conditions that are counted from its origins.
    pub fn counted_from(rows: &[&Row], origins: &Origins) -> Self {
        let mut data = Self::new(rows);
        data.origins = origins.clone();
        data.conditions = conditions(rows, &data, origins.is_dated());
        data
    }

    /// Number of the stroke of each reading, the filling or the venting of one log.
    pub fn strokes(&self) -> Vec<usize> {
        let mut numbers = BTreeMap::new();
        let keys = self.log.iter().zip(&self.conditions);
        keys.map(|(log, at)| {
            let next = numbers.len();
            *numbers.entry((*log, at.direction < 0.0)).or_insert(next)
        })
        .collect()
    }

    /// At most so many readings: of every session an equal share, one from each of so many stretches of it. Which one is drawn, because evenly
    /// spaced readings would always be those of the same set points.
    pub fn thinned(&self, most: usize) -> Data {
        let mut of_session: Vec<Vec<usize>> = vec![Vec::new(); self.sessions.len()];
        for (i, s) in self.session.iter().enumerate() {
            of_session[*s].push(i);
        }
        let share = (most / self.sessions.len().max(1)).max(8);
        let mut stream = Stream::new(0, &["thinned"]);
        let mut places: Vec<usize> = of_session
            .into_iter()
            .flat_map(|list| {
                if list.len() <= share {
                    return list;
                }
                let from = |k: usize| k * list.len() / share;
                (0..share)
                    .map(|k| list[from(k) + stream.below(from(k + 1) - from(k))])
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

    /// The same beside a base law: what it fits itself is no effect.
    pub fn beside(mut self, base: &Base) -> Self {
        if base.fits_length_law() {
            let need = Need::LengthLaw;
            self.missing
                .insert(need, format!("the search lacks {}", need.text()));
        }
        self
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
            (
                Need::LaterFillings,
                self.conditions
                    .iter()
                    .any(|c| c.direction > 0.0 && !c.first_filling),
            ),
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
            .map(|(need, _)| (need, format!("the campaign lacks {}", need.text())))
            .collect();
    }
}

/// The contraction at 620 kPa that is noted of the actuator of a reading.
pub(crate) fn contraction_620(at: &Conditions) -> f64 {
    (at.rest_length_m - at.contracted_length_m) / at.rest_length_m
}

/// The temperature at a reading; not a number where there is none.
fn temperature(row: &Row) -> f64 {
    row.extras.get(TEMPERATURE).copied().unwrap_or(f64::NAN)
}

/// Dates and ids of the sessions of some rows, in the order of time.
fn sessions_by_time(rows: &[&Row]) -> (Vec<String>, Vec<String>) {
    let mut by_time: Vec<(&str, &str)> = rows
        .iter()
        .map(|r| (r.date.as_deref().unwrap_or(""), r.session.as_str()))
        .collect();
    by_time.sort_unstable();
    by_time.dedup();
    let own = |(date, id): (&str, &str)| (date.to_owned(), id.to_owned());
    by_time.into_iter().map(own).unzip()
}

/// A number for the log of each row, whose sessions are given.
fn log_numbers(rows: &[&Row], session: &[usize]) -> Vec<usize> {
    let logs_of_rows = rows.iter().map(|r| r.log.as_str());
    let of_rows: Vec<(usize, &str)> = session.iter().copied().zip(logs_of_rows).collect();
    let logs: BTreeSet<(usize, &str)> = of_rows.iter().copied().collect();
    let logs: BTreeMap<(usize, &str), usize> = logs
        .into_iter()
        .enumerate()
        .map(|(k, log)| (log, k))
        .collect();
    of_rows.iter().map(|log| logs[log]).collect()
}

/// Id of the specimen of a row; in a pool with that of its campaign, because two laboratories may name theirs alike.
pub fn specimen_id(row: &Row, pooled: bool) -> String {
    if pooled {
        format!("{} {}", row.campaign, row.specimen)
    } else {
        row.specimen.clone()
    }
}

fn conditions(rows: &[&Row], data: &Data, dated: bool) -> Vec<Conditions> {
    let origins = &data.origins;
    let cycles_before = histories::cycles_before(data, dated);
    let zero_if_nan = |x: f64| if x.is_finite() { x } else { 0.0 };
    let less = |x: f64, origin: Option<f64>| origin.map_or(0.0, |o| zero_if_nan(x - o));
    let mut conditions: Vec<Conditions> = rows
        .iter()
        .enumerate()
        .map(|(i, r)| Conditions {
            pressure_kpa: r.pressure_kpa,
            length_m: r.length_m,
            rest_length_m: r.rest_length_m,
            contracted_length_m: r.contracted_length_m,
            diameter_mm: r.diameter_mm,
            middle_rest_length_m: origins.middle_rest_length_m,
            direction: match r.phase {
                Some(Phase::Pressurizing) => 1.0,
                Some(Phase::Depressurizing) => -1.0,
                None => 0.0,
            },
            log_time_s: zero_if_nan(r.time_s),
            campaign_time: origins.campaign_time(&r.session),
            moved: 0.0,
            highest_kpa: r.pressure_kpa,
            first_filling: false,
            since_step_s: 0.0,
            rate_kpa_per_s: 0.0,
            temperature_c: less(temperature(r), origins.mean_temperature_c),
            zero_force_n: less(r.zero_force_n, origins.usual_zero_n),
            cycles: histories::counted_cycles(r).unwrap_or(cycles_before[data.log[i]]),
            pulls: false,
        })
        .collect();
    histories::histories(rows, data, &mut conditions);
    conditions
}

impl Data {
    /// Whether the zero that was taken off differs in some sessions from that of the others by more than zeros wander.
    fn zeros_stand_out(&self) -> bool {
        let mut zeros = vec![0.0; self.sessions.len()];
        for (c, s) in self.conditions.iter().zip(&self.session) {
            zeros[*s] = c.zero_force_n.abs();
        }
        let least = LARGEST_DRIFT_N.max(STANDS_OUT * sd_by_median(&zeros));
        zeros.iter().any(|z| *z > least)
    }
}

/// What each session's zero log shows of the pressure, kPa.
fn zero_pressures(rows: &[&Row], data: &Data) -> Vec<f64> {
    let mut of_session = vec![f64::NAN; data.sessions.len()];
    for (r, s) in rows.iter().zip(&data.session) {
        of_session[*s] = r.zero_pressure_kpa;
    }
    of_session
}
