//! `pipeline bundle`: the last run as an RO-Crate.

use crate::args::PlaceArgs;
use crate::print::{counted, line, print_json};
use crate::{DONE, options, progress};
use pipeline_base::error::{Error, Result};
use pipeline_bundle::{self as bundle, Bundle};
use pipeline_formats::discover::discover;
use pipeline_run as run;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `bundle`.
#[derive(Debug, clap::Args)]
pub struct BundleArgs {
    /// The zip file to write
    #[arg(long, short, value_name = "FILE", default_value = "bundle.zip")]
    pub out: PathBuf,
    /// Include the raw files; otherwise they are listed with their digests
    #[arg(long)]
    pub with_raw: bool,
    /// Replace an existing file
    #[arg(long)]
    pub replace: bool,
    /// Where things are
    #[command(flatten)]
    pub places: PlaceArgs,
}

/// Packs the last run.
///
/// # Errors
/// It is out of date or was changed by hand; the zip is there already, or lies in a raw directory.
pub fn command(args: &BundleArgs) -> Result<u8> {
    let places = args.places.places()?;
    let out = &args.out;
    places.check_outside_raw(Some(out), "--out")?;
    if out.exists() && !args.replace {
        return Err(Error::Usage(format!(
            "{} already exists; --replace overwrites it, --out FILE names another",
            out.display()
        )));
    }
    let look = options(&places, args.places.jobs, None, true)?;
    let outcome = run::run(&look, &progress::Shown::new(true))?;
    let waiting = outcome.work.len() + outcome.written.len();
    if waiting > 0 {
        return Err(Error::Usage(format!(
            "the last run is out of date: {} would be computed or restored (`pipeline status` says which); `pipeline run` first",
            counted(waiting, "result", "results")
        )));
    }
    let discovery = discover(&places.raw);
    let from = bundle::Places {
        raw: places.raw,
        derived: places.derived,
        reports: places.reports,
    };
    let version = env!("CARGO_PKG_VERSION");
    let bundle = Bundle::of_last_run(&from, &discovery, &places.config, version, args.with_raw)?;
    let written = bundle.write(out)?;
    if places.config.bundle.license.is_empty() {
        eprintln!(
            "note: the bundle states no license, and repositories ask for one; set `license` under [bundle] in pipeline.toml"
        );
    }
    if args.places.json {
        print_json(&json!({
            "bundle": out, "files": written.files, "raw_files": written.raw_files, "with_raw": args.with_raw,
            "bytes": written.bytes, "sha256": written.digest.hex(),
        }))?;
        return Ok(DONE);
    }
    let raw = counted(written.raw_files, "raw file", "raw files");
    let how = match args.with_raw {
        true => format!("{raw} among them"),
        false => format!("{raw} by digest (--with-raw packs them)"),
    };
    line(format!(
        "{}: {}, {how}; {:.1} MB, sha256 {}",
        out.display(),
        counted(written.files, "file", "files"),
        written.bytes as f64 / 1e6,
        written.digest.hex()
    ));
    Ok(DONE)
}
