//! `pipeline init`: the files of a project of a laboratory's own.

use crate::DONE;
use crate::print::line;
use pipeline_base::error::{Error, Result};
use pipeline_golden as golden;
use std::path::{Path, PathBuf};

/// Arguments of `init`.
#[derive(Debug, clap::Args)]
pub struct InitArgs {
    /// The project folder; created if it does not exist
    #[arg(default_value = ".")]
    pub folder: PathBuf,
}

/// Folder of the raw sessions of a new project.
const RAW: &str = "raw";
/// Folder of its golden tables.
const GOLDEN: &str = "golden";

const CONFIG: &str = "pipeline.toml";
const CONFIG_TEXT: &str = r#"# A project of `pipeline`. `pipeline config` prints every option with its default and meaning; what is not set here keeps its default.

# Where things are, relative to this file.
[paths]
raw = ["raw"] # sessions: folders with a session.toml and its logs; only read
derived = "derived" # cache and tidy data
reports = "reports"
golden = "golden" # tables that `pipeline check` compares with

[report]
title = "Isometric force of braided pneumatic actuators"
author = ""
"#;

const IGNORED: &str = ".gitignore";
const IGNORED_TEXT: &str =
    "# What `pipeline run` makes from raw/ and pipeline.toml.\n/derived/\n/reports/\n";

/// Writes the files of a project; none where one of them is there already.
///
/// # Errors
/// A file that is there, or a folder that cannot be written.
pub fn command(args: &InitArgs) -> Result<u8> {
    let folder = &args.folder;
    let place = |name: &str| folder.join(name);
    if place(CONFIG).exists() {
        return Err(Error::Usage(format!(
            "{} already exists: this is a project, and nothing was written",
            place(CONFIG).display()
        )));
    }
    std::fs::create_dir_all(place(RAW)).map_err(Error::io("create the folder", &place(RAW)))?;
    golden::start(&place(GOLDEN))?;
    if !place(IGNORED).exists() {
        write(&place(IGNORED), IGNORED_TEXT)?;
    }
    write(&place(CONFIG), CONFIG_TEXT)?;
    let shown = match folder.as_path() {
        here if here == Path::new(".") => "this folder".to_owned(),
        other => other.display().to_string(),
    };
    for text in [
        &format!(
            "{shown} is now a project: {CONFIG}, {GOLDEN}/golden.toml, {IGNORED}, and {RAW}/ for the sessions"
        ),
        "next: pipeline new-session LOG --out raw/NAME   writes a draft session.toml for a log",
        "      pipeline run                              computes the reports",
        "      pipeline check --init                     keeps the tables, to compare later ones with",
    ] {
        line(text);
    }
    Ok(DONE)
}

fn write(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).map_err(Error::io("write", path))
}
