//! What a process takes: time, processor time, memory.

use std::error::Error;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use wait4::Wait4;

/// What one process took.
#[derive(Clone, Debug)]
pub struct Taken {
    /// From start to end.
    pub wall: Duration,
    /// Of all its threads, system included.
    pub processor: Duration,
    /// Largest resident set, bytes.
    pub peak: u64,
    /// What it printed.
    pub said: String,
}

/// Runs a process to its end; it must succeed, or end with one of `fine`.
///
/// # Errors
/// It cannot be started, or fails.
pub fn of(command: &mut Command, fine: &[i32]) -> Result<Taken, Box<dyn Error>> {
    // What it prints goes through a file: a pipe that nobody empties would stop it.
    let mut said = tempfile::NamedTempFile::new()?;
    let started = Instant::now();
    let mut child = command
        .stdout(said.reopen()?)
        .stderr(Stdio::inherit())
        .spawn()?;
    let used = child.wait4()?;
    let wall = started.elapsed();
    if !used.status.success() && !used.status.code().is_some_and(|c| fine.contains(&c)) {
        return Err(format!("{command:?} ended with {}", used.status).into());
    }
    let mut text = String::new();
    std::io::Read::read_to_string(&mut said, &mut text)?;
    Ok(Taken {
        wall,
        processor: used.rusage.utime + used.rusage.stime,
        peak: used.rusage.maxrss,
        said: text,
    })
}

/// The median by wall-clock time of several runs.
///
/// # Errors
/// One of them fails.
pub fn median(
    runs: usize,
    mut once: impl FnMut() -> Result<Taken, Box<dyn Error>>,
) -> Result<Taken, Box<dyn Error>> {
    let mut all: Vec<Taken> = (0..runs).map(|_| once()).collect::<Result<_, _>>()?;
    all.sort_by_key(|t| t.wall);
    Ok(all.swap_remove(runs / 2))
}
