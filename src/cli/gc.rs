//! `pipeline gc`: throws away old cache entries.

use crate::args::DerivedArgs;
use crate::print::{line, print_json};
use crate::{DONE, progress};
use pipeline_base::error::{Error, Result};
use pipeline_cache::collect::{self, Limits, Plan};
use pipeline_run::cache::{Access, Cache};
use serde_json::json;
use std::time::{Duration, SystemTime};

const DAY_S: u64 = 24 * 3600;

/// Arguments of `gc`.
#[derive(Debug, clap::Args)]
pub struct GcArgs {
    /// Where the cache is
    #[command(flatten)]
    pub cache: DerivedArgs,
    /// Delete unused entries that are older than this many days
    #[arg(long, value_name = "DAYS", default_value_t = 30)]
    pub older_than: u64,
    /// If the cache is still larger than this, delete the oldest unused entries too (such as 500MB or 2GB)
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub max_size: Option<u64>,
    /// Show what would be deleted, without deleting it
    #[arg(long)]
    pub dry_run: bool,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

/// Plans, and removes unless it is a dry run.
pub fn command(args: &GcArgs) -> Result<u8> {
    let derived = args.cache.places()?.derived;
    let progress = progress::Shown::new(args.json);
    let mut cache = Cache::open(&derived, Access::Look, &progress)?;
    if cache.last().is_empty() {
        return Err(Error::Usage(format!(
            "nothing has been run in {} yet, or its state.jsonl is lost; `pipeline run` first, to establish what is needed",
            derived.display()
        )));
    }
    if !args.dry_run {
        cache = Cache::open(&derived, Access::Alone, &progress)?;
    }
    let limits = Limits {
        older_than: Duration::from_secs(args.older_than.saturating_mul(DAY_S)),
        most_bytes: args.max_size,
    };
    let live = cache.last().values().map(|l| l.key.clone()).collect();
    let plan = collect::plan(cache.store(), &live, limits, SystemTime::now())?;
    if !args.dry_run {
        collect::carry_out(&plan)?;
    }
    print(&plan, args)?;
    Ok(DONE)
}

fn print(plan: &Plan, args: &GcArgs) -> Result<()> {
    if args.json {
        return print_json(&json!({
            "removed": !args.dry_run, "entries": plan.entries.len(), "objects": plan.objects.len(), "leftovers": plan.leftovers.len(),
            "bytes_freed": plan.freed(), "bytes_before": plan.bytes, "entries_kept": plan.kept.0, "entries_in_use": plan.kept.1,
        }));
    }
    line(format!(
        "{}: {} entries, {} objects and {} leftovers of killed runs, {} of {}; {} entries stay, {} of them in use",
        if args.dry_run {
            "would be deleted"
        } else {
            "deleted"
        },
        plan.entries.len(),
        plan.objects.len(),
        plan.leftovers.len(),
        in_words(plan.freed()),
        in_words(plan.bytes),
        plan.kept.0,
        plan.kept.1
    ));
    Ok(())
}

const UNITS: [(&str, u64); 4] = [
    ("GB", 1_000_000_000),
    ("MB", 1_000_000),
    ("kB", 1_000),
    ("B", 1),
];

fn in_words(bytes: u64) -> String {
    let (unit, factor) = UNITS.iter().find(|(_, f)| bytes >= *f).unwrap_or(&UNITS[3]);
    if *factor == 1 {
        format!("{bytes} B")
    } else {
        format!("{:.1} {unit}", bytes as f64 / *factor as f64)
    }
}

/// A size in bytes: a number with GB, MB, kB or B.
fn size(text: &str) -> std::result::Result<u64, String> {
    let text = text.trim();
    let (number, factor) = UNITS
        .iter()
        .find_map(|(unit, factor)| {
            let ends = text.len() >= unit.len() && text.is_char_boundary(text.len() - unit.len());
            let (number, end) = ends.then(|| text.split_at(text.len() - unit.len()))?;
            end.eq_ignore_ascii_case(unit).then_some((number, *factor))
        })
        .ok_or("a size has a unit: 500MB, 2GB")?;
    let number: f64 = number
        .trim()
        .parse()
        .map_err(|_| format!("{number:?} is not a number; write a size as 500MB or 2GB"))?;
    if number.is_finite() && number >= 0.0 {
        Ok((number * factor as f64) as u64)
    } else {
        Err("a size is not negative".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_said() {
        assert_eq!(size("1.5 GB"), Ok(1_500_000_000));
        assert_eq!(size("20mb"), Ok(20_000_000));
        assert!(size("20").is_err() && size("-1GB").is_err() && size("xMB").is_err());
        assert_eq!(in_words(1_234_567), "1.2 MB");
        assert_eq!(in_words(12), "12 B");
    }
}
