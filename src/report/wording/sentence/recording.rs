//! What in the records looks mistaken.

use super::found::MOST_NAMED;
use crate::number::Rounding;
use crate::wording::name::{self, listed};
use crate::wording::number::{count, rounded, with_unit};
use pipeline_findings::{ErrorKind, Level, RecordingError};

/// `recording error: session s05 (set length, −10 mm; set aside here only)`; of lengths and arms by hand these alone are set aside.
pub(super) fn recording_errors(all: &[RecordingError]) -> Option<String> {
    let mut order: Vec<&RecordingError> = all.iter().collect();
    order.sort_by_key(|e| !e.set_aside);
    let mut said: Vec<String> = order
        .iter()
        .take(MOST_NAMED)
        .map(|e| recording_error(e))
        .collect();
    if order.len() > MOST_NAMED {
        said.push(format!("{} more", count(order.len() - MOST_NAMED)));
    }
    let plural = if all.len() == 1 { "" } else { "s" };
    (!said.is_empty()).then(|| format!("recording error{plural}: {}", listed(&said)))
}

/// `recording error: session s05 (set length, −10 mm)`: the first, and how many more there are.
pub(super) fn recording_errors_in_short(all: &[RecordingError]) -> Option<String> {
    let first = all.iter().find(|e| e.set_aside).or_else(|| all.first())?;
    let (plural, more) = match all.len() {
        1 => ("", String::new()),
        n => ("s", format!(" and {} more", count(n - 1))),
    };
    Some(format!(
        "recording error{plural}: {}{more}",
        with_size(first, "")
    ))
}

/// `session s05 (set length, −10 mm)`, with what follows inside the bracket.
fn with_size(e: &RecordingError, aside: &str) -> String {
    let size = recorded_size(e).map_or_else(String::new, |s| format!(", {s}"));
    let kind = name::recording_error(e.kind, e.quantity.as_deref());
    format!("{} {} ({kind}{size}{aside})", name::level(e.level), e.group)
}

fn recording_error(e: &RecordingError) -> String {
    let aside = match set_aside(e) {
        _ if !e.set_aside => String::new(),
        Some(alone) => format!("; {alone} set aside, its torques stay"),
        // The paper's tables are fits that came before the search.
        None if matches!(e.level, Level::Session | Level::Specimen) => {
            "; set aside here only".to_owned()
        }
        None => "; set aside".to_owned(),
    };
    with_size(e, &aside)
}

/// What a fit holds that looks mistaken, and what to do, a sentence without its full stop; none where nothing does.
pub fn in_doubt<'a>(all: impl Iterator<Item = &'a RecordingError>) -> Option<String> {
    let named = |e: &RecordingError| {
        let kind = name::recording_error(e.kind, e.quantity.as_deref());
        format!("{} {} ({kind})", name::level(e.level), e.group)
    };
    let all: Vec<String> = all.map(named).collect();
    let (verb, them) = if all.len() == 1 {
        ("looks", "it")
    } else {
        ("look", "them")
    };
    (!all.is_empty()).then(|| {
        format!(
            "{} {verb} misrecorded, and this fit includes {them}: correct session.toml or exclude {them} there (exclude = \"why\"), and run again",
            listed(&all)
        )
    })
}

/// Sessions whose readings no such actuator gives, and what to do, a sentence; none where there are none.
pub fn implausible(sessions: &[String]) -> Option<String> {
    let mut named: Vec<String> = sessions.iter().take(MOST_NAMED).cloned().collect();
    if sessions.len() > MOST_NAMED {
        named.push(format!("{} more", count(sessions.len() - MOST_NAMED)));
    }
    (!sessions.is_empty()).then(|| {
        format!(
            "The readings of {} look doubtful for such an actuator: check columns, units, states and lengths in session.toml (`pipeline status` says why).",
            listed(&named)
        )
    })
}

/// What of a group was set aside where that is not all of its readings: lengths or arms that were measured by hand beside its torques.
pub fn set_aside(e: &RecordingError) -> Option<&'static str> {
    match e.quantity.as_deref() {
        _ if !e.set_aside || e.level != Level::Test => None,
        Some("moment_arm") => Some("its arms alone"),
        Some("muscle_length") => Some("its lengths alone"),
        _ => None,
    }
}

/// The size of a recording error: a factor, or true less recorded.
pub fn recorded_size(e: &RecordingError) -> Option<String> {
    let value = e.value?;
    let number = rounded(value, Rounding::Digits(3));
    Some(match e.kind {
        ErrorKind::Unit => format!("factor {number}"),
        ErrorKind::SwappedColumns => format!("then a zero of {}", with_unit(&number, &e.unit)),
        _ => with_unit(&number, &e.unit),
    })
}
