//! The page of one campaign in full, from what the last run left: nothing is computed, and nothing but the file is written.

use crate::engine::Engine;
use crate::walk::Walk;
use crate::{Progress, RunOptions, check_outside, reports};
use pipeline_base::error::{Error, Result};
use pipeline_cache::store::write_atomically;
use pipeline_formats::discover::discover;
use std::path::Path;

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
    let engine = Engine::open(options, None, progress)?;
    let walk = Walk {
        engine: &engine,
        discovery: &discovery,
        config: &options.config,
        pool: &pool,
        jobs: options.jobs,
    };
    let made = walk.all(progress)?;
    let done = reports::Done {
        discovery: &discovery,
        made: &made,
    };
    let page = pool.install(|| reports::explorer(&engine, &done, campaign))?;
    write_atomically(out, page.as_bytes())
}
