//! `pipeline check-session --watch`: each log as it comes.

use crate::check_session::{CheckSessionArgs, draw, exit_code, in_a_line};
use crate::print::line;
use notify::{Config as Polling, PollWatcher, RecursiveMode, Watcher, recommended_watcher};
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_formats::discover::{Located, SESSION_FILE, discover};
use pipeline_inspect::State;
use pipeline_inspect::population::Known;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// A log is done when it has not grown for so long.
const SETTLED: Duration = Duration::from_millis(1500);
/// Whether one has stopped growing is looked at so often.
const LOOKED: Duration = Duration::from_millis(500);
/// Where the file system tells of nothing, it is asked so often.
const POLLED: Duration = Duration::from_secs(1);
/// Endings of files that are no logs.
const NOT_LOGS: [&str; 6] = ["toml", "svg", "pdf", "png", "md", "json"];

/// Checks every log that comes to the folder, and those that are there, until it is interrupted or has seen as many as were asked for.
pub(super) fn command(args: &CheckSessionArgs, config: &Config, known: &Known) -> Result<u8> {
    let folder = &args.folder;
    if !folder.join(SESSION_FILE).is_file() {
        return Err(Error::Usage(format!(
            "there is no {SESSION_FILE} in {}: --watch takes the description of the logs from it",
            folder.display()
        )));
    }
    let (sender, events) = channel();
    let _watcher = watcher(folder, sender)?;
    line(format!("watching {} (Ctrl-C ends)", folder.display()));
    let mut growth = Growth::new();
    let mut done = BTreeSet::new();
    let mut worst = State::Fine;
    loop {
        for file in settled(folder, &mut growth)? {
            if !done.insert(file.clone()) {
                continue;
            }
            worst = worst.max(check(args, config, known, &file.0)?);
            if args.logs.is_some_and(|n| done.len() >= n) {
                return Ok(exit_code(worst));
            }
        }
        match events.recv_timeout(LOOKED) {
            Ok(()) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Error::internal("the file watcher has ended"));
            }
        }
        // One event a write: what matters is when they end.
        while events.try_recv().is_ok() {}
    }
}

/// Tells of changes in a folder: by the file system, or where that cannot, by asking.
fn watcher(folder: &Path, sender: Sender<()>) -> Result<Box<dyn Watcher>> {
    let failed = |e: notify::Error| Error::Usage(format!("cannot watch {}: {e}", folder.display()));
    let own = sender.clone();
    let tell = move |_: notify::Result<notify::Event>| {
        // Nobody listens any more: the command is about to end.
        let _ = own.send(());
    };
    let by_system = recommended_watcher(tell).and_then(|mut watcher| {
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
        Ok(watcher)
    });
    if let Ok(watcher) = by_system {
        return Ok(Box::new(watcher));
    }
    let tell = move |_: notify::Result<notify::Event>| {
        let _ = sender.send(());
    };
    let polling = Polling::default().with_poll_interval(POLLED);
    let mut watcher = PollWatcher::new(tell, polling).map_err(failed)?;
    watcher
        .watch(folder, RecursiveMode::NonRecursive)
        .map_err(failed)?;
    Ok(Box::new(watcher))
}

/// A log's size, and since when it has had it.
type Growth = BTreeMap<String, (u64, Instant)>;

/// The logs that have not grown for a while, by name with their size.
fn settled(folder: &Path, growth: &mut Growth) -> Result<Vec<(String, u64)>> {
    let read = std::fs::read_dir(folder).map_err(Error::io("read", folder))?;
    let mut settled = Vec::new();
    for entry in read.filter_map(std::result::Result::ok) {
        let path = entry.path();
        let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default();
        let name = entry.file_name().to_string_lossy().into_owned();
        if !path.is_file() || name.starts_with('.') || NOT_LOGS.contains(&ending) {
            continue;
        }
        let Ok(size) = entry.metadata().map(|about| about.len()) else {
            continue;
        };
        let known = growth.entry(name.clone()).or_insert((size, Instant::now()));
        if known.0 != size {
            *known = (size, Instant::now());
        } else if size > 0 && known.1.elapsed() >= SETTLED {
            settled.push((name, size));
        }
    }
    settled.sort();
    Ok(settled)
}

/// Checks one log, and says how it came out.
fn check(args: &CheckSessionArgs, config: &Config, known: &Known, file: &str) -> Result<State> {
    let found = discover(std::slice::from_ref(&args.folder));
    let Some(located): Option<&Located> = found.sessions.first() else {
        let why = found.unusable.iter().flat_map(|u| &u.diagnostics);
        line(format!("BAD   {file}: {SESSION_FILE} cannot be used"));
        why.for_each(|d| line(format!("      {d}")));
        return Ok(State::Bad);
    };
    let seen = pipeline_inspect::log(located, file, config, known);
    line(in_a_line(file, &seen));
    draw(args, file, &seen)?;
    Ok(seen.state())
}
