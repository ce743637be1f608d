//! The tables `[[column]]` of a truth file: quantities that are logged beside force and pressure, and their values.
//!
//! ```toml
//! [[column]]
//! name = "temperature_c"     # becomes the quantity `temperature`; any other name is an extra column
//! unit = "C"                 # optional, for extra columns
//! mean = 21
//! sd_session = 2             # drawn once for each session
//! sd_specimen = 0            # drawn once for each specimen
//! sd_log = 0                 # drawn once for each log
//! drift = 0.5                # change from the beginning of a log to its end
//! sd_row = 0.1               # noise of what is shown, row by row
//! per_session = 0            # added for each session before
//! per_run = 0                # added for each run before
//! count = "campaign"         # or "specimen": which sessions and runs come before
//! ```
//!
//! The value in a log is mean + draws + increments + drift * (part of the log that is over). Effects follow this value; the noise
//! of the rows is only in what is shown.

use super::draw::{DrawnSession, DrawnTruth};
use super::rig_settings::within;
use super::schedule::OWN_COLUMNS;
use pipeline_base::columns;
use pipeline_base::random::Stream;
use pipeline_base::toml_reader::{Entry, Section};
use serde::Serialize;

/// One logged column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnTruth {
    /// Name inside the pipeline.
    pub name: String,
    /// Unit as written to `session.toml`; empty where there is none.
    pub unit: String,
    /// Mean.
    pub mean: f64,
    /// Standard deviation between sessions.
    pub sd_session: f64,
    /// Standard deviation between specimens.
    pub sd_specimen: f64,
    /// Standard deviation between logs.
    pub sd_log: f64,
    /// Change over a log.
    pub drift: f64,
    /// Noise of a row.
    pub sd_row: f64,
    /// Increment from session to session.
    pub per_session: f64,
    /// Increment from run to run.
    pub per_run: f64,
    /// What increments count.
    pub count: Count,
}

/// What increments count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Count {
    /// Everything that was measured before.
    Campaign,
    /// What was measured before on the same specimen.
    Specimen,
}

/// The columns of a truth file, in its order; mistakes go to the table's reader.
pub fn columns(root: &Section) -> Option<Vec<ColumnTruth>> {
    let Some(entry) = root.get("column") else {
        return Some(Vec::new());
    };
    let mut list: Vec<ColumnTruth> = Vec::new();
    let mut good = true;
    for element in entry.list()? {
        match column(&element) {
            Some(c) if list.iter().any(|o| o.name == c.name) => {
                element.reject("a name of its own for each column", "rename one of them");
                good = false;
            }
            Some(c) => list.push(c),
            None => good = false,
        }
    }
    good.then_some(list)
}

fn column(entry: &Entry) -> Option<ColumnTruth> {
    let table = entry.table()?;
    let name = table
        .require("name", "the name of the column", "such as \"humidity\"")
        .and_then(|e| name(&e));
    let unit = table
        .get("unit")
        .map_or(Some(String::new()), |e| e.string());
    let words = [("campaign", Count::Campaign), ("specimen", Count::Specimen)];
    let count = table.get("count");
    let count = count.map_or(Some(Count::Campaign), |e| e.choice(&words));
    let number = |key: &'static str, low: f64| {
        let entry = table.get(key);
        entry.map_or(Some(0.0), |e| {
            within(&e, low, 1e9, "unit of the column", "0 where left out")
        })
    };
    let any = -1e9;
    let (mean, drift) = (number("mean", any), number("drift", any));
    let (per_session, per_run) = (number("per_session", any), number("per_run", any));
    let sds = ["sd_session", "sd_specimen", "sd_log", "sd_row"].map(|key| number(key, 0.0));
    table.close();
    let [sd_session, sd_specimen, sd_log, sd_row] = sds;
    Some(ColumnTruth {
        name: name?,
        unit: unit?,
        mean: mean?,
        sd_session: sd_session?,
        sd_specimen: sd_specimen?,
        sd_log: sd_log?,
        drift: drift?,
        sd_row: sd_row?,
        per_session: per_session?,
        per_run: per_run?,
        count: count?,
    })
}

/// A bare key of TOML and a cell of a header, not taken by the pipeline or the rig.
fn name(entry: &Entry) -> Option<String> {
    let name = entry.string()?;
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let taken = columns::is_reserved(&name) && name != columns::TEMPERATURE;
    let quantity = columns::by_quantity_name(&name).is_some();
    if name.is_empty() || name.len() > 40 || !name.chars().all(plain) {
        entry.reject("at most 40 letters, digits and underscores", "shorten it");
    } else if taken || quantity || OWN_COLUMNS.contains(&name.as_str()) {
        let hint = "choose another; temperature is temperature_c";
        entry.reject("a name that is not taken", hint);
    } else {
        return Some(name);
    }
    None
}

/// The columns of one log.
#[derive(Debug, Default)]
pub struct LogColumns {
    /// Value at the beginning and change to the end.
    pub(crate) lines: Vec<(f64, f64)>,
}

impl LogColumns {
    /// Draws the columns of a session's run, `run` being its place in the truth file.
    pub fn new(drawn: &DrawnTruth, session: &DrawnSession, run: usize) -> Self {
        let line = |c: &ColumnTruth| (level(drawn, session, run, c), c.drift);
        Self {
            lines: drawn.truth.columns.iter().map(line).collect(),
        }
    }

    /// Value of a column where the part `share` of the log is over.
    pub fn value(&self, k: usize, share: f64) -> f64 {
        let (level, drift) = self.lines[k];
        level + drift * share
    }

    /// What is shown of every column, each a mean of `samples` rows; `noise` is the stream of [`noise`].
    pub fn shown(
        &self,
        drawn: &DrawnTruth,
        share: f64,
        samples: f64,
        noise: &mut Stream,
    ) -> Vec<f64> {
        let columns = drawn.truth.columns.iter().enumerate();
        let shown = columns.map(|(k, c)| {
            let error = if c.sd_row > 0.0 { noise.normal() } else { 0.0 };
            self.value(k, share) + c.sd_row / samples.sqrt() * error
        });
        shown.collect()
    }
}

/// The noise of a log's columns: a stream of its own, so that a column leaves force and pressure as they were.
pub fn noise(drawn: &DrawnTruth, session: &DrawnSession, log: &str) -> Stream {
    Stream::new(drawn.truth.seed, &["columns", &session.id, log])
}

fn level(drawn: &DrawnTruth, session: &DrawnSession, run: usize, c: &ColumnTruth) -> f64 {
    let truth = &drawn.truth;
    let normal = |sd: f64, of: &[&str]| {
        let path: Vec<&str> = ["column", &c.name]
            .into_iter()
            .chain(of.iter().copied())
            .collect();
        if sd > 0.0 {
            sd * Stream::new(truth.seed, &path).normal()
        } else {
            0.0
        }
    };
    let number = truth
        .runs
        .get(run)
        .map_or(String::new(), |r| r.number.to_string());
    let before = match c.count {
        Count::Campaign => session.place,
        Count::Specimen => session.own_place,
    };
    let runs = before * truth.runs.len() + run;
    c.mean
        + normal(c.sd_session, &["session", &session.id])
        + normal(c.sd_specimen, &["specimen", &drawn.specimen(session).id])
        + normal(c.sd_log, &["log", &session.id, &number])
        + c.per_session * before as f64
        + c.per_run * runs as f64
}
