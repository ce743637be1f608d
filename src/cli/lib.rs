#![warn(missing_docs)]
//! The command line: arguments, and all printing.
//!
//! Results go to standard output; progress, warnings and errors to standard error. Exit codes: 0 done; 1 `status` found work to
//! do or `check` a difference; 2 usage, configuration or no usable input; 3 done, but sessions were rejected and `--strict` was given; 4 internal;
//! 5 done, but a figure or document was left out for a defect of the program.

mod answers;
mod args;
mod bundle;
mod cell;
mod check;
mod check_session;
mod check_session_words;
mod columns;
mod design;
mod design_curve;
mod diff;
mod diff_tables;
mod doubts;
mod draft_places;
mod explain;
mod explore;
mod export;
mod export_model;
mod gc;
mod graph;
mod init;
mod laws;
mod manual;
mod new_session;
mod places;
mod plan;
mod plan_print;
mod predict;
mod predict_calibrate;
mod predict_head;
mod predict_leg;
mod predict_print;
mod print;
mod progress;
mod summary;
mod values;
mod watch;

use args::{Args, Command, PlaceArgs, RunArgs, SimulateArgs};
use clap::Parser;
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_run as run;
use pipeline_run::{Outcome, RunOptions};
use pipeline_simulate as simulate;
use places::Places;
use std::ffi::OsString;

const DONE: u8 = 0;
const DIFFERENCE: u8 = 1;
const USAGE: u8 = 2;
const REJECTED: u8 = 3;
const INTERNAL: u8 = 4;
const LEFT_OUT: u8 = 5;

/// Runs the command that the arguments name; the exit code.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let args = match Args::try_parse_from(arguments) {
        Ok(args) => args,
        Err(error) => {
            let _ = error.print();
            return if error.use_stderr() { USAGE } else { DONE };
        }
    };
    let done = match &args.command {
        Command::Run(run) => run_command(run),
        Command::Status(run) => status_command(run),
        Command::Summary(args) => summary::command(args),
        Command::Check(args) => check::command(args),
        Command::Init(args) => init::command(args),
        Command::Design(args) => design::command(args),
        Command::Predict(args) => predict::command(args),
        Command::Simulate(simulate) => simulate_command(simulate),
        Command::NewSession(args) => new_session::command(args),
        Command::Explain(args) => explain::command(args),
        Command::Diff(args) => diff::command(args),
        Command::Plan(args) => plan::command(args),
        Command::CheckSession(args) => check_session::command(args),
        Command::Explore(args) => explore::command(args),
        Command::Graph(args) => graph::command(args),
        Command::Gc(args) => gc::command(args),
        Command::Export(args) => export::command(args),
        Command::Bundle(args) => bundle::command(args),
        Command::Completions(args) => manual::completions(args),
        Command::Man(args) => manual::command(args),
        Command::Config => Config::default().to_commented_toml().map(|text| {
            print::config(&text);
            DONE
        }),
    };
    done.unwrap_or_else(|error| {
        eprintln!("{error}");
        error.exit_code()
    })
}

fn options(places: &Places, jobs: u64, force: Option<&str>, dry_run: bool) -> Result<RunOptions> {
    let force = match force {
        Some(stage) if !run::STAGES.contains(&stage) => {
            return Err(Error::Usage(format!(
                "no stage is called \"{stage}\"; the stages are {}",
                run::STAGES.join(", ")
            )));
        }
        force => force.map(ToOwned::to_owned),
    };
    Ok(RunOptions {
        raw: places.raw.clone(),
        derived: places.derived.clone(),
        reports: places.reports.clone(),
        config: places.config.clone(),
        jobs: jobs as usize,
        force,
        dry_run,
        keep_going: false,
        only: None,
    })
}

/// Nothing here ever uses a network; this says so to those who would give it one.
fn refuse_remote(raw: &[std::path::PathBuf]) -> Result<()> {
    let remote = raw.iter().find(|r| r.to_string_lossy().contains("://"));
    remote.map_or(Ok(()), |raw| {
        Err(Error::Usage(format!(
            "--offline-only: {} is on a network; fetch the sessions and give the folder with --raw DIR",
            raw.display()
        )))
    })
}

fn run_command(args: &RunArgs) -> Result<u8> {
    let started = std::time::Instant::now();
    let (json, verbose) = (args.places.json, args.places.verbose);
    let places = args.places.places()?;
    if args.offline_only {
        refuse_remote(&places.raw)?;
    }
    let options = RunOptions {
        keep_going: args.keep_going,
        only: args.only.clone(),
        ..options(
            &places,
            args.places.jobs,
            args.force.as_deref(),
            args.dry_run,
        )?
    };
    let progress = progress::Shown::new(json);
    let outcome = run::run(&options, &progress)?;
    progress.finish();
    print::diagnostics(&doubts::messages(&outcome), &options.raw, verbose);
    if args.dry_run {
        print::status(&outcome, json)?;
        return Ok(DONE);
    }
    let answers = match outcome.findings_file {
        Some(_) => Some(summary::Answers::load(&places.reports)?),
        None => None,
    };
    let took = started.elapsed();
    if json {
        print::run_as_json(&outcome, answers.as_ref())?;
    } else {
        print::run(&outcome, answers.as_ref(), took, args.explain);
    }
    if !outcome.failed.is_empty() {
        return Ok(INTERNAL);
    }
    if args.only.is_none() {
        nothing_usable(&outcome)?;
    }
    if !outcome.left_out.is_empty() {
        return Ok(LEFT_OUT);
    }
    let strict = args.strict && !outcome.rejected.is_empty();
    Ok(if strict { REJECTED } else { DONE })
}

/// A run in which every session was rejected or excluded is no success; of a job nobody can say that.
fn nothing_usable(outcome: &Outcome) -> Result<()> {
    if outcome.has_nothing_usable() {
        return Err(Error::Usage(
            "no session is left to work with; the messages above say why".to_owned(),
        ));
    }
    Ok(())
}

fn status_command(args: &PlaceArgs) -> Result<u8> {
    let options = options(&args.places()?, args.jobs, None, true)?;
    let outcome = run::run(&options, &progress::Shown::new(true))?;
    print::diagnostics(&doubts::messages(&outcome), &options.raw, args.verbose);
    print::status(&outcome, args.json)?;
    Ok(if outcome.work.is_empty() && outcome.written.is_empty() {
        DONE
    } else {
        DIFFERENCE
    })
}

fn simulate_command(args: &SimulateArgs) -> Result<u8> {
    let file = args.truth.display().to_string();
    let text = std::fs::read_to_string(&args.truth)
        .map_err(|e| Error::Usage(format!("cannot read the truth file {file}: {e}")))?;
    let truth = simulate::read_truth(&file, &text).map_err(Error::Config)?;
    let campaign = simulate::simulate(&truth);
    simulate::write(
        &campaign,
        &args.out,
        args.truth_out.as_deref(),
        args.replace,
    )?;
    print::simulated(&campaign, &args.out);
    Ok(DONE)
}
