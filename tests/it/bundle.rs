//! `pipeline bundle`: what is in it, that it repeats itself, and that it is a project with the same results.

use crate::support::{Bench, FAST, Said, outside_program};
use pipeline::base::digest::Digest;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::Command;

const METADATA: &str = "ro-crate-metadata.json";

/// The quick campaign after a run, with what is to be said of its bundle.
fn bench() -> Bench {
    let bench = Bench::quick_done();
    let config = bench.root().join(FAST);
    let text = std::fs::read_to_string(&config).unwrap();
    let about = "[bundle]\nname = \"Small\"\nlicense = \"CC-BY-4.0\"\nauthors = [\"Ada Lovelace <0000-0002-1825-0097>\"]\n";
    std::fs::write(&config, text + about).unwrap();
    bench
}

fn bundle(bench: &Bench, options: &[&str]) -> Said {
    bench.run(&[&["bundle", "--config", FAST], options].concat())
}

/// The files of a zip by name.
fn unpacked(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut zip = zip::ZipArchive::new(File::open(path).unwrap()).unwrap();
    let mut files = BTreeMap::new();
    for k in 0..zip.len() {
        let mut entry = zip.by_index(k).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        if entry.is_file() {
            files.insert(entry.name().unwrap().into_owned(), bytes);
        }
    }
    files
}

fn entities(files: &BTreeMap<String, Vec<u8>>) -> Vec<Value> {
    let metadata: Value = serde_json::from_slice(&files[METADATA]).unwrap();
    metadata["@graph"].as_array().unwrap().clone()
}

#[test]
fn a_bundle_names_every_file_with_its_digest_and_is_the_same_twice() {
    let bench = bench();
    let said = bundle(&bench, &[]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(!said.err.contains("license"), "{}", said.err);
    assert_eq!(bundle(&bench, &["--out", "again.zip"]).code, 0);
    let [first, again] = ["bundle.zip", "again.zip"].map(|name| bench.root().join(name));
    assert!(std::fs::read(&first).unwrap() == std::fs::read(&again).unwrap());

    let files = unpacked(&first);
    let entities = entities(&files);
    let named = |entity: &&Value| entity["@type"] == "File";
    let mut packed = 0;
    for file in entities.iter().filter(named) {
        let id = file["@id"].as_str().unwrap();
        if let Some(raw) = id.strip_prefix('#') {
            let on_disk = std::fs::read(bench.root().join(raw)).unwrap();
            assert_eq!(file["sha256"], Digest::of(&on_disk).hex(), "{id}");
            continue;
        }
        packed += 1;
        assert_eq!(file["sha256"], Digest::of(&files[id]).hex(), "{id}");
        assert_eq!(file["contentSize"], files[id].len().to_string(), "{id}");
    }
    assert_eq!(
        packed + 1,
        files.len(),
        "every file but the metadata itself"
    );
    for name in [
        "reports/force.pdf",
        "reports/tables/table1.csv",
        "derived/rows.parquet",
        "reports/provenance.json",
    ] {
        assert!(files.contains_key(name), "{name}");
    }
    assert!(
        !files
            .keys()
            .any(|name| name.starts_with("raw/") || name.contains("cache"))
    );
    let root = entities.iter().find(|e| e["@id"] == "./").unwrap();
    assert_eq!(root["datePublished"], "2026-01-01");
    assert_eq!(
        root["author"][0]["@id"],
        "https://orcid.org/0000-0002-1825-0097"
    );
    assert_eq!(
        root["license"]["@id"],
        "https://spdx.org/licenses/CC-BY-4.0.html"
    );
}

#[test]
fn unpacked_with_its_raw_files_a_bundle_is_a_project_with_the_same_results() {
    let bench = bench();
    assert_eq!(bundle(&bench, &["--with-raw"]).code, 0);
    let project = Bench::empty();
    for (name, bytes) in unpacked(&bench.root().join("bundle.zip")) {
        if name.starts_with("raw/") || name == "pipeline.toml" {
            let path = project.root().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
    }
    project.age();
    let said = project.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let (here, there) = (bench.results(), project.results());
    let differ = |name: &&String| here.get(*name) != there.get(*name);
    let differ: Vec<&String> = here.keys().filter(differ).collect();
    assert!(differ.is_empty() && here.len() == there.len(), "{differ:?}");
}

#[test]
fn what_sessions_share_is_one_raw_file_under_its_plain_path() {
    let bench = bench();
    let campaign = "small/campaign.toml";
    bench.write(campaign, "schema = \"bpa-campaign/1\"\n");
    bench.age();
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    let raw = bench.snapshot("raw");
    let said = bundle(&bench, &["--with-raw"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let count = format!("{} raw files", raw.len());
    assert!(said.out.contains(&count), "{count}: {}", said.out);
    let files = unpacked(&bench.root().join("bundle.zip"));
    for (name, bytes) in &raw {
        assert!(files.get(&format!("raw/{name}")) == Some(bytes), "{name}");
    }

    assert_eq!(bundle(&bench, &["--replace"]).code, 0);
    let entities = entities(&unpacked(&bench.root().join("bundle.zip")));
    let id = format!("#raw/{campaign}");
    let same = entities.iter().filter(|e| e["@id"] == *id);
    assert_eq!(same.count(), 1);

    let said = bench.run(&["explain", "force.pdf", "--verbose"]).out;
    assert!(
        said.contains(&format!("raw files: {}", raw.len())),
        "{said}"
    );
    let lines = said.lines().filter(|l| l.contains("campaign.toml"));
    let names: Vec<&str> = lines.filter_map(|l| l.split_whitespace().next()).collect();
    assert_eq!(names, [campaign]);
}

#[test]
fn what_is_out_of_date_or_in_the_way_is_not_packed() {
    let bench = bench();
    assert_eq!(bundle(&bench, &[]).code, 0);
    let said = bundle(&bench, &[]);
    assert_eq!(said.code, 2);
    said.warns_of(&["bundle.zip already exists", "--replace"]);
    assert_eq!(bundle(&bench, &["--replace"]).code, 0);
    let said = bundle(&bench, &["--out", "raw/bundle.zip"]);
    assert_eq!(said.code, 2);
    said.warns_of(&["inside the raw directory"]);

    let table = bench.root().join("reports/tables/table1.csv");
    std::fs::write(table, "mine").unwrap();
    let said = bundle(&bench, &["--replace"]);
    assert_eq!(said.code, 2);
    said.warns_of(&["out of date", "`pipeline run` first"]);
    assert_eq!(bench.run(&["run", "--config", FAST]).code, 0);

    let session = bench.raw().join("small/b/c50/session.toml");
    let text = std::fs::read_to_string(&session).unwrap();
    std::fs::write(&session, text + "# seen\n").unwrap();
    let text = std::fs::read_to_string(&session).unwrap();
    std::fs::write(
        &session,
        text.replace("campaign", "notes = \"x\"\ncampaign"),
    )
    .unwrap();
    assert_eq!(bundle(&bench, &["--replace"]).code, 2);
}

#[test]
fn a_license_or_an_author_that_is_none_is_a_mistake_of_the_configuration() {
    let bench = bench();
    let config = bench.root().join(FAST);
    std::fs::write(
        config,
        "[bundle]\nlicense = \"CC BY\"\nauthors = [\"A <1>\"]\n",
    )
    .unwrap();
    let said = bundle(&bench, &[]);
    assert_eq!(said.code, 2);
    said.warns_of(&[
        "fast.toml:2 [bundle.license]",
        "fast.toml:3 [bundle.authors]",
        "ORCID",
    ]);
}

/// With programs that are no part of a Rust machine: run by `.ci/run`, which installs them.
mod outside {
    use super::*;

    #[test]
    #[ignore = "needs Python with roc-validator and rocrate"]
    fn a_bundle_passes_the_validator_of_the_standard() {
        let probe = ["-c", "import rocrate, rocrate_validator"];
        let python = outside_program("PYTHON", "python3", &probe);
        let bench = bench();
        for options in [&[][..], &["--with-raw", "--replace"]] {
            assert_eq!(bundle(&bench, options).code, 0);
            let script = concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/tests/scripts/rocrate_validate.py"
            );
            let output = Command::new(&python)
                .args([script, "bundle.zip"])
                .current_dir(bench.root())
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&output.stdout);
            let why = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{options:?}: {said}{why}");
        }
    }
}
