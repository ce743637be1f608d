//! Takes a fingerprint of the source files behind every stage, so that a change of code redoes what it concerns and nothing else.
//!
//! A stage's fingerprint is the SHA-256 over the names and contents of the files listed for it below, line ends aside (a checkout on
//! Windows must not differ from one on Linux). `src/cache/key.rs` says what else enters a key.

use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The sources of each stage, below `src/`.
const STAGES: &[(&str, &[&str])] = &[
    ("INGEST", &["base", "formats", "stages/ingest"]),
    ("CLEAN", &["base", "numerics", "stages/clean"]),
    ("NORMALIZE", &["base", "stages/normalize"]),
    ("FIT", &["base", "mechanics", "numerics", "stages/fit"]),
    (
        "COMPARE",
        &[
            "base",
            "mechanics",
            "numerics",
            "stages/fit",
            "stages/compare",
        ],
    ),
    (
        "DIAGNOSE",
        &[
            "base",
            "mechanics",
            "findings",
            "inference",
            "numerics",
            "stages/fit",
            "stages/diagnose",
        ],
    ),
    (
        "TORQUE",
        &[
            "base",
            "mechanics",
            "findings",
            "inference",
            "numerics",
            "stages/diagnose",
            "stages/fit",
            "stages/torque",
        ],
    ),
    (
        "REPORT",
        &[
            "audit",
            "base",
            "mechanics",
            "numerics",
            "report",
            "findings",
            "stages/report.rs",
            "stages/torque",
        ],
    ),
    // Everything, for a run in which nothing at all has changed.
    ("PROGRAM", &[""]),
];

fn main() {
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=build.rs");
    let mut code = String::new();
    for (stage, sources) in STAGES {
        let mut hasher = Sha256::new();
        for source in *sources {
            let mut files = Vec::new();
            collect(&Path::new("src").join(source), &mut files);
            files.sort();
            for file in files {
                let contents = std::fs::read(&file).unwrap_or_default();
                let name = file.to_string_lossy().replace('\\', "/");
                hasher.update(name.as_bytes());
                hasher.update(b"\0");
                hasher.update(without_carriage_returns(&contents));
                hasher.update(b"\0");
            }
        }
        let mut hex = String::new();
        for byte in hasher.finalize() {
            write!(hex, "{byte:02x}").expect("writing to a string");
        }
        writeln!(code, "/// Fingerprint of the sources of this stage.")
            .expect("writing to a string");
        writeln!(code, "pub const {stage}: &str = \"sha256:{hex}\";").expect("writing to a string");
    }
    let out = std::env::var_os("OUT_DIR")
        .map(PathBuf::from)
        .expect("cargo sets OUT_DIR");
    std::fs::write(out.join("fingerprints.rs"), code).expect("the build directory is writable");
}

fn without_carriage_returns(contents: &[u8]) -> Vec<u8> {
    contents.iter().copied().filter(|b| *b != b'\r').collect()
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(path) else {
        files.push(path.to_path_buf());
        return;
    };
    for entry in entries.flatten() {
        collect(&entry.path(), files);
    }
}
