//! What documents say, held to what is there; the Python of README.md is run.

use crate::support::{Bench, FAST, outside_program};
use std::path::Path;
use std::process::Command;

const EXAMPLE: &str = "tests/scripts/python_example.py";

fn read(file: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap()
}

#[test]
fn the_citation_has_the_version_of_the_program() {
    let line = concat!("\nversion: ", env!("CARGO_PKG_VERSION"), "\n");
    assert!(read("CITATION.cff").contains(line));
}

#[test]
fn the_readme_asks_for_the_rust_that_cargo_asks_for() {
    let asked = concat!(
        "a Rust toolchain (",
        env!("CARGO_PKG_RUST_VERSION"),
        " or later)"
    );
    assert!(read("README.md").contains(asked));
}

#[test]
fn the_example_in_the_readme_is_the_script_that_is_run() {
    let (readme, script) = (read("README.md"), read(EXAMPLE));
    assert!(
        readme.contains(&format!("```python\n{script}```")),
        "README.md has another text than {EXAMPLE}"
    );
}

#[test]
fn pandas_polars_and_duckdb_read_the_tidy_data() {
    let probe = ["-c", "import duckdb, pandas, polars, pyarrow"];
    let Some(python) = outside_program("PYTHON", "python3", &probe) else {
        return;
    };
    let bench = Bench::quick();
    assert_eq!(bench.run(&["run", "--config", FAST]).code, 0);
    let output = Command::new(python)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(EXAMPLE))
        .current_dir(bench.root())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
}
