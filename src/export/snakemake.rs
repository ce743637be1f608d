//! A workflow for Snakemake 8 and 9: a rule a stage, a job a unit, and a stamp for every job that is done.
//!
//! The stamps lie in the cache, because they say what is in it: whoever deletes the cache deletes them too.

use super::{Plan, Task};
use pipeline_base::error::{Error, Result};
use pipeline_run::jobs;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A unit as the Snakefile holds it.
#[derive(Serialize)]
struct Unit<'a> {
    only: &'a str,
    input: Vec<String>,
}

/// What Snakemake takes for the beginning and end of a wildcard.
const BRACES: [char; 2] = ['{', '}'];

/// The text of a Snakefile.
///
/// # Errors
/// A path that Snakemake cannot have.
pub fn workflow(plan: &Plan) -> Result<String> {
    let mut files = plan.tasks.iter().flat_map(|task| &task.files);
    if let Some(file) = files.find(|file| file.contains(BRACES)) {
        return Err(Error::Usage(format!(
            "Snakemake takes the braces in {file} for wildcards; give the folder or the file another name"
        )));
    }
    let stamps = place(&plan.places.derived.join("cache").join("snakemake"))?;
    let summary = place(&plan.places.reports.join("summary.json"))?;
    let stamp = |task: &Task| format!("{stamps}/{}/{}", task.stage, task.name);
    let mut units: BTreeMap<&str, BTreeMap<&str, Unit>> = BTreeMap::new();
    for task in &plan.tasks {
        let before = task.after.iter().map(|k| stamp(&plan.tasks[*k]));
        let unit = Unit {
            only: &task.only,
            input: task.files.iter().cloned().chain(before).collect(),
        };
        units
            .entry(task.stage)
            .or_default()
            .insert(&task.name, unit);
    }
    let stages = jobs::of_stages().into_iter();
    let rules = stages.filter(|stage| units.contains_key(stage));
    let threads = plan.threads.max(1);
    let rules: Vec<String> = rules.map(|stage| rule(stage, threads)).collect();
    Ok(include_str!("snakemake.smk")
        .replace("@PLACES", &python(&plan.arguments()?)?)
        .replace("@STAMPS", &python(&stamps)?)
        .replace("@SUMMARY", &python(&summary)?)
        .replace("@THREADS", &threads.to_string())
        .replace("@RULES", rules.join("\n").trim_end())
        .replace("@UNITS", &python(&units)?))
}

fn rule(stage: &str, threads: usize) -> String {
    format!(
        r#"
rule {stage}:
    input: lambda job: UNITS["{stage}"][job.unit]["input"]
    output: touch(STAMPS + "/{stage}/{{unit}}")
    params: only=lambda job: UNITS["{stage}"][job.unit]["only"]
    threads: {threads}
    shell: "{{PROGRAM}} run {{PLACES}} --jobs {{threads}} --only {{params.only:q}}"
"#
    )
}

/// A path of an output, in which braces would be wildcards.
fn place(path: &Path) -> Result<String> {
    let text = super::text(path)?;
    if text.contains(BRACES) {
        return Err(Error::Usage(format!(
            "Snakemake takes the braces in {text} for wildcards; choose another place with --derived or --reports"
        )));
    }
    Ok(text)
}

/// Texts, lists and objects are written in Python as in JSON.
fn python(value: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(value).map_err(Error::internal)
}
