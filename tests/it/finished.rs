//! Finished runs, made once for all tests: what is asked of the time after a run begins with a copy of one.

use crate::support::{Bench, FAST, files};
use std::path::PathBuf;
use std::sync::LazyLock;

/// Every file below a bench with its contents, held in memory: the folder of the run itself is gone again.
type Tree = Vec<(PathBuf, Vec<u8>)>;

static DEFAULTS: LazyLock<Tree> = LazyLock::new(|| finished(&Bench::small(), &[]));
static QUICK: LazyLock<Tree> = LazyLock::new(|| finished(&Bench::quick(), &["--config", FAST]));

impl Bench {
    /// [`Bench::small`] after a run.
    pub fn small_done() -> Self {
        laid(&DEFAULTS, &[])
    }

    /// [`Bench::quick`] after a run.
    pub fn quick_done() -> Self {
        laid(&QUICK, &["--config", FAST])
    }
}

fn finished(bench: &Bench, options: &[&str]) -> Tree {
    let said = bench.run(&[&["run"], options].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    let read = |file: PathBuf| {
        let path = file.strip_prefix(bench.root()).unwrap().to_path_buf();
        (path, std::fs::read(&file).unwrap())
    };
    files(bench.root()).into_iter().map(read).collect()
}

fn laid(tree: &Tree, options: &[&str]) -> Bench {
    let bench = Bench::empty();
    for (path, bytes) in tree {
        let file = bench.root().join(path);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, bytes).unwrap();
    }
    bench.age();
    // Files that are linked to the cache are none in the copy: this run links them again, and has nothing to compute.
    let outcome = bench.outcome(&[&["run"], options].concat());
    assert_eq!(outcome["computed"], serde_json::json!([]), "{outcome}");
    bench
}
