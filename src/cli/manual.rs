//! `pipeline completions` and `pipeline man`: what shells and `man` show, made from the arguments themselves.

use crate::DONE;
use crate::args::Args;
use crate::print::line;
use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;
use pipeline_base::error::{Error, Result};
use std::path::PathBuf;

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
pub struct CompletionsArgs {
    /// Which shell
    pub shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// Write pipeline.1 and a page for every command into this directory
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Prints the script.
pub fn completions(args: &CompletionsArgs) -> Result<u8> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "pipeline", &mut script);
    print(&script);
    Ok(DONE)
}

/// Prints or writes the pages.
pub fn command(args: &ManArgs) -> Result<u8> {
    let Some(folder) = &args.out else {
        let mut page = Vec::new();
        let written = Man::new(Args::command()).render(&mut page);
        written.map_err(Error::internal)?;
        print(&page);
        return Ok(DONE);
    };
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    clap_mangen::generate_to(Args::command(), folder).map_err(Error::io("write in", folder))?;
    Ok(DONE)
}

fn print(text: &[u8]) {
    line(String::from_utf8_lossy(text).trim_end());
}
