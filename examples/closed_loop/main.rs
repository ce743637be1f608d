//! The benchmark of the loop: campaigns with an effect that nothing tells, searched, and judged on what was found.
//!
//! ```sh
//! cargo run --release --example closed_loop -- [--published] [--short] [--seeds N] [--only WORD] [--list] [--log FILE] [--digest]
//! ```
//!
//! Prints Markdown: what `docs/closed-loop.md` has below its introduction. 20 seeds are the whole table, some hours on two cores; with
//! `--log` every campaign is written down as soon as it is done, and those that the file has are not run again, as long as the loop
//! answers alike. Without `--published` the campaigns are those of the family that one may design with; `--list` prints every campaign.

mod bench;

use bench::outcome::Outcome;
use bench::plan::Plan;
use bench::progress::{Log, run};
use bench::trial::Trial;
use bench::{digest, table};
use pipeline::simulate::rig_like::Family;
use std::path::Path;

const USAGE: &str = "Simulates campaigns, asks the loop what is in them, and prints the table of docs/closed-loop.md.

Usage: closed_loop [--published] [--short] [--seeds N] [--only WORDS] [--list] [--log FILE] [--digest]

  --published    seeds and generator of the table, not those of the design
  --short        a few seeds of every case: minutes instead of hours
  --seeds N      seeds a case (20)
  --only WORDS   cases whose names hold these words
  --list         every campaign on a line of its own, as it is done
  --log FILE     keep every answer there, and go on from it where it was interrupted
  --digest       only the digest of the answers to twelve fixed campaigns
";

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let given = |name: &str| arguments.iter().any(|a| a == name);
    let value = |name: &str| {
        let place = arguments.iter().position(|a| a == name)?;
        arguments.get(place + 1)
    };
    if given("--help") {
        print!("{USAGE}");
        return Ok(());
    }
    let answers = digest::answers();
    if given("--digest") {
        println!("{}", digest::line(&answers));
        return Ok(());
    }
    let plan = Plan {
        family: if given("--published") {
            Family::Published
        } else {
            Family::Design
        },
        seeds: value("--seeds").and_then(|s| s.parse().ok()).unwrap_or(20),
    };
    let all = if given("--short") {
        plan.short()
    } else {
        plan.trials()
    };
    let only = value("--only").map_or("", |w| w.as_str());
    let trials: Vec<Trial> = all
        .into_iter()
        .filter(|t| t.name().contains(only))
        .collect();
    let log = match value("--log") {
        Some(file) => Log::open(Path::new(file), &answers)?,
        None => Log::none(),
    };
    let list = given("--list");
    let outcomes = run(&trials, &log, |trial, outcome| {
        if list {
            eprintln!("{}", line(trial, outcome));
        }
    });
    println!("{}", digest::line(&answers));
    println!("{}", table::document(&trials, &outcomes));
    Ok(())
}

/// One campaign in a line.
fn line(trial: &Trial, outcome: &Outcome) -> String {
    format!(
        "{} {}: {} (size {:.3?}, log density {:+.3?}, {:.1} s)",
        if outcome.exact { "+" } else { "-" },
        trial.name(),
        outcome.text(),
        outcome.size.amplitudes,
        outcome.log_density_gap,
        outcome.seconds
    )
}
