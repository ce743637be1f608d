//! The directions between the crates: every `Cargo.toml` of the workspace against the list in `src/lib.rs`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use toml::{Table, Value};

const MAP: &str = include_str!("../../src/lib.rs");

type Names = BTreeSet<String>;

/// What a crate names: crates of the workspace that its code uses, those that only its tests use, other libraries.
#[derive(Debug, Default, PartialEq)]
struct Uses {
    code: Names,
    tests: Names,
    libraries: Names,
}

/// The lines of a block of text in the paragraph "Directions".
fn block(number: usize) -> impl Iterator<Item = &'static str> {
    let directions = MAP.split("**Directions**").nth(1).unwrap();
    let text = directions.split("```").nth(2 * number + 1).unwrap();
    let bare = |line: &'static str| line.trim_start_matches("//!").trim();
    text.lines().skip(1).map(bare).filter(|l| !l.is_empty())
}

fn list(text: &str) -> Names {
    let names = text.split(',').map(str::trim);
    names
        .filter(|n| *n != "nothing")
        .map(str::to_owned)
        .collect()
}

/// The crates in the order of the list, each with what it may use.
fn allowed() -> Vec<(String, Uses)> {
    let line = |line: &'static str| {
        let (name, uses) = line.split_once("->").unwrap();
        let (code, tests) = uses
            .split_once("; its tests ->")
            .unwrap_or((uses, "nothing"));
        let uses = Uses {
            code: list(code),
            tests: list(tests),
            libraries: Names::new(),
        };
        (name.trim().to_owned(), uses)
    };
    block(0).map(line).collect()
}

fn read(file: &Path) -> Table {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    text.parse().unwrap()
}

/// The names in a table of dependencies, also below `[target.…]`: crates of the workspace without their prefix, and libraries.
fn dependencies(manifest: &Table, kind: &str) -> (Names, Names) {
    let targets = manifest.get("target").and_then(Value::as_table);
    let targets = targets.into_iter().flat_map(|t| t.values());
    let tables = targets.filter_map(Value::as_table).chain([manifest]);
    let names = tables
        .filter_map(|t| t.get(kind)?.as_table())
        .flat_map(Table::keys);
    let (own, others): (Vec<&String>, Vec<&String>) = names.partition(|n| n.starts_with(PREFIX));
    let bare = |name: &String| name.trim_start_matches(PREFIX).to_owned();
    (
        own.into_iter().map(bare).collect(),
        others.into_iter().cloned().collect(),
    )
}

const PREFIX: &str = "pipeline-";

/// What every member of the workspace names in its `Cargo.toml`.
fn found() -> BTreeMap<String, Uses> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let workspace = read(&root.join("Cargo.toml"));
    let members = workspace["workspace"]["members"].as_array().unwrap();
    let member = |folder: &Value| {
        let manifest = read(&root.join(folder.as_str().unwrap()).join("Cargo.toml"));
        let name = manifest["package"]["name"].as_str().unwrap();
        let (mut code, mut libraries) = dependencies(&manifest, "dependencies");
        let (build, others) = dependencies(&manifest, "build-dependencies");
        code.extend(build);
        libraries.extend(others);
        let tests = dependencies(&manifest, "dev-dependencies").0;
        let uses = Uses {
            code,
            tests,
            libraries,
        };
        (name.trim_start_matches(PREFIX).to_owned(), uses)
    };
    members.iter().map(member).collect()
}

#[test]
fn every_crate_uses_the_crates_that_the_map_allows_and_no_others() {
    let (allowed, found) = (allowed(), found());
    let mapped: Names = allowed.iter().map(|(name, _)| name.clone()).collect();
    let there: Names = found.keys().cloned().collect();
    assert_eq!(
        there, mapped,
        "the crates (left) and the list in src/lib.rs (right)"
    );
    for (name, allowed) in &allowed {
        let found = &found[name];
        let both = [
            (&found.code, &allowed.code, "uses"),
            (&found.tests, &allowed.tests, "has tests that use"),
        ];
        for (found, allowed, uses) in both {
            let only = |a: &Names, b: &Names| a.difference(b).cloned().collect::<Vec<String>>();
            let (beyond, stale) = (only(found, allowed), only(allowed, found));
            assert!(
                beyond.is_empty(),
                "{name} {uses} {beyond:?}, which src/lib.rs does not allow"
            );
            assert!(
                stale.is_empty(),
                "src/lib.rs says that {name} {uses} {stale:?}, and it does not"
            );
        }
    }
}

/// Everything that a crate stands on.
fn below(name: &str, uses: &BTreeMap<String, Names>) -> Names {
    let mut found = Names::new();
    for used in &uses[name] {
        found.insert(used.clone());
        found.extend(below(used, uses));
    }
    found
}

#[test]
fn the_drawing_of_the_crates_is_of_this_list() {
    let allowed = allowed();
    let uses: BTreeMap<String, Names> = { allowed.iter() }
        .map(|(name, uses)| (name.clone(), uses.code.clone()))
        .collect();
    let mut lines = Vec::new();
    for (name, _) in &allowed {
        let others: Vec<(&String, Names)> =
            uses[name].iter().map(|u| (u, below(u, &uses))).collect();
        let is_reached = |used: &String| others.iter().any(|(_, below)| below.contains(used));
        let direct = uses[name].iter().filter(|used| !is_reached(used));
        lines.extend(direct.map(|used| format!("  {name} --> {used}")));
    }
    let drawing = format!("```mermaid\nflowchart TD\n{}\n```\n", lines.join("\n"));
    let page = include_str!("../../docs/architecture.md");
    assert!(page.contains(&drawing), "the drawing should be:\n{drawing}");
}

#[test]
fn every_line_of_the_map_names_crates_of_lines_below_it() {
    let allowed = allowed();
    for (at, (name, uses)) in allowed.iter().enumerate() {
        let below: Names = allowed[at + 1..].iter().map(|(n, _)| n.clone()).collect();
        let upward: Vec<_> = uses.code.difference(&below).collect();
        assert!(
            upward.is_empty(),
            "{name} names {upward:?}, which is not below it"
        );
    }
}

/// Crates that compute and nothing else: values in, values out.
const PURE: [&str; 19] = [
    "audit",
    "draft",
    "effects",
    "findings",
    "inference",
    "inspect",
    "mechanics",
    "numerics",
    "plan",
    "portable",
    "predict",
    "stages/clean",
    "stages/compare",
    "stages/diagnose",
    "stages/fit",
    "stages/ingest",
    "stages/normalize",
    "stages/torque",
    "report",
];
/// What they leave to others: files, the environment, clocks, the terminal.
const IMPURE: [&str; 7] = [
    "std::fs",
    "std::env",
    "std::time",
    "std::io",
    "std::process",
    "println!",
    "print!(",
];

/// The Rust files below a folder that are part of the program.
fn sources(folder: &Path, files: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() && name != "tests" {
            sources(&path, files);
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
            files.push(path);
        }
    }
}

#[test]
fn pure_crates_touch_no_file_clock_environment_or_terminal() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    PURE.iter().for_each(|c| sources(&root.join(c), &mut files));
    assert!(files.len() > 100, "{}", files.len());
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let program = text.split("#[cfg(test)]\nmod ").next().unwrap();
        let lines = program.lines().enumerate();
        let code = lines.filter(|(_, line)| !line.trim_start().starts_with("//"));
        for (k, line) in code {
            let found = IMPURE.iter().find(|what| line.contains(*what));
            assert!(
                found.is_none(),
                "{}:{}: {} in a crate that only computes: its inputs are arguments, its results return values",
                file.display(),
                k + 1,
                found.unwrap()
            );
        }
    }
}

/// The key of a stage's code follows `[dependencies]` alone (`src/run/fingerprint.rs`).
#[test]
fn no_manifest_has_dependencies_where_the_keys_do_not_look_for_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let members = read(&root.join("Cargo.toml"))["workspace"]["members"].clone();
    for folder in members.as_array().unwrap() {
        let file = root.join(folder.as_str().unwrap()).join("Cargo.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        for line in text.lines().filter(|line| line.starts_with('[')) {
            let known = [
                "[package]",
                "[lib]",
                "[dependencies]",
                "[build-dependencies]",
                "[dev-dependencies]",
            ];
            assert!(known.contains(&line), "{}: {line}", file.display());
        }
    }
}

#[test]
fn libraries_of_one_layer_are_used_by_no_other() {
    let found = found();
    for line in block(1) {
        let (libraries, users) = line.split_once(':').unwrap();
        for library in list(libraries) {
            let uses = |uses: &Uses| uses.libraries.contains(&library);
            let by: Names = found
                .iter()
                .filter(|(_, u)| uses(u))
                .map(|(n, _)| n.clone())
                .collect();
            assert!(
                !by.is_empty(),
                "src/lib.rs lists {library}, which no crate uses"
            );
            assert!(
                by.is_subset(&list(users)),
                "{library} is used by {by:?}, and may be by{users}"
            );
        }
    }
}
