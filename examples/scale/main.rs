//! Speed, memory and scale: a table of what runs take at several numbers of sessions.
//!
//! ```text
//! cargo build --release && cargo run --release --example scale -- --sessions 50,500,5000 --dir /tmp/scale
//! ```
//! Makes the sessions with `pipeline simulate` (kept in `--dir` for the next benchmark, else in a temporary folder), then runs the
//! program on them as a user would: from nothing, without changes, with one log, one option, the code of the models changed. What its processes take is
//! asked of the system. `--rows` sets the rows of a log, `--throughput N` prints megabytes a second at N sessions only. `--fitted N` keeps all but N
//! sessions of a campaign out of every fit, `--config FILE` has the options of all runs: fits of thousands of sessions take minutes, their search longer.

mod code;
mod laboratory;
mod measure;
mod throughput;

use laboratory::Laboratory;
use measure::Taken;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Runs of what is short; the median is printed.
const RUNS: usize = 5;
/// After this long a file that has not changed is believed to be unchanged.
const SETTLING: Duration = Duration::from_millis(2500);

struct Settings {
    sessions: Vec<usize>,
    throughput: bool,
    rows: usize,
    fitted: usize,
    config: toml::Table,
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
        let lab = laboratory::make(&program, folder, sessions, settings.rows, settings.fitted)?;
        if settings.throughput {
            throughput::table(&lab, folder)?;
        } else {
            runs(&program, folder, &lab, &settings.config)?;
        }
    }
    Ok(())
}

fn settings(arguments: &[String]) -> Result<Settings, Box<dyn Error>> {
    let mut settings = Settings {
        sessions: vec![50, 500],
        throughput: false,
        rows: 4000,
        fitted: laboratory::CAMPAIGN,
        config: toml::Table::new(),
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
            "--fitted" => settings.fitted = value.parse()?,
            "--config" => settings.config = std::fs::read_to_string(value)?.parse()?,
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

fn runs(
    program: &Path,
    folder: &Path,
    lab: &Laboratory,
    config: &toml::Table,
) -> Result<(), Box<dyn Error>> {
    let work = folder.join(format!("work-{}", lab.sessions));
    let _ = std::fs::remove_dir_all(&work);
    std::fs::create_dir_all(&work)?;
    let once = |command: &str, config: &str, fine: &[i32]| {
        let mut process = Command::new(program);
        process
            .current_dir(&work)
            .args([command, "--json", "--config", config, "--raw"])
            .arg(&lab.raw);
        measure::of(&mut process, fine)
    };
    let usual = with(&work, "usual.toml", config, None)?;
    let run = |config: &str| once("run", config, &[]);
    println!(
        "\n| {} sessions | s | processor s | peak MB | computed (thread s) |\n|---|---|---|---|---|",
        lab.sessions
    );
    row("from nothing", &run(&usual)?)?;
    // What has just been written is not believed to be unchanged.
    std::thread::sleep(SETTLING);
    row("without changes, the first time", &run(&usual)?)?;
    row("without changes", &measure::median(RUNS, || run(&usual))?)?;
    let status = || once("status", &usual, &[0]);
    row("`status`", &measure::median(RUNS, status)?)?;
    let log = laboratory::logs(&lab.raw).pop().ok_or("no log")?;
    change(&log)?;
    row("one log changed", &run(&usual)?)?;
    let title = with(
        &work,
        "title.toml",
        config,
        Some(("report", "title", "Another".into())),
    )?;
    row("`report.title` changed", &run(&title)?)?;
    let settle = with(
        &work,
        "settle.toml",
        config,
        Some(("clean", "settle_s", 0.16.into())),
    )?;
    row("`clean.settle_s` changed", &run(&settle)?)?;
    run(&usual)?;
    code::pretend_other_models(&work.join("derived"))?;
    row("code of the models changed", &run(&usual)?)
}

/// Writes the options to a file, one of them changed; its path.
fn with(
    work: &Path,
    name: &str,
    config: &toml::Table,
    changed: Option<(&str, &str, toml::Value)>,
) -> Result<String, Box<dyn Error>> {
    let mut config = config.clone();
    if let Some((section, key, value)) = changed {
        let section = config
            .entry(section)
            .or_insert_with(|| toml::Table::new().into());
        let section = section.as_table_mut().ok_or("a section is no table")?;
        section.insert(key.to_owned(), value);
    }
    std::fs::write(work.join(name), toml::to_string(&config)?)?;
    Ok(name.to_owned())
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
