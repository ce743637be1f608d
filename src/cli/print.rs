//! What the commands print.

use super::summary::{Answers, Detail};
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::error::{Error, Result};
use pipeline_cache::reason::one_line;
use pipeline_report::left_out::{self, LeftOut};
use pipeline_run::step::Failure;
use pipeline_run::{Doubtful, Outcome, Rejected, STAGES};
use pipeline_simulate::Campaign;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How many messages of one kind are printed before the rest is counted.
const SHOWN: usize = 20;

/// Prints to standard output; a closed pipe (`pipeline run | head`) ends the printing, not the program.
pub(super) fn line(text: impl std::fmt::Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// A number with its noun.
pub(super) fn counted(n: usize, one: &str, several: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { several })
}

/// The defaults.
pub fn config(text: &str) {
    line(text.trim_end());
}

/// Errors, then warnings; notes only if asked for. Files are named by their paths, of which messages have what is below a raw directory.
pub fn diagnostics(all: &[Diagnostic], raw: &[PathBuf], verbose: bool) {
    let mut loud: Vec<&Diagnostic> = all
        .iter()
        .filter(|d| verbose || d.severity != Severity::Note)
        .collect();
    loud.sort_by_key(|d| std::cmp::Reverse(d.severity));
    // A mistake in campaign.toml is one of every session below it.
    let mut said = std::collections::BTreeSet::new();
    loud.retain(|d| said.insert(d.to_string()));
    let shown = if verbose { loud.len() } else { SHOWN };
    for diagnostic in loud.iter().take(shown) {
        eprintln!("{}", placed(diagnostic, raw));
    }
    if loud.len() > shown {
        eprintln!(
            "and {} more messages; --verbose prints them all",
            loud.len() - shown
        );
    }
}

/// The message with the path of its file: in the first raw directory that has it, or its folder.
fn placed(diagnostic: &Diagnostic, raw: &[PathBuf]) -> Diagnostic {
    let placed = raw.iter().map(|raw| diagnostic.clone().below(raw));
    let placed: Vec<Diagnostic> = placed.collect();
    let has_file = |d: &&Diagnostic| Path::new(&*d.file).exists();
    let has_folder = |d: &&Diagnostic| Path::new(&*d.file).parent().is_some_and(Path::is_dir);
    let found = placed.iter().find(has_file);
    let found = found.or_else(|| placed.iter().find(has_folder));
    found.unwrap_or(diagnostic).clone()
}

fn counts(outcome: &Outcome) -> String {
    let of = |stage: &str| outcome.work.iter().filter(|w| w.stage == stage).count();
    let parts: Vec<String> = STAGES
        .iter()
        .map(|stage| (stage, of(stage)))
        .filter(|(_, n)| *n > 0)
        .map(|(stage, n)| format!("{stage} {n}"))
        .collect();
    if parts.is_empty() {
        return "none".to_owned();
    }
    parts.join(", ")
}

/// One line for every unit and file that was, or would be, made anew.
fn reasons(outcome: &Outcome) {
    for work in &outcome.work {
        let why = one_line(&work.reasons);
        line(format!("{} {}: {why}", work.stage, work.unit));
    }
}

/// One line for each of the first files that were, or would be, put back though their results were there.
fn put_back(written: &[std::path::PathBuf]) {
    for path in written.iter().take(SHOWN) {
        let what = match path.exists() {
            true => "changed since the run",
            false => "missing",
        };
        line(format!("{}: {what}", path.display()));
    }
    if written.len() > SHOWN {
        line(format!(
            "and {} more files; --json lists them",
            written.len() - SHOWN
        ));
    }
}

fn paths(list: &[std::path::PathBuf]) -> Vec<String> {
    list.iter().map(|p| p.display().to_string()).collect()
}

fn work_json(outcome: &Outcome) -> Vec<serde_json::Value> {
    let entry = |w: &pipeline_run::step::Work| {
        let reasons: Vec<String> = w.reasons.iter().map(ToString::to_string).collect();
        json!({ "stage": w.stage, "unit": w.unit, "reasons": reasons, "took_s": w.took.as_secs_f64() })
    };
    outcome.work.iter().map(entry).collect()
}

fn failed_json(outcome: &Outcome) -> Vec<serde_json::Value> {
    let entry = |f: &Failure| json!({ "stage": f.stage, "unit": f.unit, "why": f.why });
    outcome.failed.iter().map(entry).collect()
}

pub(super) fn print_json(value: &serde_json::Value) -> Result<()> {
    line(serde_json::to_string_pretty(value).map_err(Error::internal)?);
    Ok(())
}

/// The outcome of a run for other programs.
pub fn run_as_json(outcome: &Outcome, answers: Option<&Answers>) -> Result<()> {
    let session = |r: &Rejected| json!({ "session": r.session, "reason": r.reason, "looked_for": paths(&r.looked_for) });
    let log = |r: &Rejected| json!({ "session": r.session, "log": r.log, "reason": r.reason });
    let doubtful =
        |d: &Doubtful| json!({ "session": d.session, "campaign": d.campaign, "doubt": d.doubt });
    let excluded = |(id, why): &(String, String)| json!({ "session": id, "reason": why });
    print_json(&json!({
        "sessions": outcome.sessions, "computed": work_json(outcome), "up_to_date": outcome.fresh,
        "failed": failed_json(outcome), "left_out": outcome.left_out,
        "rejected_sessions": outcome.rejected.iter().map(session).collect::<Vec<_>>(),
        "rejected_logs": outcome.rejected_logs.iter().map(log).collect::<Vec<_>>(),
        "doubtful_sessions": outcome.doubtful.iter().map(doubtful).collect::<Vec<_>>(),
        "excluded_sessions": outcome.excluded.iter().map(excluded).collect::<Vec<_>>(),
        "files_written": paths(&outcome.written), "reports": paths(&outcome.pdfs),
        "findings": outcome.findings_file.as_ref().map(|f| f.display().to_string()),
        "answers": answers.map(Answers::as_json),
    }))
}

/// The outcome of a run.
pub fn run(outcome: &Outcome, answers: Option<&Answers>, took: Duration, explain: bool) {
    if explain {
        reasons(outcome);
        if outcome.work.is_empty() {
            put_back(&outcome.written);
        }
    }
    inputs_left_out(outcome);
    for failure in &outcome.failed {
        let Failure { stage, unit, why } = failure;
        line(format!("failed: {stage} {unit}: {why}"));
    }
    left_out(&outcome.left_out);
    let seconds = took.as_secs_f64();
    if outcome.failed.is_empty() && outcome.work.is_empty() && outcome.written.is_empty() {
        line(format!(
            "nothing to do: {}, all {} results are up to date ({seconds:.2} s)",
            counted(outcome.sessions, "session", "sessions"),
            outcome.fresh
        ));
    } else {
        line(format!(
            "{}: computed {} ({}), {} up to date; {} written ({seconds:.2} s)",
            counted(outcome.sessions, "session", "sessions"),
            counted(outcome.work.len(), "result", "results"),
            counts(outcome),
            outcome.fresh,
            counted(outcome.written.len(), "file", "files")
        ));
    }
    if let Some(answers) = answers {
        answers.print(Detail::InShort);
    }
    if let Some(file) = &outcome.findings_file {
        line(format!("findings: {}", file.display()));
    }
    for pdf in &outcome.pdfs {
        line(format!("report: {}", pdf.display()));
    }
}

/// The sessions and logs that no message has named yet, and how many of each kind are left out.
fn inputs_left_out(outcome: &Outcome) {
    let all = outcome.rejected_logs.iter().chain(&outcome.rejected);
    let unsaid: Vec<&Rejected> = all.filter(|r| !r.has_diagnostic).collect();
    for Rejected {
        session,
        log,
        reason,
        looked_for,
        ..
    } in unsaid.iter().take(SHOWN)
    {
        line(match (log.as_str(), &looked_for[..]) {
            ("", []) => format!("left out: session {session}: {reason}"),
            ("", paths) => format!("left out: session {session}: {}", missing(paths)),
            (log, _) => format!("left out: log {log} of session {session}: {reason}"),
        });
    }
    let (logs, sessions) = (outcome.rejected_logs.len(), outcome.rejected.len());
    if logs + sessions > 0 {
        let all = outcome.sessions + outcome.unusable;
        line(format!(
            "left out: {sessions} of {}, {} (tables/rejects.csv has all reasons)",
            counted(all, "session", "sessions"),
            counted(logs, "log", "logs")
        ));
    }
    let kept_out = [
        ("excluded by `exclude` in session.toml", &outcome.excluded),
        (
            "kept apart because of a word in their notes (`torque.doubtful_words`)",
            &outcome.doubted,
        ),
    ];
    for (how, sessions) in kept_out {
        let Some((id, why)) = sessions.first() else {
            continue;
        };
        let others = match sessions.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        };
        line(format!(
            "{how}: {} of {}: {id} (\"{why}\"){others}",
            sessions.len(),
            counted(outcome.sessions, "session", "sessions")
        ));
    }
}

/// Paths of missing logs that are named before the rest is counted.
const PATHS: usize = 4;

fn missing(looked_for: &[std::path::PathBuf]) -> String {
    let named = paths(&looked_for[..looked_for.len().min(PATHS)]).join(", ");
    let more = match looked_for.len().saturating_sub(PATHS) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    format!("none of its logs is there; looked for {named}{more}")
}

/// Figures and documents that could not be built: a line for each of the first, and how many there are.
pub fn left_out(all: &[LeftOut]) {
    for one in all.iter().take(SHOWN) {
        eprintln!("left out: {one}");
    }
    if !all.is_empty() {
        eprintln!(
            "{} left out because of a defect in pipeline itself, please report it; everything else is complete, and summary.json names them. To \
             retry, or once it is fixed: pipeline run --force report",
            left_out::counted(all)
        );
    }
}

/// What would run.
pub fn status(outcome: &Outcome, as_json: bool) -> Result<()> {
    if as_json {
        return print_json(&json!({
            "would_run": work_json(outcome), "up_to_date": outcome.fresh, "would_put_back": paths(&outcome.written),
            "left_out": outcome.left_out,
        }));
    }
    reasons(outcome);
    put_back(&outcome.written);
    left_out(&outcome.left_out);
    if outcome.work.is_empty() && outcome.written.is_empty() {
        line(format!(
            "nothing to do: all {} results are up to date",
            outcome.fresh
        ));
    } else {
        line(format!(
            "{} would be computed ({}), {} up to date; {} would be restored",
            counted(outcome.work.len(), "result", "results"),
            counts(outcome),
            outcome.fresh,
            counted(outcome.written.len(), "file", "files")
        ));
    }
    Ok(())
}

/// What was simulated.
pub fn simulated(campaign: &Campaign, out: &Path) {
    line(format!(
        "{} simulated sessions written to {}",
        campaign.sessions.len(),
        out.display()
    ));
}
