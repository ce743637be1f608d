//! What a session is: the contents of a `session.toml`, checked and in the units used inside.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Axial force at a held length.
    Isometric,
    /// Torque about a knee.
    KneeTorque,
}

/// How the logs were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sampling {
    /// A log over time, whose steady plateaus have to be found.
    Timeseries,
    /// One row is one steady reading.
    Points,
}

/// The part that a session plays in fits, where its owner has decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Fitted.
    Train,
    /// Not fitted, looked at during development.
    Validation,
    /// Takes part in no fit and no choice.
    Holdout,
}

/// One physical actuator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Specimen {
    /// The same in every session of this actuator.
    pub id: String,
    /// Uninflated inner diameter, mm.
    pub diameter_mm: f64,
    /// l_rest, hose clamp to hose clamp, m.
    pub rest_length_m: f64,
    /// l_620, free length at 620 kPa without load, m.
    pub contracted_length_m: f64,
    /// One standard deviation of l_rest, m, where it was declared.
    pub rest_length_sd_m: Option<f64>,
    /// One standard deviation of l_620, m, where it was declared.
    pub contracted_length_sd_m: Option<f64>,
}

/// The knee of a torque session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// "pinned", "biomimetic", or "described": by a file of the laboratory's own.
    pub knee: String,
    /// "flexor" or "extensor".
    pub muscle: String,
    /// Artificial tendon, m, where it was recorded.
    pub tendon_m: Option<f64>,
    /// One end fitting, m, where it was recorded.
    pub fitting_m: Option<f64>,
    /// One standard deviation of lengths measured by hand, m, where it was declared.
    pub muscle_length_sd_m: Option<f64>,
    /// One standard deviation of moment arms measured by hand, m, where it was declared.
    pub moment_arm_sd_m: Option<f64>,
    /// The route over the knee, where it is not the usual one of the muscle.
    pub route: Option<String>,
    /// The laboratory's own leg.
    pub description: Option<Description>,
}

/// A file that describes a leg (`knee::description`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Path relative to the session's folder, with forward slashes.
    pub file: String,
    /// What stands in it.
    pub text: String,
}

/// Where in a log a column stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Position {
    /// Counted from 0, in a file without header.
    Index(usize),
    /// Name in the header line.
    Name(String),
}

/// What the cells of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cells {
    /// Numbers, or the states of a phase.
    Numbers,
    /// Numbers or words, as most of a log's cells are: an extra column of which nothing was declared.
    Either,
    /// Words, even where they look like numbers.
    Words,
}

/// How one column of the logs becomes a column inside: `inside = factor * raw + constant`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColumnSpec {
    /// Name inside, unit in the name; an extra column keeps its own.
    pub column: String,
    /// Where it stands in the log.
    pub position: Position,
    /// Whether it holds numbers or words.
    pub cells: Cells,
    /// As written in `session.toml`; empty where an extra column has none.
    pub unit: String,
    /// Gain of the converter times the unit's factor.
    pub factor: f64,
    /// Offset of the converter and of the unit, in the unit used inside.
    pub constant: f64,
    /// Value inside at or below which the converter clips.
    pub saturation_low: Option<f64>,
    /// Value inside at or above which the converter clips.
    pub saturation_high: Option<f64>,
    /// For the phase: raw text to state.
    pub values: BTreeMap<String, Phase>,
}

/// Whether the actuator was being filled or vented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// Pressure rises from step to step.
    Pressurizing,
    /// Pressure falls from step to step.
    Depressurizing,
}

impl Phase {
    /// The word used in files.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Pressurizing => "pressurizing",
            Phase::Depressurizing => "depressurizing",
        }
    }

    /// The number that stands for the phase in a log's column.
    pub fn code(self) -> f64 {
        match self {
            Phase::Pressurizing => 1.0,
            Phase::Depressurizing => 2.0,
        }
    }

    /// The phase that a code stands for.
    pub fn from_code(code: f64) -> Option<Self> {
        [Phase::Pressurizing, Phase::Depressurizing]
            .into_iter()
            .find(|p| p.code() == code)
    }
}

/// What a text log needs before it is a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextFormat {
    /// Lines above the header or the first row.
    pub skip_rows: u64,
    /// How characters are written.
    pub encoding: Encoding,
}

/// Character encoding of a text log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Encoding {
    /// What nearly every program writes today.
    #[default]
    Utf8,
    /// ISO 8859-1, as many loggers write µ, ° and umlauts.
    Latin1,
}

/// One log file of a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogSpec {
    /// Path relative to the session's folder, with forward slashes.
    pub file: String,
    /// Which of the file's tables, where it holds several.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub part: Option<Part>,
    /// Recorded without pressure, for the zero of the force channel.
    pub is_zero: bool,
    /// Number of the run, where one is given.
    pub run: Option<i64>,
}

impl LogSpec {
    /// The name of the log in tables and messages: its file, and its part where one is named.
    pub fn name(&self) -> String {
        match &self.part {
            None => self.file.clone(),
            Some(part) => format!("{}#{}", self.file, part.name),
        }
    }
}

/// One of the tables that a file holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// What the parts of such a file are.
    pub kind: PartKind,
    /// Its name in the file.
    pub name: String,
}

/// What the tables of a file are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PartKind {
    /// A sheet of a workbook.
    Sheet,
    /// A matrix or structure of a MATLAB file.
    Variable,
}

impl PartKind {
    /// The key of a `[[log]]` that names such a part.
    pub fn key(self) -> &'static str {
        match self {
            PartKind::Sheet => "sheet",
            PartKind::Variable => "variable",
        }
    }
}

/// A constant of the set-up that is no known quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Constant {
    /// A number, in the user's unit.
    Number(f64),
    /// A label.
    Text(String),
}

/// A checked session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// Unique over the whole raw tree.
    pub id: String,
    /// What was measured.
    pub kind: Kind,
    /// How the logs were taken.
    pub sampling: Sampling,
    /// What was measured together, with one rig set-up.
    pub campaign: String,
    /// ISO 8601, day or month.
    pub date: Option<String>,
    /// Decided by the owner; else the split rule decides.
    pub role: Option<Role>,
    /// Why the session is kept out of every fit.
    pub exclude: Option<String>,
    /// Free text.
    pub notes: Option<String>,
    /// The actuator.
    pub specimen: Specimen,
    /// Constants of the set-up: known quantities in the unit used inside, by the name of their column; others as given. A text is a label
    /// of every reading.
    pub setup: BTreeMap<String, Constant>,
    /// One standard deviation of the length that was held, m, where it was declared. No constant of the set-up: it describes another one.
    pub length_sd_m: Option<f64>,
    /// The knee, for torque sessions.
    pub joint: Option<Joint>,
    /// What its text logs need before they are tables.
    #[serde(default)]
    pub format: TextFormat,
    /// The columns of every log.
    pub columns: Vec<ColumnSpec>,
    /// The log files, in the order of the file.
    pub logs: Vec<LogSpec>,
}

impl Session {
    /// Whether the notes declare the session simulated: they begin with the word.
    pub fn is_simulated(&self) -> bool {
        self.notes
            .as_deref()
            .is_some_and(|n| n.trim_start().to_ascii_lowercase().starts_with("simulated"))
    }

    /// A constant of the set-up as a number.
    pub fn setup_number(&self, column: &str) -> Option<f64> {
        match self.setup.get(column) {
            Some(Constant::Number(x)) => Some(*x),
            _ => None,
        }
    }

    /// The specification of a column, if the logs have it.
    pub fn column(&self, name: &str) -> Option<&ColumnSpec> {
        self.columns.iter().find(|c| c.column == name)
    }
}
