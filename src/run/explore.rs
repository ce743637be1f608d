//! The page for a browser: the logs that it shows, and that of one campaign in full, from what the last run left: nothing is computed, and nothing
//! but the file is written.

use crate::engine::Engine;
use crate::reports::Done;
use crate::stages::ingest;
use crate::units::Scope;
use crate::walk::Walk;
use crate::{Progress, RunOptions, check_outside, reports};
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_cache::store::write_atomically;
use pipeline_config::FitOptions;
use pipeline_formats::discover::{Discovery, discover};
use pipeline_report::explorer::{self, sample::Extent, trace};
use pipeline_report::stage::ReportInput;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

/// Whether a file is a page that this program wrote.
pub fn is_page(file: &Path) -> bool {
    std::fs::read_to_string(file).is_ok_and(|text| text.contains(explorer::MARK))
}

/// Writes the page of a campaign.
///
/// # Errors
/// Results that are missing or out of date, a campaign that is not there, a file that cannot be written.
pub fn explore(
    options: &RunOptions,
    campaign: &str,
    out: &Path,
    progress: &dyn Progress,
) -> Result<()> {
    for raw in &options.raw {
        check_outside(raw, out, "--out")?;
    }
    let options = &RunOptions {
        dry_run: true,
        ..options.clone()
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.jobs)
        .build()
        .map_err(Error::internal)?;
    let discovery = pool.install(|| discover(&options.raw));
    if discovery.sessions.is_empty() {
        return Err(Error::Usage(no_campaign(options, campaign, &discovery)));
    }
    let engine = Engine::open(options, None, progress)?;
    let walk = Walk {
        engine: &engine,
        discovery: &discovery,
        config: &options.config,
        pool: &pool,
        jobs: options.jobs,
    };
    let made = walk.all(progress)?;
    let done = Done {
        discovery: &discovery,
        made: &made,
    };
    let page = pool.install(|| page(&engine, &done, &options.config.fit, campaign))?;
    write_atomically(out, page.as_bytes())
}

/// That there is no campaign at all.
fn no_campaign(options: &RunOptions, campaign: &str, discovery: &Discovery) -> String {
    match discovery.unusable.is_empty() {
        true => crate::no_sessions(options, discovery),
        false => format!(
            "no campaign is called \"{campaign}\": no session can be used; `pipeline run` says why"
        ),
    }
}

/// The page for a browser of one campaign in full.
///
/// # Errors
/// Results that are not up to date, a campaign that is not there, damaged entries.
fn page(engine: &Engine, done: &Done, options: &FitOptions, campaign: &str) -> Result<String> {
    let inputs = reports::results(done)?.map_err(|on| {
        Error::Usage(format!(
            "the results of the {on} are missing or out of date; `pipeline run` makes them"
        ))
    })?;
    let digest = Digest::of_named(inputs.iter());
    let mut input = reports::gather(engine, done, options, &digest)?;
    let sessions = input.sessions.iter().map(|s| &s.ingest.session);
    let known: BTreeSet<&str> = sessions.map(|s| s.campaign.as_str()).collect();
    if !known.contains(campaign) {
        let known = Vec::from_iter(known).join(", ");
        let pool = if campaign.starts_with("pooled-") {
            "; a pool has no page of its own: its readings are in those of its campaigns"
        } else {
            ""
        };
        return Err(Error::Usage(format!(
            "no campaign is called \"{campaign}\"; found {known}{pool}"
        )));
    }
    let extent = Extent::Campaign(campaign);
    input.logs = logs(engine, done, &input, extent)?;
    explorer::html(&input, extent)
}

/// The logs of the page for a browser, thinned one after the other: together they do not fit into memory.
///
/// # Errors
/// A damaged entry.
pub fn logs(
    engine: &Engine,
    done: &Done,
    input: &ReportInput,
    extent: Extent,
) -> Result<Vec<trace::Trace>> {
    let made = done.made.of(Scope::Session);
    let wanted = explorer::logs_wanted(input, extent);
    let plateaus = wanted.iter().map(|(_, log)| log.plateaus.len()).sum();
    let thinned = wanted.par_iter().map(|((session, output), log)| {
        let samples = made[*session].table(engine, ingest::NAME, output)?;
        Ok(trace::trace(log, &samples, plateaus))
    });
    let thinned: Vec<Option<trace::Trace>> = thinned.collect::<Result<_>>()?;
    Ok(thinned.into_iter().flatten().collect())
}
