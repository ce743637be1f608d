//! `pipeline explore`: every reading of one campaign in one file for a browser.

use crate::args::PlaceArgs;
use crate::print::{line, print_json};
use crate::{DONE, options, progress};
use pipeline_base::error::{Error, Result};
use pipeline_run::explore::{self, explore};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `explore`.
#[derive(Debug, clap::Args)]
pub struct ExploreArgs {
    /// The campaign, as `session.toml` names it
    pub campaign: String,
    /// File to write the page to
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Overwrite a file that is not such a page
    #[arg(long)]
    pub force: bool,
    /// Where things are
    #[command(flatten)]
    pub places: PlaceArgs,
}

/// Writes the page and says where it is.
pub fn command(args: &ExploreArgs) -> Result<u8> {
    let json = args.places.json;
    let in_the_way = !args.force && args.out.exists() && !explore::is_page(&args.out);
    if in_the_way {
        return Err(Error::Usage(format!(
            "{} exists and is not a page of `pipeline explore`; give another --out, or --force to overwrite it",
            args.out.display()
        )));
    }
    let options = options(&args.places.places()?, args.places.jobs, None, true)?;
    let progress = progress::Shown::new(json);
    explore(&options, &args.campaign, &args.out, &progress)?;
    progress.finish();
    if json {
        print_json(&json!({ "campaign": args.campaign, "page": args.out }))?;
    } else {
        line(format!("page: {}", args.out.display()));
    }
    Ok(DONE)
}
