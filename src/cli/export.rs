//! `pipeline export`: the work of a run as a workflow for another engine.

use crate::DONE;
use crate::args::PlaceArgs;
use crate::print::{self, line, print_json};
use clap::builder::PossibleValuesParser;
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
    /// The engine
    #[arg(value_parser = PossibleValuesParser::new(ENGINES.iter().map(|e| e.name)))]
    pub engine: String,
    /// Where things are
    #[command(flatten)]
    pub places: PlaceArgs,
}

/// Prints the workflow.
pub fn command(args: &ExportArgs) -> Result<u8> {
    let plan = plan(&args.places)?;
    if args.places.json {
        print_json(&json!({ "tasks": plan.tasks }))?;
        return Ok(DONE);
    }
    let engine = ENGINES.iter().find(|e| e.name == args.engine);
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
    print::diagnostics(&diagnostics, args.verbose);
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
