//! Speed, memory and scale: a table of what runs take at several numbers of sessions.
//!
//! ```text
//! cargo build --release && cargo run --release --example scale -- --sessions 50,500,5000 --dir /tmp/scale
//! ```
//! Makes the sessions with `pipeline simulate` (kept in `--dir` for the next benchmark, else in a temporary folder), then runs the
//! program on them as a user would: from nothing, without changes, with one log, one option, the code of the models changed. What its processes take is
//! asked of the system. `--rows` sets the rows of a log, `--throughput N` prints megabytes a second at N sessions only.

mod code;
mod laboratory;
mod measure;
mod throughput;

use laboratory::Laboratory;
use measure::Taken;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs of what is short; the median is printed.
const RUNS: usize = 5;

struct Settings {
    sessions: Vec<usize>,
    throughput: bool,
    rows: usize,
    folder: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [probe, what, raw, work] = arguments.as_slice()
        && probe == throughput::PROBE
    {
        return throughput::probe(what, Path::new(raw), Path::new(work));
    }
    let settings = settings(&arguments)?;
    let temporary = tempfile::tempdir()?;
    let folder = settings.folder.as_deref().unwrap_or(temporary.path());
    std::fs::create_dir_all(folder)?;
    let program = program()?;
    for sessions in settings.sessions {
        let lab = laboratory::make(&program, folder, sessions, settings.rows)?;
        if settings.throughput {
            throughput::table(&lab, folder)?;
        } else {
            runs(&program, folder, &lab)?;
        }
    }
    Ok(())
}

fn settings(arguments: &[String]) -> Result<Settings, Box<dyn Error>> {
    let mut settings = Settings {
        sessions: vec![50, 500],
        throughput: false,
        rows: 4000,
        folder: None,
    };
    let mut rest = arguments.iter();
    while let Some(option) = rest.next() {
        let value = rest
            .next()
            .ok_or_else(|| format!("{option} needs a value"))?;
        let numbers = || {
            value
                .split(',')
                .map(str::parse)
                .collect::<Result<Vec<usize>, _>>()
        };
        match option.as_str() {
            "--sessions" => settings.sessions = numbers()?,
            "--throughput" => (settings.sessions, settings.throughput) = (numbers()?, true),
            "--rows" => settings.rows = value.parse()?,
            "--dir" => settings.folder = Some(PathBuf::from(value)),
            other => {
                return Err(format!(
                    "{other} is no option; see the first lines of examples/scale/main.rs"
                )
                .into());
            }
        }
    }
    Ok(settings)
}

/// The program, which Cargo puts one folder above its examples.
fn program() -> Result<PathBuf, Box<dyn Error>> {
    let here = std::env::current_exe()?;
    let program = here.ancestors().nth(2).map(|d| d.join("pipeline"));
    program
        .filter(|p| p.exists())
        .ok_or_else(|| "no program; build it first: cargo build --release".into())
}

fn runs(program: &Path, folder: &Path, lab: &Laboratory) -> Result<(), Box<dyn Error>> {
    let work = folder.join(format!("work-{}", lab.sessions));
    let _ = std::fs::remove_dir_all(&work);
    std::fs::create_dir_all(&work)?;
    let once = |more: &[&str], fine: &[i32]| {
        let mut command = Command::new(program);
        command
            .current_dir(&work)
            .args(more)
            .arg("--raw")
            .arg(&lab.raw);
        measure::of(&mut command, fine)
    };
    let run = |more: &[&str]| once(&[&["run", "--json"], more].concat(), &[]);
    println!(
        "\n| {} sessions | s | processor s | peak MB | computed (thread s) |\n|---|---|---|---|---|",
        lab.sessions
    );
    row("cold", &run(&[])?)?;
    run(&[])?;
    row("warm", &measure::median(RUNS, || run(&[]))?)?;
    row(
        "`status`",
        &measure::median(RUNS, || once(&["status", "--json"], &[0]))?,
    )?;
    let log = laboratory::logs(&lab.raw).pop().ok_or("no log")?;
    row(
        "one log changed",
        &measure::median(RUNS, || {
            change(&log)?;
            run(&[])
        })?,
    )?;
    std::fs::write(work.join("title.toml"), "[report]\ntitle = \"Another\"\n")?;
    row("`report.title` changed", &run(&["--config", "title.toml"])?)?;
    std::fs::write(work.join("settle.toml"), "[clean]\nsettle_s = 0.16\n")?;
    row(
        "`clean.settle_s` changed",
        &run(&["--config", "settle.toml"])?,
    )?;
    run(&[])?;
    code::pretend_other_models(&work.join("derived"))?;
    row("code of the models changed", &run(&[])?)
}

/// Another last digit of the first column in every line, so that every reading of the log is another.
fn change(log: &Path) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(log)?;
    let other = |line: &str| {
        let (first, rest) = line.split_once(',').unwrap_or((line, ""));
        let (head, last) = first.split_at(first.len().saturating_sub(1));
        let digit = last.parse().map_or(0, |d: u8| (d + 1) % 10);
        format!("{head}{digit},{rest}\n")
    };
    let lines: Vec<String> = text.lines().map(other).collect();
    std::fs::write(log, lines.concat())?;
    Ok(())
}

fn row(name: &str, taken: &Taken) -> Result<(), Box<dyn Error>> {
    println!(
        "| {name} | {:.2} | {:.2} | {:.0} | {} |",
        taken.wall.as_secs_f64(),
        taken.processor.as_secs_f64(),
        taken.peak as f64 / 1e6,
        computed(&taken.said)?
    );
    Ok(())
}

/// How many results of each stage were computed, and how long their threads took.
fn computed(said: &str) -> Result<String, Box<dyn Error>> {
    let outcome: serde_json::Value = serde_json::from_str(said)?;
    let empty = Vec::new();
    let work = outcome["computed"].as_array().unwrap_or(&empty);
    let of = |stage: &str| {
        let its: Vec<f64> = work
            .iter()
            .filter(|w| w["stage"] == stage)
            .filter_map(|w| w["took_s"].as_f64())
            .collect();
        (!its.is_empty()).then(|| format!("{} {stage} ({:.1})", its.len(), its.iter().sum::<f64>()))
    };
    Ok(pipeline::run::STAGES
        .iter()
        .filter_map(|s| of(s))
        .collect::<Vec<_>>()
        .join(", "))
}
