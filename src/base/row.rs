//! One measured row, normalised: what fits, comparisons and the residual search work on.

use crate::columns::{self, derived};
use crate::error::{Error, Result};
use crate::frame::{Frame, Values};
use crate::reading::phase_named;
use crate::session::{Kind, Phase, Role};
use std::collections::{BTreeMap, BTreeSet};

/// A steady reading with everything that is known of its specimen and session. Lengths in m, forces in N, pressures in kPa.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Session id.
    pub session: String,
    /// Campaign id.
    pub campaign: String,
    /// Specimen id.
    pub specimen: String,
    /// What was measured.
    pub kind: Kind,
    /// Date of the session as declared, ISO 8601: a day or a month.
    pub date: Option<String>,
    /// Set by the owner of the data.
    pub role: Option<Role>,
    /// Kept out of every fit.
    pub excluded: bool,
    /// The session's notes declare it simulated.
    pub simulated: bool,
    /// Log file.
    pub log: String,
    /// Run number.
    pub run: Option<i64>,
    /// First line of the log that entered, counted from 1.
    pub first_row: i64,
    /// Last line of the log that entered.
    pub last_row: i64,
    /// Filling or venting.
    pub phase: Option<Phase>,
    /// Samples averaged.
    pub samples: i64,
    /// Standard deviation of the samples' force, N.
    pub sd_force_n: f64,
    /// Zero of the force channel that was taken off, N; NaN where there is none.
    pub zero_force_n: f64,
    /// What the pressure channel shows in the session's zero log, without pressure, kPa; NaN where there is none. Not taken off.
    pub zero_pressure_kpa: f64,
    /// Uninflated inner diameter, mm.
    pub diameter_mm: f64,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_620, m.
    pub contracted_length_m: f64,
    /// Declared standard deviation of l_rest, m; NaN where there is none.
    pub rest_length_sd_m: f64,
    /// Declared standard deviation of l_620, m; NaN where there is none.
    pub contracted_length_sd_m: f64,
    /// Declared standard deviation of the length that was held, m; NaN where there is none.
    pub length_sd_m: f64,
    /// Declared standard deviation of lengths measured by hand at a knee, m; NaN where there is none.
    pub muscle_length_sd_m: f64,
    /// Declared standard deviation of moment arms measured by hand, m; NaN where there is none.
    pub moment_arm_sd_m: f64,
    /// Time in the log, s; NaN where there is none.
    pub time_s: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// Axial force, N; NaN for torque sessions.
    pub force_n: f64,
    /// Current length of the actuator, m.
    pub length_m: f64,
    /// eps = (l_rest - l) / l_rest.
    pub contraction: f64,
    /// eps* = eps / eps_620.
    pub contraction_rel: f64,
    /// P* = P / 620 kPa.
    pub pressure_rel: f64,
    /// Every other column, by name: torque, angle, moment arm, temperature, extras.
    pub extras: BTreeMap<String, f64>,
    /// Every column of words and every text of the set-up, by name.
    pub labels: BTreeMap<String, String>,
}

type NumberField = (&'static str, fn(&Row) -> f64, fn(&mut Row, f64));

const NUMBERS: &[NumberField] = &[
    (derived::SD_FORCE, |r| r.sd_force_n, |r, x| r.sd_force_n = x),
    (
        derived::ZERO_FORCE,
        |r| r.zero_force_n,
        |r, x| r.zero_force_n = x,
    ),
    (
        derived::ZERO_PRESSURE,
        |r| r.zero_pressure_kpa,
        |r, x| r.zero_pressure_kpa = x,
    ),
    (
        derived::DIAMETER,
        |r| r.diameter_mm,
        |r, x| r.diameter_mm = x,
    ),
    (
        derived::REST_LENGTH,
        |r| r.rest_length_m,
        |r, x| r.rest_length_m = x,
    ),
    (
        derived::CONTRACTED_LENGTH,
        |r| r.contracted_length_m,
        |r, x| r.contracted_length_m = x,
    ),
    (
        derived::REST_LENGTH_SD,
        |r| r.rest_length_sd_m,
        |r, x| r.rest_length_sd_m = x,
    ),
    (
        derived::CONTRACTED_LENGTH_SD,
        |r| r.contracted_length_sd_m,
        |r, x| r.contracted_length_sd_m = x,
    ),
    (
        derived::LENGTH_SD,
        |r| r.length_sd_m,
        |r, x| r.length_sd_m = x,
    ),
    (
        derived::MUSCLE_LENGTH_SD,
        |r| r.muscle_length_sd_m,
        |r, x| r.muscle_length_sd_m = x,
    ),
    (
        derived::MOMENT_ARM_SD,
        |r| r.moment_arm_sd_m,
        |r, x| r.moment_arm_sd_m = x,
    ),
    (columns::TIME, |r| r.time_s, |r, x| r.time_s = x),
    (
        columns::PRESSURE,
        |r| r.pressure_kpa,
        |r, x| r.pressure_kpa = x,
    ),
    (columns::FORCE, |r| r.force_n, |r, x| r.force_n = x),
    (columns::LENGTH, |r| r.length_m, |r, x| r.length_m = x),
    (
        derived::CONTRACTION,
        |r| r.contraction,
        |r, x| r.contraction = x,
    ),
    (
        derived::CONTRACTION_REL,
        |r| r.contraction_rel,
        |r, x| r.contraction_rel = x,
    ),
    (
        derived::PRESSURE_REL,
        |r| r.pressure_rel,
        |r, x| r.pressure_rel = x,
    ),
];

type TextField = (&'static str, fn(&Row) -> Option<String>, fn(&mut Row, &str));

const TEXTS: &[TextField] = &[
    (
        derived::SESSION,
        |r| Some(r.session.clone()),
        |r, t| r.session = t.to_owned(),
    ),
    (
        derived::CAMPAIGN,
        |r| Some(r.campaign.clone()),
        |r, t| r.campaign = t.to_owned(),
    ),
    (
        derived::SPECIMEN,
        |r| Some(r.specimen.clone()),
        |r, t| r.specimen = t.to_owned(),
    ),
    (
        "kind",
        |r| Some(kind_name(r.kind).to_owned()),
        |r, t| {
            r.kind = if t == kind_name(Kind::KneeTorque) {
                Kind::KneeTorque
            } else {
                Kind::Isometric
            };
        },
    ),
    (
        "date",
        |r| r.date.clone(),
        |r, t| r.date = Some(t.to_owned()),
    ),
    (
        "role",
        |r| r.role.map(|x| role_name(x).to_owned()),
        |r, t| r.role = role_named(t),
    ),
    (
        derived::LOG,
        |r| Some(r.log.clone()),
        |r, t| r.log = t.to_owned(),
    ),
    (
        columns::PHASE,
        |r| r.phase.map(|p| p.name().to_owned()),
        |r, t| r.phase = phase_named(t),
    ),
];

type IntegerField = (
    &'static str,
    fn(&Row) -> Option<i64>,
    fn(&mut Row, Option<i64>),
);

const INTEGERS: &[IntegerField] = &[
    (
        "excluded",
        |r| Some(i64::from(r.excluded)),
        |r, i| r.excluded = i == Some(1),
    ),
    (
        "simulated",
        |r| Some(i64::from(r.simulated)),
        |r, i| r.simulated = i == Some(1),
    ),
    (derived::RUN, |r| r.run, |r, i| r.run = i),
    (
        derived::ROW,
        |r| Some(r.first_row),
        |r, i| r.first_row = i.unwrap_or(0),
    ),
    (
        derived::LAST_ROW,
        |r| Some(r.last_row),
        |r, i| r.last_row = i.unwrap_or(0),
    ),
    (
        derived::SAMPLES,
        |r| Some(r.samples),
        |r, i| r.samples = i.unwrap_or(0),
    ),
];

/// The word that stands for a kind in files.
pub fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Isometric => "isometric",
        Kind::KneeTorque => "knee-torque",
    }
}

/// The word that stands for a role in files.
pub fn role_name(role: Role) -> &'static str {
    match role {
        Role::Train => "train",
        Role::Validation => "validation",
        Role::Holdout => "holdout",
    }
}

fn role_named(name: &str) -> Option<Role> {
    [Role::Train, Role::Validation, Role::Holdout]
        .into_iter()
        .find(|r| role_name(*r) == name)
}

impl Row {
    /// A row in which nothing is known yet.
    pub fn blank() -> Self {
        Row {
            session: String::new(),
            campaign: String::new(),
            specimen: String::new(),
            kind: Kind::Isometric,
            date: None,
            role: None,
            excluded: false,
            simulated: false,
            log: String::new(),
            run: None,
            first_row: 0,
            last_row: 0,
            phase: None,
            samples: 0,
            sd_force_n: f64::NAN,
            zero_force_n: f64::NAN,
            zero_pressure_kpa: f64::NAN,
            diameter_mm: f64::NAN,
            rest_length_m: f64::NAN,
            contracted_length_m: f64::NAN,
            rest_length_sd_m: f64::NAN,
            contracted_length_sd_m: f64::NAN,
            length_sd_m: f64::NAN,
            muscle_length_sd_m: f64::NAN,
            moment_arm_sd_m: f64::NAN,
            time_s: f64::NAN,
            pressure_kpa: f64::NAN,
            force_n: f64::NAN,
            length_m: f64::NAN,
            contraction: f64::NAN,
            contraction_rel: f64::NAN,
            pressure_rel: f64::NAN,
            extras: BTreeMap::new(),
            labels: BTreeMap::new(),
        }
    }
}

impl Row {
    /// The label in a column that holds words in some rows: here perhaps a number, which then is the word for itself.
    pub fn label(&self, name: &str) -> Option<String> {
        let number = || self.extras.get(name).map(f64::to_string);
        self.labels.get(name).cloned().or_else(number)
    }
}

/// What stands for the label of a row that has none in a column where others have one.
pub const NO_LABEL: &str = "not named";

/// Names of the columns that hold words in any of the rows.
pub fn label_names<'a>(rows: impl IntoIterator<Item = &'a Row>) -> BTreeSet<String> {
    let names = rows.into_iter().flat_map(|r| r.labels.keys());
    names.cloned().collect()
}

/// The rows as a table: the fixed columns, then the extra ones by name, then the labels by name. A column that holds words in some rows and
/// numbers in others is one of words.
pub fn to_frame(rows: &[Row]) -> Frame {
    let mut frame = Frame::default();
    for (name, get, _) in TEXTS {
        frame = frame.with(name, Values::Text(rows.iter().map(get).collect()));
    }
    for (name, get, _) in INTEGERS {
        frame = frame.with(name, Values::Integer(rows.iter().map(get).collect()));
    }
    for (name, get, _) in NUMBERS {
        frame = frame.with(name, Values::Number(rows.iter().map(get).collect()));
    }
    let labels = label_names(rows);
    let names: BTreeSet<&String> = rows.iter().flat_map(|r| r.extras.keys()).collect();
    for name in names.into_iter().filter(|n| !labels.contains(*n)) {
        let value = |r: &Row| r.extras.get(name).copied().unwrap_or(f64::NAN);
        frame = frame.with(name, Values::Number(rows.iter().map(value).collect()));
    }
    for name in &labels {
        let words = rows.iter().map(|r| r.label(name)).collect();
        frame = frame.with(name, Values::Text(words));
    }
    frame
}

/// The rows in a table written by [`to_frame`].
///
/// # Errors
/// A table that lacks one of the fixed columns.
pub fn from_frame(frame: &Frame) -> Result<Vec<Row>> {
    let mut rows = vec![Row::blank(); frame.height()];
    let missing =
        |name: &str| Error::Internal(format!("a table of rows without the column {name}"));
    for (name, _, set) in TEXTS {
        let values = frame.texts(name).ok_or_else(|| missing(name))?;
        for (row, value) in rows.iter_mut().zip(values) {
            if let Some(text) = value {
                set(row, text);
            }
        }
    }
    for (name, _, set) in INTEGERS {
        let values = frame.integers(name).ok_or_else(|| missing(name))?;
        for (row, value) in rows.iter_mut().zip(values) {
            set(row, *value);
        }
    }
    for (name, _, set) in NUMBERS {
        let values = frame.numbers(name).ok_or_else(|| missing(name))?;
        for (row, value) in rows.iter_mut().zip(values) {
            set(row, *value);
        }
    }
    let fixed = |n: &str| {
        TEXTS.iter().any(|f| f.0 == n)
            || INTEGERS.iter().any(|f| f.0 == n)
            || NUMBERS.iter().any(|f| f.0 == n)
    };
    for (name, values) in &frame.columns {
        match values {
            Values::Number(values) if !fixed(name) => {
                for (row, value) in rows.iter_mut().zip(values).filter(|(_, v)| !v.is_nan()) {
                    row.extras.insert(name.clone(), *value);
                }
            }
            Values::Text(words) if !fixed(name) => {
                for (row, word) in rows.iter_mut().zip(words) {
                    if let Some(word) = word {
                        row.labels.insert(name.clone(), word.clone());
                    }
                }
            }
            _ => {}
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_survive_the_table() {
        let mut row = Row::blank();
        row.session = "s".into();
        row.role = Some(Role::Holdout);
        row.date = Some("2022-11".into());
        row.kind = Kind::KneeTorque;
        row.excluded = true;
        row.run = Some(8);
        row.phase = Some(Phase::Pressurizing);
        row.extras.insert("angle_rad".into(), -0.5);
        for (k, (_, _, set)) in NUMBERS.iter().enumerate() {
            set(&mut row, k as f64 + 0.5);
        }
        let rows = vec![row.clone(), row];
        assert_eq!(from_frame(&to_frame(&rows)).unwrap(), rows);
    }

    #[test]
    fn what_was_not_declared_stays_undeclared_in_the_table() {
        let mut declared = Row::blank();
        declared.length_sd_m = 0.5e-3;
        declared.moment_arm_sd_m = 4e-3;
        let back = from_frame(&to_frame(&[declared, Row::blank()])).unwrap();
        assert_eq!(
            (back[0].length_sd_m, back[0].moment_arm_sd_m),
            (0.5e-3, 4e-3)
        );
        for row in &back {
            assert!(row.rest_length_sd_m.is_nan() && row.contracted_length_sd_m.is_nan());
            assert!(row.muscle_length_sd_m.is_nan() && row.extras.is_empty());
        }
        assert!(back[1].length_sd_m.is_nan() && back[1].moment_arm_sd_m.is_nan());
    }
}
