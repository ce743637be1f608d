//! A change of code in a copy of the sources, and which stages become stale by it.

use crate::fingerprint::Graph;
use crate::stages::{LIST, NAMES};
use std::path::Path;

/// The workspace that this crate stands in.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap()
}

/// Stages of which the fingerprint differs after an edit of a copy of the sources.
fn stale(edit: impl FnOnce(&Path)) -> Vec<&'static str> {
    let copy = tempfile::tempdir().unwrap();
    copy_below(&root().join("src"), &copy.path().join("src"));
    for file in ["Cargo.toml", "Cargo.lock"] {
        std::fs::copy(root().join(file), copy.path().join(file)).unwrap();
    }
    let fingerprints = || -> Vec<String> {
        let graph = Graph::read(copy.path()).unwrap();
        let all = NAMES.iter().map(|stage| graph.fingerprint(stage));
        all.collect::<Result<_, _>>().unwrap()
    };
    let before = fingerprints();
    edit(copy.path());
    let after = fingerprints();
    let pairs = before.iter().zip(&after).zip(NAMES);
    pairs
        .filter(|((a, b), _)| a != b)
        .map(|(_, name)| *name)
        .collect()
}

/// The same after a line was added to a file.
fn stale_after(changed: &str) -> Vec<&'static str> {
    stale(|copy| {
        let file = copy.join(changed);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text + "// changed\n").unwrap();
    })
}

/// The same after a text of a file was replaced.
fn stale_with(file: &str, from: &str, to: &str) -> Vec<&'static str> {
    stale(|copy| {
        let file = copy.join(file);
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{from}");
        std::fs::write(&file, text.replace(from, to)).unwrap();
    })
}

fn copy_below(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let place = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_below(&path, &place);
        } else {
            std::fs::copy(&path, &place).unwrap();
        }
    }
}

#[test]
fn every_stage_has_the_code_of_its_own_crate() {
    let graph = Graph::read(root()).unwrap();
    let code = graph.fingerprints().unwrap();
    for declared in LIST {
        let name = declared.stage.name;
        assert_eq!(declared.stage.code, code[name], "{name}");
    }
}

#[test]
fn every_crate_of_a_stage_is_in_the_list() {
    for folder in std::fs::read_dir(root().join("src/stages")).unwrap() {
        let name = folder.unwrap().file_name().into_string().unwrap();
        assert!(NAMES.contains(&name.as_str()), "{name}");
    }
}

#[test]
fn a_change_of_code_makes_those_stages_stale_that_call_it() {
    let of_law = ["fit", "compare", "diagnose", "torque", "report"];
    for (changed, stale) in [
        ("src/base/units.rs", NAMES),
        ("src/run/walk.rs", NAMES),
        ("src/stages/ingest/lib.rs", &["ingest", "clean", "report"]),
        ("src/stages/normalize/lib.rs", &["normalize"]),
        ("src/stages/fit/equations.rs", &of_law),
        ("src/stages/compare/lib.rs", &["compare", "report"]),
        (
            "src/stages/diagnose/limits.rs",
            &["diagnose", "torque", "report"],
        ),
        ("src/stages/torque/curve.rs", &["torque", "report"]),
        (
            "src/inference/search/mod.rs",
            &["diagnose", "torque", "report"],
        ),
        ("src/effects/creep.rs", &["diagnose", "torque", "report"]),
        ("src/report/fonts.rs", &["report"]),
        ("src/simulate/log.rs", &[]),
        ("src/cli/gc.rs", &[]),
    ] {
        assert_eq!(stale_after(changed), stale, "{changed}");
    }
}

#[test]
fn other_features_of_a_library_enter_the_keys_of_what_uses_it() {
    let stale = stale_with(
        "Cargo.toml",
        "resvg = { version = \"0.47.0\", default-features = false, features = [\"text\"] }",
        "resvg = \"0.47.0\"",
    );
    assert_eq!(stale, ["report"]);
}

#[test]
fn another_version_of_a_library_enters_the_keys_of_what_uses_it() {
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let version_of = |name: &str| {
        let start = format!("name = \"{name}\"\nversion = ");
        let rest = &lock[lock.find(&start).unwrap() + start.len()..];
        format!("{start}{}", rest.lines().next().unwrap())
    };
    for (library, expected) in [
        ("typst-layout", &["report"][..]),
        ("calamine", &["ingest", "clean", "report"]),
    ] {
        let from = version_of(library);
        let to = format!("name = \"{library}\"\nversion = \"99.0.0\"");
        assert_eq!(stale_with("Cargo.lock", &from, &to), expected, "{library}");
    }
}
