//! The binary: calls the command line and turns what it says into an exit code.

use std::process::ExitCode;

// The search makes many small matrices, the pages many small strings.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    ExitCode::from(pipeline::cli::main(std::env::args_os()))
}
