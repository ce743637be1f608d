//! How long the main job takes, and how much memory: cold, warm, one log changed, one option changed.
//!
//! ```text
//! cargo run --release --example timings -- ../shared/rig
//! ```
//! Every line is the median of five runs in this process, on a copy of the sessions in a temporary directory. Peak memory is that of the
//! whole process so far (Linux only).

use pipeline::run::{Outcome, RunOptions, STAGES, Silent, run};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let source = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("raw"), PathBuf::from);
    let bench = tempfile::tempdir()?;
    let raw = bench.path().join("raw");
    let bytes = copy(&source, &raw)?;
    println!(
        "{}: {:.1} MB, {} threads",
        source.display(),
        bytes as f64 / 1e6,
        std::thread::available_parallelism()?
    );
    let options = RunOptions {
        raw: vec![raw.clone()],
        ..RunOptions::below(bench.path())
    };
    let cold = measure(|| {
        let _ = std::fs::remove_dir_all(&options.derived);
        let _ = std::fs::remove_dir_all(&options.reports);
        timed(&options)
    })?;
    print("cold", &cold);
    println!("peak memory {}", peak_memory());
    print("warm", &measure(|| timed(&options))?);
    let log = first_log(&raw).ok_or("no log")?;
    let mut change = 0_u8;
    let changed = measure(|| {
        let mut contents = std::fs::read(&log)?;
        change += 1;
        let at = contents.len() - 3;
        contents[at] = b'0' + change;
        std::fs::write(&log, contents)?;
        timed(&options)
    })?;
    print("one log changed", &changed);
    let mut titled = options.clone();
    let option = measure(|| {
        titled.config.report.title.push('.');
        timed(&titled)
    })?;
    print("report title changed", &option);
    Ok(())
}

type Run = (Duration, Outcome);

fn timed(options: &RunOptions) -> Result<Run, Box<dyn std::error::Error>> {
    let started = Instant::now();
    let outcome = run(options, &Silent).map_err(|e| e.to_string())?;
    Ok((started.elapsed(), outcome))
}

fn measure(
    mut once: impl FnMut() -> Result<Run, Box<dyn std::error::Error>>,
) -> Result<Run, Box<dyn std::error::Error>> {
    let mut runs: Vec<Run> = (0..RUNS).map(|_| once()).collect::<Result<_, _>>()?;
    runs.sort_by_key(|r| r.0);
    Ok(runs.swap_remove(RUNS / 2))
}

fn print(name: &str, (took, outcome): &Run) {
    let stages: Vec<String> = STAGES
        .iter()
        .map(|stage| (stage, outcome.work.iter().filter(|w| w.stage == *stage)))
        .map(|(stage, work)| (stage, work.map(|w| w.took).sum::<Duration>()))
        .filter(|(_, took)| !took.is_zero())
        .map(|(stage, took)| format!("{stage} {:.2}", took.as_secs_f64()))
        .collect();
    println!(
        "{name:24} {:7.3} s   thread seconds: {}",
        took.as_secs_f64(),
        stages.join(", ")
    );
}

fn copy(from: &Path, to: &Path) -> std::io::Result<u64> {
    std::fs::create_dir_all(to)?;
    let mut bytes = 0;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            bytes += copy(&entry.path(), &target)?;
        } else {
            let contents = std::fs::read(entry.path())?;
            bytes += contents.len() as u64;
            std::fs::write(&target, contents)?;
            let old = std::time::SystemTime::now() - Duration::from_secs(3600);
            std::fs::File::options()
                .write(true)
                .open(&target)?
                .set_modified(old)?;
        }
    }
    Ok(bytes)
}

fn first_log(raw: &Path) -> Option<PathBuf> {
    let mut logs: Vec<PathBuf> = walkdir::WalkDir::new(raw)
        .into_iter()
        .flatten()
        .map(walkdir::DirEntry::into_path)
        .filter(|p| p.file_name().is_some_and(|n| n == "test8.csv"))
        .collect();
    logs.sort();
    logs.into_iter().next()
}

fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.map_or_else(
        || "unknown on this system".to_owned(),
        |l| l.trim().to_owned(),
    )
}
