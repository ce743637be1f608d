//! What the commands print.

use super::answers;
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::error::{Error, Result};
use pipeline_cache::reason::one_line;
use pipeline_report::left_out::{LeftOut, counted};
use pipeline_run::step::Failure;
use pipeline_run::{Outcome, STAGES};
use pipeline_simulate::Campaign;
use serde_json::json;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

/// How many messages of one kind are printed before the rest is counted.
const SHOWN: usize = 20;

/// Prints to standard output; a closed pipe (`pipeline run | head`) ends the printing, not the program.
pub(super) fn line(text: impl std::fmt::Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// The defaults.
pub fn config(text: &str) {
    line(text.trim_end());
}

/// Errors and warnings; notes only if asked for.
pub fn diagnostics(all: &[Diagnostic], verbose: bool) {
    let loud: Vec<&Diagnostic> = all
        .iter()
        .filter(|d| verbose || d.severity != Severity::Note)
        .collect();
    let shown = if verbose { loud.len() } else { SHOWN };
    for diagnostic in loud.iter().take(shown) {
        eprintln!("{diagnostic}");
    }
    if loud.len() > shown {
        eprintln!(
            "and {} more messages; --verbose prints them all",
            loud.len() - shown
        );
    }
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
    if outcome.work.is_empty() {
        for path in &outcome.written {
            line(format!("{}: missing or changed by hand", path.display()));
        }
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

/// The outcome of a run.
pub fn run(outcome: &Outcome, took: Duration, explain: bool, as_json: bool) -> Result<()> {
    if as_json {
        let rejected: Vec<_> = outcome
            .rejected
            .iter()
            .map(|(id, why)| json!({ "session": id, "reason": why }))
            .collect();
        let logs: Vec<_> = outcome
            .rejected_logs
            .iter()
            .map(|(session, log, why)| json!({ "session": session, "log": log, "reason": why }))
            .collect();
        return print_json(&json!({
            "sessions": outcome.sessions, "computed": work_json(outcome), "up_to_date": outcome.fresh,
            "failed": failed_json(outcome), "left_out": outcome.left_out,
            "rejected_sessions": rejected, "rejected_logs": logs, "files_written": paths(&outcome.written),
            "reports": paths(&outcome.pdfs), "findings": outcome.findings_file.as_ref().map(|f| f.display().to_string()),
            "new_answers": outcome.answers.iter().map(answers::as_json).collect::<Vec<_>>(),
        }));
    }
    if explain {
        reasons(outcome);
    }
    for (session, log, why) in &outcome.rejected_logs {
        line(format!("left out: log {log} of session {session}: {why}"));
    }
    for (session, why) in &outcome.rejected {
        line(format!("left out: session {session}: {why}"));
    }
    for failure in &outcome.failed {
        let Failure { stage, unit, why } = failure;
        line(format!("failed: {stage} {unit}: {why}"));
    }
    left_out(&outcome.left_out);
    let seconds = took.as_secs_f64();
    if outcome.failed.is_empty() && outcome.work.is_empty() && outcome.written.is_empty() {
        line(format!(
            "nothing to do: {} sessions, all {} results are up to date ({seconds:.2} s)",
            outcome.sessions, outcome.fresh
        ));
    } else {
        line(format!(
            "{} sessions: computed {} results ({}), {} were up to date; {} files written ({seconds:.2} s)",
            outcome.sessions,
            outcome.work.len(),
            counts(outcome),
            outcome.fresh,
            outcome.written.len()
        ));
    }
    for found in &outcome.answers {
        answers::lines(found).into_iter().for_each(line);
    }
    if let Some(file) = &outcome.findings_file {
        line(format!("findings: {}", file.display()));
    }
    for pdf in &outcome.pdfs {
        line(format!("report: {}", pdf.display()));
    }
    Ok(())
}

/// Figures and documents that could not be built: a line for each of the first, and how many there are.
pub fn left_out(all: &[LeftOut]) {
    for one in all.iter().take(SHOWN) {
        eprintln!("left out: {one}");
    }
    if !all.is_empty() {
        eprintln!(
            "{} left out for a defect of pipeline itself, please report it; everything else is complete, and summary.json names them. Once it is mended, or to try \
             again: pipeline run --force report",
            counted(all)
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
    left_out(&outcome.left_out);
    if outcome.work.is_empty() && outcome.written.is_empty() {
        line(format!(
            "nothing to do: all {} results are up to date",
            outcome.fresh
        ));
    } else {
        line(format!(
            "{} results would be computed ({}), {} are up to date; {} files would be put back",
            outcome.work.len(),
            counts(outcome),
            outcome.fresh,
            outcome.written.len()
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
