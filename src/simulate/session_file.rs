//! `session.toml` of a simulated session, in the style of the real ones.

use super::chain::TOP_COUNT;
use super::draw::{DrawnSession, DrawnTruth};
use super::logged_columns::ColumnTruth;
use super::number::{five_digits, fixed};
use super::rig_settings::LogUnit;
use super::truth::Truth;
use pipeline_base::columns;
use pipeline_base::session::{Role, Sampling};
use std::fmt::Write;

/// How the notes of every simulated session begin.
pub const NOTES: &str = "simulated by pipeline simulate";

/// What stands for the phase in every log.
const PHASES: &str = "{ \"1\" = \"pressurizing\", \"2\" = \"depressurizing\" }";

/// Name of the zero log.
pub const ZERO_LOG: &str = "offset.csv";

/// Name of the log of a run.
pub fn log_name(sampling: Sampling, run: i64) -> String {
    match sampling {
        Sampling::Timeseries => format!("test{run}.csv"),
        Sampling::Points => format!("points{run}.csv"),
    }
}

/// The text of a session's `session.toml`.
pub fn text(drawn: &DrawnTruth, session: &DrawnSession) -> String {
    let truth = &drawn.truth;
    let specimen = drawn.specimen(session);
    let sampling = match truth.sampling {
        Sampling::Timeseries => "timeseries",
        Sampling::Points => "points",
    };
    let mut lines = vec![
        "schema = \"bpa-session/1\"".to_owned(),
        format!("id = \"{}\"", session.id),
        "kind = \"isometric\"".to_owned(),
        format!("sampling = \"{sampling}\""),
        format!("campaign = \"{}\"", truth.campaign),
    ];
    lines.extend(session.date.iter().map(|d| format!("date = \"{d}\"")));
    let role = specimen.role.map(role_name);
    lines.extend(role.map(|r| format!("role = \"{r}\"")));
    lines.push(format!("notes = {}", quoted(&notes(truth))));
    let mut text = lines.join("\n");
    let _infallible = write!(
        text,
        "\n\n[specimen]\nid = \"{}\"\ndiameter_mm = {}\nrest_length_mm = {}\n\
         contracted_length_mm = {}\n\n[setup]\nlength_mm = {}\n\n[columns]\n{}{}",
        specimen.id,
        truth.diameter_mm,
        specimen.rest_length_mm,
        fixed(specimen.contracted_length_mm, 1),
        fixed(session.length_mm, 2),
        columns(drawn, session),
        logs(drawn),
    );
    text
}

/// The notes of a campaign's sessions: simulated, by what; of effects they say nothing.
pub fn notes(truth: &Truth) -> String {
    let mut notes = format!("{NOTES}, campaign {}, seed {}", truth.campaign, truth.seed);
    if let Some(own) = &truth.notes {
        let _infallible = write!(notes, "; {own}");
    }
    notes
}

fn role_name(role: Role) -> &'static str {
    match role {
        Role::Train => "train",
        Role::Validation => "validation",
        Role::Holdout => "holdout",
    }
}

/// A TOML string with whatever escapes it needs.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn columns(drawn: &DrawnTruth, session: &DrawnSession) -> String {
    if drawn.truth.sampling == Sampling::Points {
        return points_columns(&drawn.truth);
    }
    let (force, pressure) = (drawn.force_channel(session), drawn.pressure_channel());
    let converter = |quantum: f64, clip: f64| match drawn.truth.rig.log_unit {
        LogUnit::Physical => String::new(),
        LogUnit::Counts => format!(", gain = {quantum}, offset = {clip}"),
    };
    let low = match drawn.truth.rig.log_unit {
        LogUnit::Physical => five_digits(force.clip),
        LogUnit::Counts => force.clip.to_string(),
    };
    // A quarter of a count below the end, so that rounding in the log cannot hide a clipped sample.
    let high = five_digits(force.value(TOP_COUNT) - 0.25 * force.quantum);
    format!(
        "force = {{ index = 0, unit = \"N\"{}, saturation_low = {low}, saturation_high = {high} }}\n\
         pressure = {{ index = 1, unit = \"kPa\"{} }}\n\
         time = {{ index = 2, unit = \"s\" }}\n\
         phase = {{ index = 3, values = {PHASES} }}\n{}",
        converter(force.quantum, force.clip),
        converter(pressure.quantum, pressure.clip),
        extra_columns(&drawn.truth, |k, _| format!("index = {}", 4 + k)),
    )
}

fn points_columns(truth: &Truth) -> String {
    let mut text = String::from(
        "pressure = { name = \"pressure_kpa\", unit = \"kPa\" }\n\
         force = { name = \"force_n\", unit = \"N\" }\n",
    );
    if truth.schedule.has_clock() {
        text.push_str("time = { name = \"time_s\", unit = \"s\" }\n");
    }
    if truth.schedule.both_directions {
        let _infallible = writeln!(text, "phase = {{ name = \"phase\", values = {PHASES} }}");
    }
    if let Some(name) = truth.schedule.own_column() {
        let _infallible = writeln!(text, "{name} = {{ name = \"{name}\" }}");
    }
    text + &extra_columns(truth, |_, name| format!("name = \"{name}\""))
}

/// The columns that the truth file adds; `place` says where the k-th of that name stands.
fn extra_columns(truth: &Truth, place: impl Fn(usize, &str) -> String) -> String {
    let line = |(k, c): (usize, &ColumnTruth)| {
        let place = place(k, &c.name);
        if c.name == columns::TEMPERATURE {
            return format!("temperature = {{ {place}, unit = \"C\" }}\n");
        }
        let unit = match c.unit.as_str() {
            "" => String::new(),
            unit => format!(", unit = {}", quoted(unit)),
        };
        format!("{} = {{ {place}{unit} }}\n", c.name)
    };
    truth.columns.iter().enumerate().map(line).collect()
}

fn logs(drawn: &DrawnTruth) -> String {
    let sampling = drawn.truth.sampling;
    let zero = match sampling {
        Sampling::Timeseries => format!("\n[[log]]\nfile = \"{ZERO_LOG}\"\nrole = \"zero\"\n"),
        Sampling::Points => String::new(),
    };
    let runs = drawn.truth.runs.iter().map(|run| {
        let file = log_name(sampling, run.number);
        format!("\n[[log]]\nfile = \"{file}\"\nrun = {}\n", run.number)
    });
    zero + &runs.collect::<String>()
}
