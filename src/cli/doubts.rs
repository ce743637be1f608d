//! What a run doubts about the readings of sessions, in words: a warning for each kind of doubt in a campaign, on the first session that has it.

use crate::check_session_words::described;
use crate::print::counted;
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_formats::discover::SESSION_FILE;
use pipeline_inspect::otherwise::Otherwise;
use pipeline_inspect::plausible::{Doubt, Phases, Stretched, Unlike};
use pipeline_report::wording::number::percent;
use pipeline_run::{Doubtful, Outcome};

/// What is wrong with the inputs of a run, and what is doubtful.
pub(super) fn messages(outcome: &Outcome) -> Vec<Diagnostic> {
    let diagnostics = outcome.diagnostics.iter().cloned();
    diagnostics.chain(warnings(&outcome.doubtful)).collect()
}

/// The warnings, in the order of the sessions.
pub(super) fn warnings(all: &[Doubtful]) -> Vec<Diagnostic> {
    let is_first = |k: usize| !all[..k].iter().any(|other| are_alike(other, &all[k]));
    let first = (0..all.len()).filter(|k| is_first(*k));
    first
        .map(|k| {
            let alike = all.iter().filter(|other| are_alike(other, &all[k]));
            warning(&all[k], alike.count())
        })
        .collect()
}

/// Whether one warning is enough for both.
fn are_alike(a: &Doubtful, b: &Doubtful) -> bool {
    let is_same = match (&a.doubt, &b.doubt) {
        (Doubt::Stretched(_), Doubt::Stretched(_)) => true,
        (Doubt::Unlike(a), Doubt::Unlike(b)) => a.columns == b.columns,
        (Doubt::Lost { columns: a, .. }, Doubt::Lost { columns: b, .. }) => a == b,
        (Doubt::Phases(_), Doubt::Phases(_)) => true,
        _ => false,
    };
    is_same && a.campaign == b.campaign
}

fn warning(doubtful: &Doubtful, sessions: usize) -> Diagnostic {
    let (key, found, expected, hint) = match &doubtful.doubt {
        Doubt::Stretched(stretched) => of_length(stretched),
        Doubt::Unlike(unlike) => of_forces(unlike),
        Doubt::Lost {
            left,
            columns,
            readings,
        } => (
            "columns",
            match left {
                0 => "no steady reading in any log".to_owned(),
                n => format!(
                    "{} in which the actuator hardly pulls",
                    counted(*n, "steady reading", "steady readings")
                ),
            },
            format!("{readings} readings, which there would be otherwise"),
            remedy(columns),
        ),
        Doubt::Phases(phases) => (
            "columns.phase",
            of_steps(phases),
            "a pressure that rises while pressurizing and falls while depressurizing".to_owned(),
            "the states look exchanged: correct `values` of the phase in [columns]".to_owned(),
        ),
    };
    let others = match sessions - 1 {
        0 => String::new(),
        n => format!(
            " (likewise {} of {})",
            counted(n, "other session", "other sessions"),
            doubtful.campaign
        ),
    };
    // By itself a session of one muscle does not tell its length from its gain.
    let more = match &doubtful.doubt {
        Doubt::Unlike(unlike) if unlike.columns.is_none() => String::new(),
        _ => format!(
            "; `pipeline check-session {}` shows more",
            doubtful.folder.display()
        ),
    };
    Diagnostic::error(
        format!("{}/{SESSION_FILE}", doubtful.relative),
        format!("{found}{others}"),
        expected,
        format!("{hint}{more}"),
    )
    .in_column(key)
    .with_severity(Severity::Warning)
}

type Words = (&'static str, String, String, String);

fn of_length(stretched: &Stretched) -> Words {
    (
        "length",
        in_words(stretched),
        "an actuator that is stretched by 3% at most".to_owned(),
        "check rest_length_mm, and length_mm or the length in [columns], with their units"
            .to_owned(),
    )
}

/// Lengths that stretch the actuator.
pub(super) fn in_words(stretched: &Stretched) -> String {
    format!(
        "a length of {:.1} mm at a resting length of {:.1} mm: stretched by {} in {}",
        stretched.length_mm,
        stretched.rest_length_mm,
        percent(stretched.share).replace('\u{a0}', " "),
        counted(stretched.readings, "reading", "readings")
    )
}

/// How many steps of the pressure go the other way than their states say.
pub(super) fn of_steps(phases: &Phases) -> String {
    format!(
        "a pressure that falls while pressurizing or rises while depressurizing in {} of {}",
        phases.against,
        counted(phases.steps, "step", "steps")
    )
}

fn of_forces(unlike: &Unlike) -> Words {
    let off = format!(
        "forces that are off the published law of {} mm actuators by {:.0} N (median of {}; median force {:.0} N)",
        unlike.diameter_mm,
        unlike.miss_n,
        counted(unlike.readings, "reading", "readings"),
        unlike.force_n
    );
    let found = match unlike.correlation {
        Some(correlation) if correlation < 0.0 => {
            format!("{off} and fall where it rises (correlation {correlation:.2})")
        }
        _ => off,
    };
    let length = unlike.shorter.map(|shorter| {
        format!(
            "a {} length than noted would agree with the law: check length_mm and rest_length_mm",
            if shorter { "shorter" } else { "longer" }
        )
    });
    let columns = unlike.columns.as_ref().map(remedy);
    let hint = match (columns, length) {
        (Some(columns), Some(length)) => format!("{columns}; or {length}"),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => {
            "check the columns with their units and signs, and the diameter and lengths of the specimen; an actuator of another make may differ so much"
                .to_owned()
        }
    };
    (
        "columns",
        found,
        "forces within a quarter of what that law gives".to_owned(),
        hint,
    )
}

fn remedy(columns: &Otherwise) -> String {
    format!(
        "{}: the readings would then agree with the law",
        described(columns)
    )
}
