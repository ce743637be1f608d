//! `session.toml`, schema `bpa-session/1`: strict, every mistake at once.
//!
//! `README.md` has the format by example. How well the lengths of a session are known may be declared: `super::session_sd` has the keys.

use crate::text_format::text_format;
use crate::{session_checks, session_columns, session_joint, session_sd, session_specimen};
use pipeline_base::columns::{self, KnownColumn};
use pipeline_base::date::is_date;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::{Constant, Kind, LogSpec, Part, PartKind, Role, Sampling, Session};
use pipeline_base::toml_reader::{Entry, Reader, Section, parse};
use pipeline_base::units::{Quantity, Unit};
use std::collections::BTreeMap;

/// The only schema that is understood.
pub const SCHEMA: &str = "bpa-session/1";

/// What sessions below a folder have in common.
pub const CAMPAIGN_FILE: &str = "campaign.toml";
/// Its only schema.
const CAMPAIGN_SCHEMA: &str = "bpa-campaign/1";

/// What marks a line that a person has to complete, in a session that `pipeline new-session` has drafted.
pub const FILL_IN: &str = "FILL IN";

/// The longest id or campaign, bytes: it becomes part of file names.
const LONGEST_NAME: usize = 80;

/// Reads and checks the text of a `session.toml`; messages call it `file`.
///
/// # Errors
/// Every mistake of the file, in the order of its lines.
pub fn read(file: &str, text: &str) -> Result<Session, Vec<Diagnostic>> {
    read_over((file, text), (CAMPAIGN_FILE, "schema = \"bpa-campaign/1\""))
}

/// The same, with the text of a `campaign.toml` for what the session does not say itself. A session may complete a table of the campaign or take
/// another value for a key of it; a column that it describes is described anew.
///
/// # Errors
/// Every mistake of both files.
pub fn read_over(
    (file, text): (&str, &str),
    (campaign_file, campaign): (&str, &str),
) -> Result<Session, Vec<Diagnostic>> {
    let one = |d| vec![d];
    let table = parse(file, text).map_err(one)?;
    let defaults = parse(campaign_file, campaign).map_err(one)?;
    let (reader, campaign_reader) = (
        Reader::new(file, text),
        Reader::new(campaign_file, campaign),
    );
    report_unfilled(&reader, text);
    report_unfilled(&campaign_reader, campaign);
    let mut found = None;
    if reader.is_clean() && campaign_reader.is_clean() {
        let of_campaign = campaign_reader.root(&defaults);
        check_campaign(&of_campaign);
        found = session(&reader.root_over(&table, of_campaign));
    }
    let mistakes = [reader.finish(), campaign_reader.finish()].concat();
    match found {
        Some(session) if mistakes.is_empty() => Ok(session),
        _ => Err(mistakes),
    }
}

/// What a campaign has of its own, and what only a session can have.
fn check_campaign(campaign: &Section) {
    let hint = "write schema = \"bpa-campaign/1\"";
    if let Some(entry) = campaign.require("schema", CAMPAIGN_SCHEMA, hint) {
        entry.choice(&[(CAMPAIGN_SCHEMA, ())]);
    }
    for key in ["id", "log"] {
        if let Some(entry) = campaign.get(key) {
            entry.reject_for(
                &format!("`{key}`"),
                "what sessions have in common",
                "write it into each session.toml",
            );
        }
    }
}

/// Every line that `pipeline new-session` has left to a person and nobody has completed.
fn report_unfilled(reader: &Reader, text: &str) {
    for (k, line) in text.lines().enumerate() {
        let Some((before, meant)) = line.split_once(FILL_IN) else {
            continue;
        };
        // A key may stand in a comment for a person to complete.
        let key = before
            .trim_start_matches(['#', ' '])
            .split(['=', '#', '{'])
            .next()
            .unwrap_or_default()
            .trim();
        let meant = meant.trim_start_matches(':').trim().trim_end_matches('"');
        let expected = if meant.is_empty() {
            "what was measured"
        } else {
            meant
        };
        let hint = format!("correct the line, and remove the words {FILL_IN}");
        reader.report(k as u64 + 1, key, FILL_IN, expected, &hint);
    }
}

/// What the head of the file says.
struct Head {
    id: Option<String>,
    kind: Option<Kind>,
    sampling: Option<Sampling>,
    campaign: Option<String>,
    date: Option<String>,
    role: Option<Role>,
    exclude: Option<String>,
    notes: Option<String>,
}

fn head(root: &Section) -> Head {
    if let Some(entry) = root.require_own("schema", SCHEMA, "write schema = \"bpa-session/1\"") {
        entry.choice(&[(SCHEMA, ())]);
    }
    let id = identifier(root, "id", "a name that no other session has");
    let kind = root.require("kind", "isometric or knee-torque", "say what was measured");
    let kinds = [
        ("isometric", Kind::Isometric),
        ("knee-torque", Kind::KneeTorque),
    ];
    let sampling = root.require("sampling", "timeseries or points", "say how it was logged");
    let samplings = [
        ("timeseries", Sampling::Timeseries),
        ("points", Sampling::Points),
    ];
    let roles = [
        ("train", Role::Train),
        ("validation", Role::Validation),
        ("holdout", Role::Holdout),
    ];
    Head {
        id,
        kind: kind.and_then(|e| e.choice(&kinds)),
        sampling: sampling.and_then(|e| e.choice(&samplings)),
        campaign: identifier(root, "campaign", "the name of what was measured together"),
        date: root.get("date").and_then(|e| date(&e)),
        role: root.get("role").and_then(|e| e.choice(&roles)),
        exclude: root.get("exclude").and_then(|e| reason(&e)),
        notes: root.get("notes").and_then(|e| e.string()),
    }
}

/// Why a session is kept out of fits; an empty reason is none.
fn reason(entry: &Entry) -> Option<String> {
    let text = entry.string()?;
    if text.trim().is_empty() {
        entry.reject(
            "the reason why the session is kept out of every fit",
            "write it, or remove `exclude`",
        );
        return None;
    }
    Some(text)
}

fn session(root: &Section) -> Option<Session> {
    let head = head(root);
    let specimen = root
        .require("specimen", "a table [specimen]", "describe the actuator")
        .and_then(|e| e.table())
        .and_then(|t| session_specimen::specimen(&t));
    let setup = root.get("setup").and_then(|e| e.table());
    let (setup, length_sd_m) = setup
        .map(|t| {
            (
                setup_constants(&t),
                session_sd::of_held_length(&t, head.kind),
            )
        })
        .unwrap_or_default();
    let joint_entry = root.get("joint");
    let format = root.get("format").and_then(|e| e.table());
    let format = format.map(|t| text_format(&t)).unwrap_or_default();
    let columns = root
        .require(
            "columns",
            "a table [columns]",
            "say which quantity is in which column",
        )
        .and_then(|e| e.table())
        .map(|t| session_columns::column_specs(&t));
    let logs = root
        .require("log", "at least one [[log]]", "name the log files")
        .and_then(|e| e.list())
        .map(|l| l.iter().filter_map(log).collect::<Vec<_>>());
    root.close();
    let joint = session_joint::joint(root, head.kind, joint_entry);
    let session = Session {
        id: head.id?,
        kind: head.kind?,
        sampling: head.sampling?,
        campaign: head.campaign?,
        date: head.date,
        role: head.role,
        exclude: head.exclude,
        notes: head.notes,
        specimen: specimen?,
        setup,
        length_sd_m,
        joint,
        format,
        columns: columns?,
        logs: logs?,
    };
    // A column that was given and is wrong has been reported; that it is missing as well would be false.
    if root.reader().is_clean() {
        session_checks::check(root, &session);
    }
    Some(session)
}

pub(super) fn identifier(root: &Section, key: &'static str, expected: &str) -> Option<String> {
    let entry = root.require(key, expected, "add it")?;
    let text = entry.string()?;
    if text.trim().is_empty() || text.len() > LONGEST_NAME || text.chars().any(char::is_control) {
        entry.reject(expected, "write a short name without line breaks");
        return None;
    }
    Some(text)
}

fn date(entry: &Entry) -> Option<String> {
    let text = entry.as_string().unwrap_or_else(|| entry.describe());
    if !is_date(&text) {
        entry.reject(
            "a day or a month that exists, in ISO 8601",
            "write \"2022-11\" or \"2022-11-30\"",
        );
        return None;
    }
    Some(text)
}

/// A key of `[setup]` such as `length_mm` or `temperature_c`: quantity and unit, the unit's case ignored.
pub(super) fn split_unit(key: &str) -> Option<(&'static KnownColumn, Unit)> {
    columns::KNOWN.iter().find_map(|known| {
        let suffix = key.strip_prefix(known.quantity_name)?.strip_prefix('_')?;
        let unit = known
            .quantity?
            .units()
            .find(|u| u.symbol.replace('.', "").eq_ignore_ascii_case(suffix))?;
        Some((known, unit))
    })
}

fn setup_constants(table: &Section) -> BTreeMap<String, Constant> {
    let mut constants = BTreeMap::new();
    for (key, entry) in table.entries() {
        if key == session_sd::HELD_LENGTH {
            // It describes the length that was held and is no constant of its own, which the residual search would look at.
            continue;
        }
        if let Some((known, unit)) = split_unit(&key) {
            if let Some(value) = entry
                .number()
                .and_then(|x| quantity_value(&entry, known, unit.to_inside(x)))
            {
                constants.insert(known.column.to_owned(), Constant::Number(value));
            }
        } else if let Some(known) = columns::by_quantity_name(&key) {
            let units = known.quantity.into_iter().flat_map(|q| q.units());
            let keys: Vec<String> = units
                .map(|u| format!("{key}_{}", u.symbol.replace('.', "").to_lowercase()))
                .collect();
            entry.reject_for(
                &format!("{key} = {}", entry.describe()),
                &format!("the unit in the key, one of {}", keys.join(", ")),
                "write the unit behind the name",
            );
        } else if let Some((expected, hint)) = session_sd::slip_in_setup(&key) {
            entry.reject(&expected, &hint);
        } else if columns::is_reserved(&key) {
            entry.reject(
                "a name that the pipeline does not use itself",
                "choose another name",
            );
        } else if let Some(number) = entry.as_number() {
            constants.insert(key, Constant::Number(number));
        } else if let Some(text) = entry.string() {
            constants.insert(key, Constant::Text(text));
        }
    }
    constants
}

fn quantity_value(entry: &Entry, known: &KnownColumn, value: f64) -> Option<f64> {
    if known.quantity == Some(Quantity::Length) && value <= 0.0 {
        entry.reject("a positive length", "write the length that was held");
        return None;
    }
    Some(value)
}

/// A path that does not leave the session's folder.
pub(super) fn path_below(entry: &Entry) -> Option<String> {
    let text = entry.string()?;
    let inside = !text.is_empty()
        && !text.starts_with('/')
        && !text.contains('\\')
        && !text.split('/').any(|part| part == ".." || part.is_empty());
    if !inside {
        entry.reject(
            "a path below the session's folder, with forward slashes",
            "put the file beside session.toml",
        );
        return None;
    }
    Some(text)
}

fn log(entry: &Entry) -> Option<LogSpec> {
    let table = entry.table()?;
    let file = table.require("file", "the name of a log file", "add it");
    let role = table.get("role").map(|e| e.choice(&[("zero", ())]));
    let run = table.get("run").and_then(|e| e.integer());
    let part = part(&table);
    table.close();
    Some(LogSpec {
        file: file.and_then(|e| path_below(&e))?,
        part,
        is_zero: role.is_some(),
        run,
    })
}

/// Which table of the file, where one is named.
fn part(table: &Section) -> Option<Part> {
    let sheet = table.get(PartKind::Sheet.key());
    let variable = table.get(PartKind::Variable.key());
    let (kind, entry) = match (sheet, variable) {
        (Some(sheet), None) => (PartKind::Sheet, sheet),
        (None, Some(variable)) => (PartKind::Variable, variable),
        (None, None) => return None,
        (Some(sheet), Some(_)) => {
            sheet.reject(
                "either `sheet` (a workbook) or `variable` (a MATLAB file)",
                "remove one of them",
            );
            return None;
        }
    };
    let name = entry.string()?;
    Some(Part { kind, name })
}
