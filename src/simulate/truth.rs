//! The truth file of a simulated campaign, schema `bpa-truth/1`: what is measured, and on which rig.
//!
//! ```toml
//! schema = "bpa-truth/1"
//! campaign = "sim10"                    # id of the campaign, first part of every session's id
//! seed = 1                              # the same seed, the same bytes
//! date = "2026-01"                      # optional, as in session.toml
//! notes = "free text"                   # optional
//! diameter_mm = 10
//! coefficients = "published"            # or { b1 = 303.5, b2 = 19.03, l_0 = 0.0075, c0 = 0.5682, c1 = 4.254, c2 = 0.5597 }
//! contractions = [0, 0.25, 0.5, 0.75]   # relative contractions eps*: one session a specimen and contraction
//! runs = [8, 9, 10]
//! run_speed = [1, 0.56, 0.56]           # optional: how fast each run fills; the first run 1 and the others 0.56, as on the rig
//! sampling = "timeseries"               # or "points", with pressures_kpa = [100, 200, ...]
//!
//! [[specimen]]
//! id = "sim10-l182"
//! rest_length_mm = 182
//! contraction_max = 0.165               # eps_620; l_620 is rounded to 0.1 mm, and eps_620 is what then stands in session.toml
//! role = "holdout"                      # optional, as in session.toml
//!
//! [rig]                                 # optional: see `Rig`
//! rows = 15000
//!
//! [[column]]                            # optional: what is logged beside force and pressure, see `logged_columns`
//! name = "temperature_c"
//! mean = 21
//! sd_session = 2
//!
//! [[effect]]                            # optional: what the base model lacks, see `effect_tables` and `effects`
//! id = "series_compliance"
//! c_um_per_n = 6.0
//! ```
//!
//! Optional keys at the top: `order`, `first_date`, `days_between` (see `calendar`) and, for points, `directions`, `reading_every_s`,
//! `dwell_s`, `ramp_kpa_per_s` (see `schedule`). `truths/closed-loop-10mm.toml` is a whole example.
//!
//! The file is read strictly: an unknown key is a mistake, and all mistakes are reported at once.

use super::calendar::Calendar;
use super::coefficients::{Coefficients, read_coefficients};
use super::effect_places::Named;
use super::effect_tables::{self, EffectTruth};
use super::logged_columns::{self, ColumnTruth};
use super::rig_settings::Rig;
use super::schedule::{self, Schedule};
use super::truth_lists;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::{Role, Sampling};
use pipeline_base::toml_reader::{Entry, Reader, Section, parse};
use serde::Serialize;

/// The only schema that is understood.
pub const SCHEMA: &str = "bpa-truth/1";

/// One actuator that the campaign measures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpecimenTruth {
    /// Id in `session.toml`, and the name of its folder.
    pub id: String,
    /// l_rest, mm.
    pub rest_length_mm: f64,
    /// l_620, mm, a whole number of tenths.
    pub contracted_length_mm: f64,
    /// Role of its sessions, where one is given.
    pub role: Option<Role>,
}

/// One run of every session.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Run {
    /// Number, as declared in `session.toml`.
    pub number: i64,
    /// Factor on the share that one opening of the filling valve covers.
    pub speed: f64,
}

/// A checked truth file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Id of the campaign.
    pub campaign: String,
    /// Seed of every random number.
    pub seed: u64,
    /// ISO 8601, day or month.
    pub date: Option<String>,
    /// Free text.
    pub notes: Option<String>,
    /// 10, 20 or 40.
    pub diameter_mm: u32,
    /// Coefficients of the force model.
    pub coefficients: Coefficients,
    /// Relative contractions.
    pub contractions: Vec<f64>,
    /// Runs of every session.
    pub runs: Vec<Run>,
    /// Logs over time, or steady readings.
    pub sampling: Sampling,
    /// The schedule of steady readings.
    pub schedule: Schedule,
    /// Order and dates of the sessions.
    pub calendar: Calendar,
    /// The actuators.
    pub specimens: Vec<SpecimenTruth>,
    /// The rig.
    pub rig: Rig,
    /// What is logged beside force and pressure.
    pub columns: Vec<ColumnTruth>,
    /// What the base model lacks.
    pub effects: Vec<EffectTruth>,
}

impl SpecimenTruth {
    /// eps_620 as it follows from the two lengths.
    pub fn contraction_max(&self) -> f64 {
        (self.rest_length_mm - self.contracted_length_mm) / self.rest_length_mm
    }
}

/// Reads and checks the text of a truth file; messages call it `file`.
///
/// # Errors
/// Every mistake of the file, in the order of its lines.
pub fn read_truth(file: &str, text: &str) -> Result<Truth, Vec<Diagnostic>> {
    let table = parse(file, text).map_err(|d| vec![d])?;
    let reader = Reader::new(file, text);
    let truth = truth(&reader.root(&table));
    let mistakes = reader.finish();
    match truth {
        Some(truth) if mistakes.is_empty() => Ok(truth),
        _ => Err(mistakes),
    }
}

fn truth(root: &Section) -> Option<Truth> {
    if let Some(entry) = root.require("schema", SCHEMA, "write schema = \"bpa-truth/1\"") {
        entry.choice(&[(SCHEMA, ())]);
    }
    let campaign = truth_lists::identifier(root, "campaign", "an id for the campaign");
    let seed = root
        .require(
            "seed",
            "a whole number from 0",
            "the same seed gives the same bytes",
        )
        .and_then(|e| seed(&e));
    let date = root.get("date").and_then(|e| truth_lists::date(&e));
    let notes = root.get("notes").and_then(|e| e.string());
    let diameter = root
        .require("diameter_mm", "10, 20 or 40", "say which size is simulated")
        .and_then(|e| diameter(&e));
    let coefficients = root
        .require(
            "coefficients",
            "\"published\" or a table",
            "write coefficients = \"published\"",
        )
        .and_then(|e| read_coefficients(&e, diameter));
    let contractions = truth_lists::contractions(root);
    let runs = truth_lists::runs(root);
    let sampling = sampling(root);
    let pressures = truth_lists::pressures(root, sampling);
    let specimens = truth_lists::specimens(root);
    let rig_table = root.get("rig").and_then(|e| e.table());
    let mm = diameter.unwrap_or(10);
    let rig = rig_table.map_or_else(|| Rig::for_diameter(mm), |t| Rig::read(&t, mm));
    let calendar = Calendar::read(root, date.is_some());
    let schedule = schedule_of(root, sampling, pressures, runs.as_deref());
    let columns = logged_columns::columns(root);
    let named = Named {
        campaign: campaign.as_deref().unwrap_or_default(),
        specimens: specimens.as_deref(),
        contractions: contractions.as_deref(),
        columns: columns.as_deref(),
    };
    let effects = effect_tables::effects(root, &named);
    root.close();
    let truth = Truth {
        campaign: campaign?,
        seed: seed?,
        date,
        notes,
        diameter_mm: diameter?,
        coefficients: coefficients?,
        contractions: contractions?,
        runs: runs?,
        sampling: sampling?,
        schedule: schedule?,
        calendar: calendar?,
        specimens: specimens?,
        rig,
        columns: columns?,
        effects: effects?,
    };
    truth_lists::check_rig(root, &truth);
    Some(truth)
}

/// How the campaign is logged.
fn sampling(root: &Section) -> Option<Sampling> {
    let words = [
        ("timeseries", Sampling::Timeseries),
        ("points", Sampling::Points),
    ];
    root.require("sampling", "timeseries or points", "say how it is logged")
        .and_then(|e| e.choice(&words))
}

/// The schedule of set points; none where what it needs is mistaken.
fn schedule_of(
    root: &Section,
    sampling: Option<Sampling>,
    pressures: Option<Vec<f64>>,
    runs: Option<&[Run]>,
) -> Option<Schedule> {
    let Some(((sampling, pressures), runs)) = sampling.zip(pressures).zip(runs) else {
        schedule::pass(root);
        return None;
    };
    Schedule::read(root, pressures, sampling, runs)
}

fn seed(entry: &Entry) -> Option<u64> {
    let seed = u64::try_from(entry.integer()?).ok();
    if seed.is_none() {
        entry.reject("a whole number from 0", "leave out the sign");
    }
    seed
}

fn diameter(entry: &Entry) -> Option<u32> {
    let mm = entry.number()?;
    let known = [10_u32, 20, 40].into_iter().find(|d| f64::from(*d) == mm);
    if known.is_none() {
        entry.reject("10, 20 or 40 (mm)", "write the uninflated inner diameter");
    }
    known
}
