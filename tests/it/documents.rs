//! What documents say, held to what is there; the Python of docs/python.md is run.

use crate::support::{Bench, outside_program};
use pipeline::report::typeset::svg_to_pdf;
use pipeline::run::STAGES;
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
fn the_page_of_options_is_what_the_program_prints() {
    let printed = Bench::empty().run(&["config"]).out;
    let page = read("docs/options.md");
    let block = format!("```toml\n{}\n```\n", printed.trim_end());
    assert!(
        page.contains(&block),
        "docs/options.md should have:\n{block}"
    );
}

#[test]
fn the_stages_of_the_readme_and_the_help_are_those_of_the_registry() {
    let stages = STAGES.join(", ");
    let readme = read("README.md");
    let row = readme.lines().find(|l| l.starts_with("| `pipeline run` |"));
    assert!(row.unwrap().contains(&format!(": {stages};")), "{row:?}");
    let help = Bench::empty().run(&["--help"]).out;
    let help: Vec<&str> = help.split_whitespace().collect();
    let help = help.join(" ");
    assert!(
        help.contains(&format!("Stages, in order: {stages}.")),
        "{help}"
    );
}

#[test]
fn the_example_in_the_documentation_is_the_script_that_is_run() {
    let (page, script) = (read("docs/python.md"), read(EXAMPLE));
    assert!(
        page.contains(&format!("```python\n{script}```")),
        "docs/python.md has another text than {EXAMPLE}"
    );
}

#[test]
fn documents_do_not_pile_up_on_the_stack_of_a_thread() {
    use rayon::prelude::*;
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 40 30\"><path d=\"M0 0L40 30\" stroke=\"black\"/></svg>";
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pages = pool.unwrap().install(|| {
        let figures = (0..300).into_par_iter();
        let page = |k: i32| svg_to_pdf(svg, &k.to_string(), (40.0, 30.0));
        figures.map(|k| page(k).is_ok()).filter(|ok| *ok).count()
    });
    assert_eq!(pages, 300);
}

/// With programs that are no part of a Rust machine: run by `.ci/run`, which installs them.
mod outside {
    use super::*;

    #[test]
    #[ignore = "needs Python with duckdb, pandas, polars and pyarrow"]
    fn pandas_polars_and_duckdb_read_the_tidy_data() {
        let probe = ["-c", "import duckdb, pandas, polars, pyarrow"];
        let python = outside_program("PYTHON", "python3", &probe);
        let bench = Bench::quick_done();
        let output = Command::new(python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(EXAMPLE))
            .current_dir(bench.root())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
    }

    #[test]
    #[ignore = "needs Python with venv, and pandas and pyarrow from PyPI"]
    fn the_python_bridge_says_what_the_program_says() {
        let python = outside_program("PYTHON", "python3", &["-c", "import venv, tomllib"]);
        let output = Command::new(python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/python_bridge.py"))
            .arg(env!("CARGO_BIN_EXE_pipeline"))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
    }
}
