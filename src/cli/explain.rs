//! `pipeline explain`: where a table, figure, report or single number comes from.

use crate::DONE;
use crate::args::ResultArgs;
use crate::cell::{Number, number, place};
use crate::places::Places;
use crate::print::{line, print_json};
use pipeline_base::digest;
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_report::tables::meanings;
use pipeline_run::STAGES;
use pipeline_run::ancestry::{Ancestry, Unit, stem};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Names listed of a stage or of the raw files before the rest is counted.
const SHOWN: usize = 6;

/// Arguments of `explain`.
#[derive(Debug, clap::Args)]
pub struct ExplainArgs {
    /// A file below reports/ or derived/, a session, or a stage with its unit; `FILE:LINE:COLUMN` for one number of a table
    pub artifact: String,
    /// Where results are
    #[command(flatten)]
    pub results: ResultArgs,
    /// List every session and every raw file
    #[arg(long, short)]
    pub verbose: bool,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
}

/// Looks up the artifact and prints its ancestry.
pub fn command(args: &ExplainArgs) -> Result<u8> {
    let places = args.results.places()?;
    let ancestry = Ancestry::load(&places.derived)?;
    let (artifact, place) = place(&args.artifact)?;
    let (unit, output) = ancestry.find(artifact)?;
    let number = match (place, &output) {
        (Some(place), Some(output)) => Some(number(&places, output, place)?),
        (Some(_), None) => {
            return Err(Error::Usage(format!(
                "{artifact} is not a table; only tables have lines and columns"
            )));
        }
        (None, _) => None,
    };
    let through: BTreeSet<usize> = match &number {
        Some(number) => narrowed(&ancestry, unit, &number.row),
        None => ancestry.upstream([unit]),
    };
    let explained = Explained {
        args,
        places: &places,
        ancestry: &ancestry,
        unit: &ancestry.units[unit],
        output,
        number,
        through,
    };
    if args.json {
        explained.json()?;
    } else {
        explained.print()?;
    }
    Ok(DONE)
}

/// Where an output of the cache lies.
pub(super) fn on_disk(places: &Places, output: &str) -> PathBuf {
    match (
        output.strip_prefix("reports/"),
        output.strip_prefix("derived/"),
    ) {
        (Some(rest), _) => places.reports.join(rest),
        (_, Some(rest)) => places.derived.join(rest),
        _ => PathBuf::from(output),
    }
}

/// What a row of a table can depend on: the unit that wrote it, and upstream only what belongs to the session or the campaign that the row
/// names. A row that names none depends on everything.
fn narrowed(ancestry: &Ancestry, unit: usize, row: &BTreeMap<String, String>) -> BTreeSet<usize> {
    let of = |column: &str| row.get(column).filter(|v| !v.is_empty());
    let units = &ancestry.units;
    let belongs = |k: &usize| {
        let name = &units[*k].name;
        match (of("session"), of("campaign")) {
            (Some(session), _) => name == session,
            (None, Some(campaign)) => {
                let rest = name.strip_prefix(campaign.as_str());
                let same_diameter =
                    |rest: &str| of("diameter_mm").is_none_or(|d| rest.trim() == format!("{d} mm"));
                rest.is_some_and(|rest| {
                    rest.is_empty() || (rest.starts_with(' ') && same_diameter(rest))
                })
            }
            (None, None) => true,
        }
    };
    let meant: Vec<usize> = units[unit].from.iter().copied().filter(belongs).collect();
    let mut through = ancestry.upstream(meant);
    through.insert(unit);
    through
}

/// All that is said of an artifact.
struct Explained<'a> {
    args: &'a ExplainArgs,
    places: &'a Places,
    ancestry: &'a Ancestry,
    unit: &'a Unit,
    output: Option<String>,
    number: Option<Number>,
    through: BTreeSet<usize>,
}

impl Explained<'_> {
    fn print(&self) -> Result<()> {
        if let Some(output) = &self.output {
            let object = &self.unit.entry.outputs[output];
            line(format!(
                "{} ({}, sha256 {})",
                on_disk(self.places, output).display(),
                self.state(output),
                object.digest.short()
            ));
        }
        if let Some(n) = &self.number {
            line(format!("  line {}, {} = {}", n.line, n.column, n.value));
            for meaning in self.meanings() {
                line(format!("  {meaning}"));
            }
        }
        let set = options_set(self.units())?;
        for stage in (0..STAGES.len()).rev() {
            let units: Vec<&Unit> = self.units().filter(|u| u.stage == stage).collect();
            if units.is_empty() {
                continue;
            }
            line(format!(
                "{}: {}",
                STAGES[stage],
                self.listed(units.iter().map(|u| u.name.as_str()))
            ));
            if let Some(how) = how(STAGES[stage]) {
                line(format!("  {how}"));
            }
            if let Some(unit) = units.first() {
                line(format!(
                    "  code {}, version {}",
                    short(&unit.entry.parts.code),
                    unit.entry.parts.version
                ));
            }
            for option in set.get(STAGES[stage]).into_iter().flatten() {
                line(format!("  {option}"));
            }
        }
        let raw = self.raw();
        line(format!("raw files: {}", raw.len()));
        let shown = if self.args.verbose { raw.len() } else { SHOWN };
        for (name, digest) in raw.iter().take(shown) {
            line(format!("  {name}  sha256 {digest}"));
        }
        if raw.len() > shown {
            line(format!(
                "  and {} more; --verbose lists all",
                raw.len() - shown
            ));
        }
        Ok(())
    }

    fn json(&self) -> Result<()> {
        let units: Vec<_> = self
            .units()
            .map(|u| {
                let from: Vec<String> = u.from.iter().map(|k| &self.ancestry.units[*k]).map(label).collect();
                json!({
                    "stage": u.stage_name(), "unit": u.name, "key": u.key, "code": u.entry.parts.code, "version": u.entry.parts.version,
                    "options": u.entry.parts.options, "from": from, "given": u.given,
                })
            })
            .collect();
        let number = self
            .number
            .as_ref()
            .map(|n| json!({ "line": n.line, "column": n.column, "value": n.value, "row": n.row, "meaning": self.meanings() }));
        let file = self.output.as_ref().map(|o| {
            json!({ "path": on_disk(self.places, o), "state": self.state(o), "sha256": self.unit.entry.outputs[o].digest.hex() })
        });
        let raw: BTreeMap<String, String> = self.raw();
        print_json(
            &json!({ "artifact": file, "number": number, "made_by": label(self.unit), "units": units, "raw_files": raw }),
        )
    }

    /// What the number is: its column, and the words of its row that stand for a formula.
    fn meanings(&self) -> Vec<String> {
        let (Some(number), Some(output)) = (&self.number, &self.output) else {
            return Vec::new();
        };
        let of_column = meanings::of_column(stem(output), &number.column);
        let of_column = of_column.map(|m| format!("{}: {m}", number.column));
        let words = number.row.iter().filter_map(|(column, word)| {
            let meaning = meanings::of_word(column, word)?;
            Some(format!("{column} {word}: {meaning}"))
        });
        of_column.into_iter().chain(words).collect()
    }

    fn units(&self) -> impl Iterator<Item = &Unit> {
        self.through.iter().map(|k| &self.ancestry.units[*k])
    }

    /// Whether the file is as the run made it.
    fn state(&self, output: &str) -> &'static str {
        match digest::of_file(&on_disk(self.places, output)) {
            Ok(digest) if digest == self.unit.entry.outputs[output].digest => "unchanged",
            Ok(_) => "changed since the run; `pipeline run` restores it",
            Err(_) => "missing; `pipeline run` restores it",
        }
    }

    /// Raw files by folder and name, with their digests.
    fn raw(&self) -> BTreeMap<String, String> {
        self.ancestry.raw_files(self.units(), &self.places.reports)
    }

    fn listed<'a>(&self, names: impl Iterator<Item = &'a str>) -> String {
        let names: Vec<&str> = names.collect();
        let shown = if self.args.verbose {
            names.len()
        } else {
            SHOWN
        };
        let mut text = names[..names.len().min(shown)].join(", ");
        if names.len() > shown {
            text.push_str(&format!(" and {} more", names.len() - shown));
        }
        text
    }
}

/// How a stage makes its numbers.
fn how(stage: &str) -> Option<&'static str> {
    Some(match stage {
        "ingest" => {
            "every row of the logs, times gain plus offset, in one unit per quantity (docs/sessions.md)"
        }
        "clean" => {
            "rows that are not measurements left out, the zero of the force subtracted, the mean of each steady plateau (docs/data.md)"
        }
        "normalize" => {
            "ε = (l_rest − l)/l_rest, ε* = ε/ε_620 and P* = P/620 kPa of every reading (docs/data.md)"
        }
        "fit" => {
            "the equations of the new model by robust least squares, intervals from refits without each specimen (docs/data.md)"
        }
        "compare" => {
            "measured minus predicted for every model: RMSE, largest error, bias, adjusted R² by split (docs/data.md)"
        }
        "diagnose" => {
            "one mixed model of the residual of the law: scatter by restricted likelihood, effects tested by bootstrap, errors on specimens left \
             out (docs/loop.md)"
        }
        "torque" => {
            "force of each model times the moment arm of the route, and the same mixed model on the torques (docs/loop.md)"
        }
        "report" => {
            "the results of the stages below as tables, figures and pages; nothing is computed here"
        }
        _ => return None,
    })
}

fn label(unit: &Unit) -> String {
    format!("{} {}", unit.stage_name(), unit.name)
}

/// The first digits of a fingerprint.
fn short(fingerprint: &str) -> &str {
    let hex = fingerprint.strip_prefix("sha256:").unwrap_or(fingerprint);
    &hex[..hex.len().min(12)]
}

/// The options of each stage that differ from the defaults, in words.
fn options_set<'a>(
    units: impl Iterator<Item = &'a Unit>,
) -> Result<BTreeMap<&'static str, BTreeSet<String>>> {
    let defaults = Config::default().flattened()?;
    let mut set: BTreeMap<&'static str, BTreeSet<String>> = BTreeMap::new();
    for unit in units {
        for (name, value) in &unit.entry.parts.options {
            if defaults.get(name).is_some_and(|usual| usual != value) {
                let words = format!("{name} = {value} (default {})", defaults[name]);
                set.entry(unit.stage_name()).or_default().insert(words);
            }
        }
    }
    Ok(set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_says_how_it_makes_its_numbers() {
        for stage in STAGES {
            assert!(how(stage).is_some(), "{stage}");
        }
    }
}
