//! What a check of a session showed, in words.

use crate::doubts;
use pipeline_findings::{ErrorKind, RecordingError};
use pipeline_inspect::otherwise::Otherwise;
use pipeline_inspect::{NotCompared, Noted, Own, Seen};
use pipeline_report::wording::name;
use pipeline_report::wording::number::{percent, with_unit};
use pipeline_report::wording::sentence::recorded_size;

/// A check in words.
pub fn said(seen: &Seen) -> String {
    match seen {
        Seen::Description { message } => message.clone(),
        Seen::LeftOut { reason } => format!("the log is left out: {reason}"),
        Seen::Rows {
            rows,
            left_out,
            reason,
        } => unusable_rows(*rows, *left_out, reason.as_deref()),
        Seen::Clipping { share, at_pressure } => format!(
            "{} of the samples of the force are at the limit of the converter, {} of those at high pressure",
            percent(*share),
            percent(*at_pressure)
        ),
        Seen::FlatTop { at_n, samples } => flat_top("force", &newtons(*at_n), *samples),
        Seen::PressureFlatTop { at_kpa, samples } => {
            let at = with_unit(&format!("{at_kpa:.1}"), "kPa").replace('\u{a0}', " ");
            flat_top("pressure", &at, *samples)
        }
        Seen::Clock {
            step_s,
            gaps,
            longest_s,
        } => clock(*step_s, *gaps, *longest_s),
        Seen::Plateaus { steady, unsettled } => format!(
            "{steady} settled plateaus, {unsettled} in which pressure or force still drifts"
        ),
        Seen::Zero {
            source,
            applied_n,
            clipped,
            slack_n,
        } => zero(source, *applied_n, *clipped, *slack_n),
        Seen::ZeroOfOthers {
            applied_n,
            usual_n,
            deviations,
            sessions,
        } => format!(
            "a zero of {}; the median of {sessions} other sessions is {} ({deviations:.1} standard deviations)",
            newtons(*applied_n),
            newtons(*usual_n)
        ),
        Seen::Gain {
            value,
            sd,
            by_law,
            others,
        } => gain(*value, *sd, (*others, *by_law)),
        Seen::SetLength {
            value_mm,
            sd_mm,
            by_law_mm,
            others,
        } => set_length(*value_mm, *sd_mm, (*others, *by_law_mm)),
        Seen::Misfit { rms_n, usual_n } => residual(*rms_n, *usual_n),
        Seen::Mistake { error } => mistake(error),
        Seen::Copy { of, session } => {
            let session = session.as_ref();
            let session = session.map_or_else(String::new, |id| format!(" of session {id}"));
            format!("the same bytes as {of}{session}")
        }
        Seen::Otherwise {
            what,
            here_mm,
            others_mm,
        } => noted_otherwise(*what, *here_mm, *others_mm),
        Seen::NotTold { quantity } => undetermined(*quantity).to_owned(),
        Seen::Columns {
            otherwise,
            readings,
            rms_n,
            usual_n,
        } => format!(
            "{}: {readings} readings would then agree with others, {}",
            described(otherwise),
            residual(*rms_n, *usual_n)
        ),
        Seen::Stretched(stretched) => format!(
            "{}; an actuator bears 3%: check both lengths and their units",
            doubts::in_words(stretched)
        ),
        Seen::Phases(phases) => format!(
            "the states of the phase look exchanged in [columns]: {}",
            doubts::of_steps(phases)
        ),
        Seen::Excluded { why } => format!("excluded from every fit in session.toml: {why}"),
        Seen::NotCompared { why } => not_compared(*why).to_owned(),
    }
}

fn newtons(x: f64) -> String {
    with_unit(&format!("{x:.1}"), "N").replace('\u{a0}', " ")
}

fn flat_top(quantity: &str, at: &str, samples: usize) -> String {
    format!(
        "the {quantity} stays at its highest value, {at}, for {samples} samples in a row: it looks cut off by the amplifier or the converter"
    )
}

fn unusable_rows(rows: usize, left_out: u64, most: Option<&str>) -> String {
    let why = most.map_or_else(String::new, |r| format!(", most: {r}"));
    format!("{left_out} of {rows} rows are not measurements{why}")
}

fn clock(step_s: f64, gaps: usize, longest_s: f64) -> String {
    if gaps == 0 {
        format!("a sample every {:.3} ms, none missing", 1e3 * step_s)
    } else {
        format!(
            "samples are missing in {gaps} places, for {longest_s:.2} s at most (normally one every {:.1} ms)",
            1e3 * step_s
        )
    }
}

/// The gain beside those of others, and by the law alone.
fn gain(value: f64, sd: f64, (others, by_law): (usize, f64)) -> String {
    let by_law = format!("{:+.1}% relative to the law", 100.0 * by_law);
    let value_text = format!("{:+.1}%", 100.0 * value);
    relative(
        ("specimen gain", &value_text),
        value / sd,
        (others, &by_law),
    )
}

/// The set length beside those of others, and by the law alone.
fn set_length(value_mm: f64, sd_mm: f64, (others, by_law_mm): (usize, f64)) -> String {
    let by_law = format!("{by_law_mm:+.2} mm from the one noted, by the law");
    let value_text = format!("{value_mm:+.2} mm");
    relative(
        ("set length", &value_text),
        value_mm / sd_mm,
        (others, &by_law),
    )
}

/// A quantity of the session: relative to the median of others, where there are any, and to the law.
fn relative(
    (quantity, value): (&str, &str),
    deviations: f64,
    (others, by_law): (usize, &str),
) -> String {
    match others {
        0 => format!("{quantity} {by_law}: {deviations:.1} standard deviations"),
        n => format!(
            "{quantity} {value} from the median of {n} other sessions: {deviations:.1} standard deviations ({by_law})"
        ),
    }
}

fn residual(rms_n: f64, usual_n: f64) -> String {
    format!(
        "residual {} (root mean square); typically {}",
        newtons(rms_n),
        newtons(usual_n)
    )
}

fn mistake(error: &RecordingError) -> String {
    let size = recorded_size(error).map_or_else(String::new, |s| format!(" ({s})"));
    format!(
        "looks like a recording error: {}{}",
        name::recording_error(error.kind, error.quantity.as_deref()),
        size.replace('\u{a0}', " ")
    )
}

fn noted_otherwise(what: Noted, here_mm: f64, others_mm: f64) -> String {
    let (quantity, of) = noted(what);
    format!(
        "{quantity} is noted as {here_mm:.1} mm, and as {others_mm:.1} mm in other sessions of the {of}"
    )
}

fn undetermined(quantity: Own) -> &'static str {
    match quantity {
        Own::SpecimenGain => "the readings do not determine the specimen gain",
        Own::SetLength => "the readings do not determine whether the set length is the one noted",
    }
}

/// A quantity that other sessions share, and whose sessions they are.
fn noted(what: Noted) -> (&'static str, &'static str) {
    match what {
        Noted::RestLength => ("the resting length of the specimen", "specimen"),
        Noted::ContractedLength => ("the contracted length of the specimen", "specimen"),
        Noted::Diameter => ("the diameter", "campaign"),
    }
}

fn not_compared(why: NotCompared) -> &'static str {
    match why {
        NotCompared::NoReadings => "no reading to compare with other actuators",
        NotCompared::NoLogs => "its logs are missing: there is nothing to check",
        NotCompared::Torque => "torques are not compared with other actuators",
        NotCompared::NoLaw => {
            "no law is known for this diameter: not compared with other actuators"
        }
    }
}

/// Another description of the columns, as a message.
pub fn described(otherwise: &Otherwise) -> String {
    let column = otherwise.column.as_deref();
    let column = column.map_or_else(String::new, name::column);
    match (otherwise.kind, &otherwise.units) {
        (ErrorKind::SwappedColumns, _) => {
            "force and pressure look exchanged in [columns]".to_owned()
        }
        (_, Some((noted, looks))) => {
            format!("the unit of the {column} looks like {looks}, not {noted}")
        }
        _ => format!("the sign of the {column} looks wrong (gain in [columns])"),
    }
}

fn zero(source: &str, applied_n: f64, clipped: Option<f64>, slack_n: Option<f64>) -> String {
    let from = match source {
        "zero-log" => "from the zero log",
        "slack" => "from the slack actuator",
        "clipped-zero-log" => "the limit of a clipped zero log",
        _ => "none: no zero log, and the actuator is never slack",
    };
    let clipped = clipped
        .filter(|share| *share > 0.0)
        .map_or_else(String::new, |share| {
            format!(
                "; {} of the zero log is at the limit of the converter",
                percent(share)
            )
        });
    let slack = slack_n.map_or_else(String::new, |n| {
        format!("; the slack actuator shows {n:.1} N")
    });
    format!("zero of the force {applied_n:.1} N, {from}{clipped}{slack}")
}
