//! `pipeline export`: the work of a run as a workflow for another engine, or a model as source code of other languages.

use crate::DONE;
use crate::args::PlaceArgs;
use crate::export_model::{self, ModelArgs};
use crate::print::{self, line, print_json};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_export as export;
use pipeline_export::{ENGINES, Plan};
use pipeline_formats::discover::discover;
use pipeline_run::jobs;
use serde_json::json;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct ExportArgs {
    /// What is exported
    #[command(subcommand)]
    pub what: What,
}

/// What there is to export: an engine of [`ENGINES`] each, and the model.
#[derive(Debug, clap::Subcommand)]
pub enum What {
    /// Print a run as a Snakemake workflow whose jobs share a cache
    #[command(
        after_help = "Example:\n  pipeline export snakemake > Snakefile\n  snakemake --cores 8\n\nEvery job is `pipeline run --only STAGE:UNIT`, which fills the cache below derived/; an ordinary `pipeline run` at the end writes the reports. All machines have to see raw/ and derived/ under the same paths. --jobs is the number of threads of one job (0: one)."
    )]
    Snakemake(PlaceArgs),
    /// Write a model of the force as C, Python, MATLAB and Octave, MuJoCo and a table, with the points that test it
    #[command(
        after_help = "Examples:\n  pipeline export model --campaign simulated-10mm --out bpa-10mm\n  pipeline export model --campaign simulated-10mm --least-squares --out bpa-10mm-plain\n  pipeline export model --published new --diameter 20 --out bpa-20mm\n\nEvery language has bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa) in N, tension positive, its gradient and its domain. Outside the range of the fitted readings, the force is a bounded continuation."
    )]
    Model(Box<ModelArgs>),
}

/// Writes or prints what is asked for.
pub fn command(args: &ExportArgs) -> Result<u8> {
    match &args.what {
        What::Snakemake(places) => workflow("snakemake", places),
        What::Model(args) => export_model::command(args),
    }
}

fn workflow(engine: &str, places: &PlaceArgs) -> Result<u8> {
    let plan = plan(places)?;
    if places.json {
        print_json(&json!({ "tasks": plan.tasks }))?;
        return Ok(DONE);
    }
    let engine = ENGINES.iter().find(|e| e.name == engine);
    let engine = engine.ok_or_else(|| Error::internal("an engine that is not there"))?;
    line((engine.workflow)(&plan)?.trim_end());
    Ok(DONE)
}

fn plan(args: &PlaceArgs) -> Result<Plan> {
    let places = args.places()?;
    let discovery = discover(&places.raw);
    let unusable = discovery.unusable.iter().flat_map(|u| &u.diagnostics);
    let diagnostics: Vec<Diagnostic> = discovery
        .diagnostics
        .iter()
        .chain(unusable)
        .cloned()
        .collect();
    print::diagnostics(&diagnostics, &places.raw, args.verbose);
    if discovery.sessions.is_empty() {
        return Err(Error::Usage(
            "there are no usable sessions to plan for; --raw DIR says where they are, and `pipeline run` what is wrong with them".to_owned(),
        ));
    }
    let jobs = jobs::all(&discovery, &places.config);
    let places = export::Places {
        raw: places.raw,
        derived: places.derived,
        reports: places.reports,
        config: Config::place(args.results.cache.config.as_deref()).map(ToOwned::to_owned),
    };
    Plan::new(places, args.jobs as usize, &discovery, &jobs)
}
