//! The binary: calls the command line and turns what it says into an exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(pipeline::cli::main(std::env::args_os()))
}
