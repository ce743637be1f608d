//! Fuzzes the readers of `session.toml` and of logs: seeded mutations of real inputs, each case bounded in time and memory.
//!
//! ```text
//! cargo run --release --example fuzz -- [TARGET|all] [CASES] [SEED] [FIRST CASE]
//! ```
//! A case that panics is reported, and its input kept below the temporary folder; one that takes more than [`LONGEST`] or holds more
//! than [`MOST_BYTES`] ends the program, with its number, from which it can be run again.

mod mutate;
mod targets;

use std::alloc::{GlobalAlloc, Layout, System};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};
use targets::{Target, targets};

/// A case may take so long; the machine may be busy with other work.
const LONGEST: Duration = Duration::from_secs(20);

/// A case may hold so much at once: inputs are of a few kilobytes.
const MOST_BYTES: usize = 256 << 20;

/// Counts what is held, and refuses what no case may hold.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed to the system's allocator unchanged, or refused with a null pointer, as the trait allows.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD.fetch_add(layout.size(), Relaxed) + layout.size();
        PEAK.fetch_max(held, Relaxed);
        if held > MOST_BYTES {
            HELD.fetch_sub(layout.size(), Relaxed);
            eprintln!("case {} holds {held} bytes", CASE.load(Relaxed));
            return std::ptr::null_mut();
        }
        // SAFETY: the layout is the caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: pointer and layout are those of an earlier call of `alloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The case that is running, and when it began in milliseconds of [`START`].
static CASE: AtomicU64 = AtomicU64::new(0);
static BEGAN: AtomicU64 = AtomicU64::new(0);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default| {
        arguments
            .get(k)
            .map_or(default, |a| a.parse().expect("a number"))
    };
    let wanted = arguments.first().map_or("all", String::as_str);
    let (cases, seed, first) = (number(1, 10_000), number(2, 1), number(3, 0));
    let start = Instant::now();
    std::thread::spawn(move || watch(start));
    std::panic::set_hook(Box::new(|_| {}));
    for target in targets()
        .iter()
        .filter(|t| wanted == "all" || t.name == wanted)
    {
        println!("{}", fuzz(target, cases, seed, first, start));
    }
}

/// Ends the program when a case takes too long: nothing else ends an endless loop.
fn watch(start: Instant) {
    loop {
        std::thread::sleep(Duration::from_millis(500));
        let now = start.elapsed().as_millis() as u64;
        let began = BEGAN.load(Relaxed);
        if began > 0 && now.saturating_sub(began) > LONGEST.as_millis() as u64 {
            eprintln!("case {} takes more than {LONGEST:?}", CASE.load(Relaxed));
            std::process::exit(1);
        }
    }
}

/// Runs the cases of a target; one line of what happened.
fn fuzz(target: &Target, cases: u64, seed: u64, first: u64, start: Instant) -> String {
    let (mut panics, mut sound, mut slowest, mut largest) = (0, 0, Duration::ZERO, 0);
    let begin = Instant::now();
    for case in first..first + cases {
        let input = target.input(seed, case);
        let held = HELD.load(Relaxed);
        PEAK.store(held, Relaxed);
        CASE.store(case, Relaxed);
        BEGAN.store(start.elapsed().as_millis() as u64 + 1, Relaxed);
        let one = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| target.read(&input))) {
            Ok(outcome) => sound += u64::from(outcome.is_read),
            Err(panic) => {
                panics += 1;
                keep(target, case, &input, panic.as_ref());
            }
        }
        BEGAN.store(0, Relaxed);
        slowest = slowest.max(one.elapsed());
        largest = largest.max(PEAK.load(Relaxed).saturating_sub(held));
    }
    format!(
        "{}: {cases} cases in {:.0} s, {sound} read, the others refused, {panics} panics, slowest {:.0} ms, largest {:.1} MB",
        target.name,
        begin.elapsed().as_secs_f64(),
        1e3 * slowest.as_secs_f64(),
        largest as f64 / 1e6
    )
}

fn keep(target: &Target, case: u64, input: &[u8], panic: &(dyn std::any::Any + Send)) {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("?");
    let path = std::env::temp_dir().join(format!("fuzz-{}-{case}", target.name));
    let kept = std::fs::write(&path, input).is_ok();
    eprintln!(
        "{} case {case}: {text} (kept: {kept}, {})",
        target.name,
        path.display()
    );
}
