//! Takes a fingerprint of the code behind every stage, so that a change of code redoes what it concerns and nothing else.

mod fingerprint;

use fingerprint::Graph;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn main() -> std::io::Result<()> {
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let own = own.expect("cargo sets CARGO_MANIFEST_DIR");
    let root = own.ancestors().nth(2).unwrap_or(Path::new("."));
    for watched in ["src", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={}", root.join(watched).display());
    }
    let graph = Graph::read(root)?;
    let mut code = String::new();
    for (name, fingerprint) in graph.fingerprints()? {
        let constant = name.to_uppercase();
        writeln!(
            code,
            "/// Fingerprint of the code of `{name}`.\npub const {constant}: &str = \"{fingerprint}\";"
        )
        .expect("writing to a string");
    }
    let out = std::env::var_os("OUT_DIR").map(PathBuf::from);
    std::fs::write(
        out.expect("cargo sets OUT_DIR").join("fingerprints.rs"),
        code,
    )
}
