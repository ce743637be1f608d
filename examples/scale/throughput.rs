//! How fast logs are hashed and parsed, beside the same work bare.
//!
//! Every line is a process of its own on all cores, over the same files in the page cache.

use crate::laboratory::{Laboratory, logs};
use crate::measure::{self, Taken};
use pipeline::base::digest::Digest;
use pipeline::base::error::Error as OurError;
use pipeline::formats::discover::discover;
use pipeline::run::engine::Engine;
use pipeline::run::units::Scope;
use pipeline::run::walk::Walk;
use pipeline::run::{RunOptions, Silent, parallel};
use polars::prelude::*;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

const RUNS: usize = 3;

/// Names the bare work in the arguments of this program.
pub const PROBE: &str = "--probe";

/// Prints megabytes of logs a second.
///
/// # Errors
/// A process fails.
pub fn table(lab: &Laboratory, work: &Path) -> Result<(), Box<dyn Error>> {
    let bytes: u64 = logs(&lab.raw)
        .iter()
        .filter_map(|f| f.metadata().ok())
        .map(|m| m.len())
        .sum();
    let megabytes = bytes as f64 / 1e6;
    println!(
        "\n| {} logs, {megabytes:.0} MB | s | MB/s | processor s |\n|---|---|---|---|",
        logs(&lab.raw).len()
    );
    let row = |name: &str, taken: &Taken| {
        let s = taken.wall.as_secs_f64();
        let processor = taken.processor.as_secs_f64();
        println!(
            "| {name} | {s:.2} | {:.0} | {processor:.2} |",
            megabytes / s
        );
        [s, processor]
    };
    let sha = measure::median(RUNS, || measure::of(&mut sha256sum(&lab.raw), &[]))?;
    row("`sha256sum`, a process a core", &sha);
    // Every process has an empty folder of its own, and none is removed before the last has ended: a file system that has just removed many
    // files is slow to make new ones.
    let places = tempfile::tempdir_in(work)?;
    let probed = |what: &str| {
        measure::median(RUNS, || {
            let place = tempfile::tempdir_in(&places)?.keep();
            let mut command = Command::new(std::env::current_exe()?);
            measure::of(command.args([PROBE, what]).arg(&lab.raw).arg(place), &[])
        })
    };
    row("SHA-256 by the pipeline's crate", &probed("hash")?);
    row("polars alone: numbers of known columns", &probed("parse")?);
    let bare = row("hash and parse, bare", &probed("bare")?);
    let whole = row(
        "ingest, clean and normalize, from nothing",
        &probed("sessions")?,
    );
    println!(
        "\nThe stages of a session come to {:.0}% of the bare throughput, by processor time to {:.0}%.",
        100.0 * bare[0] / whole[0],
        100.0 * bare[1] / whole[1]
    );
    Ok(())
}

fn sha256sum(raw: &Path) -> Command {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let mut command = Command::new("sh");
    let script = format!(
        "find \"$0\" -name '*.csv' -print0 | xargs -0 -n 50 -P {cores} sha256sum > /dev/null"
    );
    command.args(["-c", &script]).arg(raw);
    command
}

/// Does one kind of bare work; this is what the processes of the table run.
///
/// # Errors
/// A log cannot be read.
pub fn probe(what: &str, raw: &Path, work: &Path) -> Result<(), Box<dyn Error>> {
    let each = |one: fn(&[u8]) -> usize| -> Result<(), Box<dyn Error>> {
        let read = |f: &PathBuf| {
            std::fs::read(f)
                .map(|b| one(&b))
                .map_err(OurError::internal)
        };
        let done = parallel::each(0, &logs(raw), read).map_err(|e| e.to_string())?;
        println!("{}", done.iter().sum::<usize>());
        Ok(())
    };
    match what {
        "hash" => each(|bytes| Digest::of(bytes).hex().len()),
        "parse" => each(parse),
        "bare" => each(|bytes| Digest::of(bytes).hex().len() + parse(bytes)),
        "sessions" => stages(raw, work),
        other => Err(format!("no bare work is called {other}").into()),
    }
}

/// Rows of a log as polars reads them when it is told the columns.
fn parse(bytes: &[u8]) -> usize {
    let first = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
    let fields = 1 + first.iter().filter(|b| **b == b',').count();
    let columns = (0..fields).map(|k| Field::new(format!("{k}").into(), DataType::Float64));
    let options = CsvReadOptions::default()
        .with_has_header(false)
        .with_n_threads(Some(1))
        .with_schema(Some(std::sync::Arc::new(Schema::from_iter(columns))));
    let read = options
        .into_reader_with_file_handle(std::io::Cursor::new(bytes))
        .finish();
    read.map_or(0, |frame| frame.height())
}

/// The stages of every session into an empty cache.
fn stages(raw: &Path, work: &Path) -> Result<(), Box<dyn Error>> {
    let options = RunOptions {
        raw: vec![PathBuf::from(raw)],
        ..RunOptions::below(work)
    };
    let engine = Engine::open(&options, None, &Silent).map_err(|e| e.to_string())?;
    let found = discover(&options.raw);
    let walk = Walk {
        engine: &engine,
        discovery: &found,
        config: &options.config,
        pool: &rayon::ThreadPoolBuilder::new().build()?,
        jobs: options.jobs,
    };
    let done = walk.units(Scope::Session, &[], &Silent);
    let done = done.map_err(|e| e.to_string())?;
    println!("{}", done.len());
    Ok(())
}
