//! A project of a laboratory's own, from `init` to `check`, and what `status` and `summary` say in it.

use crate::support::{Bench, Said, files};
use std::path::Path;

/// A project beside the small campaign: its paths are other than the usual ones.
fn project() -> Bench {
    let bench = Bench::small();
    let said = bench.run(&["init", "lab"]);
    assert_eq!(said.code, 0, "{}", said.err);
    std::fs::rename(
        bench.raw().join("small"),
        bench.root().join("lab/raw/small"),
    )
    .unwrap();
    bench
}

/// Runs the program from outside of the project.
fn run(bench: &Bench, arguments: &[&str]) -> Said {
    bench.run(&[arguments, &["--config", "lab/pipeline.toml"]].concat())
}

#[test]
fn a_project_needs_no_paths_and_nothing_copied_from_elsewhere() {
    let bench = project();
    let lab = bench.root().join("lab");
    for file in ["pipeline.toml", "golden/golden.toml", ".gitignore"] {
        assert!(lab.join(file).exists(), "{file}");
    }
    assert_eq!(run(&bench, &["status"]).code, 1);
    let said = run(&bench, &["check", "--init"]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(
        said.out.contains("coefficients") && !said.out.contains("knee"),
        "{}",
        said.out
    );
    assert!(lab.join("reports/force.pdf").exists() && lab.join("golden/coefficients.csv").exists());
    assert!(!bench.root().join("reports").exists() && !bench.root().join("derived").exists());
    for command in [
        &["run"][..],
        &["status"],
        &["check"],
        &["summary"],
        &["graph"],
        &["gc", "--dry-run"],
        &["explain", "coefficients.csv:2:value"],
        &["export", "snakemake"],
    ] {
        let said = run(&bench, command);
        assert_eq!(said.code, 0, "{command:?}: {}{}", said.out, said.err);
    }
    let again = run(&bench, &["check", "--init"]);
    assert_eq!(again.code, 2, "{}", again.out);
    assert!(bench.run(&["init", "lab"]).err.contains("already exists"));
}

#[test]
fn what_differs_is_said_with_coefficients_and_errors_first() {
    let bench = project();
    assert_eq!(run(&bench, &["check", "--init"]).code, 0);
    let config = bench.root().join("lab/pipeline.toml");
    let text = std::fs::read_to_string(&config).unwrap();
    std::fs::write(&config, text + "\n[clean]\nsettle_s = 0.3\n").unwrap();
    let said = run(&bench, &["check", "--json"]);
    assert_eq!(said.code, 1, "{}", said.err);
    let value: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let tables = value["findings"]["tables"].as_array().unwrap();
    let tables: Vec<&str> = tables
        .iter()
        .map(|t| t["table"].as_str().unwrap())
        .collect();
    let place = |table: &str| tables.iter().position(|t| *t == table);
    assert_eq!(place("coefficients"), Some(0), "{tables:?}");
    assert!(place("model_comparison") < place("sessions"), "{tables:?}");
    assert_eq!(
        place("audit"),
        None,
        "the papers' claims are none of a laboratory's"
    );
    assert_eq!(value["findings"]["differences"][0]["table"], "coefficients");
}

fn touch(path: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{from}");
    std::fs::write(path, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn status_names_what_has_to_be_put_back_beside_what_is_to_be_computed() {
    let bench = Bench::small_done();
    let session = bench.raw().join("small/b/c50/session.toml");
    touch(&session, "campaign", "date = \"2026-02\"\ncampaign");
    let said = bench.run(&["status"]);
    assert!(
        said.out.contains("0 files would be restored"),
        "{}",
        said.out
    );
    for lost in ["reports/force.pdf", "reports/tables/zeros.csv"] {
        std::fs::remove_file(bench.root().join(lost)).unwrap();
    }
    std::fs::remove_file(
        bench
            .root()
            .join("derived/sessions/small-a-c00/rows.parquet"),
    )
    .unwrap();
    let said = bench.run(&["status"]);
    assert_eq!(said.code, 1);
    for lost in [
        "reports/force.pdf",
        "reports/tables/zeros.csv",
        "sessions/small-a-c00",
    ] {
        assert!(said.out.contains(lost), "{lost}: {}", said.out);
    }
    assert!(
        said.out.contains("3 files would be restored"),
        "{}",
        said.out
    );
}

#[test]
fn a_copy_of_a_project_is_up_to_date() {
    let bench = Bench::small_done();
    let copy = Bench::empty();
    for file in files(bench.root()) {
        let place = copy.root().join(file.strip_prefix(bench.root()).unwrap());
        std::fs::create_dir_all(place.parent().unwrap()).unwrap();
        std::fs::copy(&file, place).unwrap();
    }
    let said = copy.run(&["status"]);
    assert_eq!(said.code, 0, "{}", said.out);
    let rows = copy
        .root()
        .join("derived/sessions/small-a-c00/rows.parquet");
    std::fs::write(rows, "mine").unwrap();
    let said = copy.run(&["status"]);
    assert!(
        said.code == 1 && said.out.contains("small-a-c00"),
        "{}",
        said.out
    );
}

#[test]
fn the_verdict_is_said_by_the_first_run_the_second_and_the_summary() {
    let bench = Bench::small_done();
    let of_campaign = |out: &str| {
        // Not the row of the table of models.
        let is_first = |l: &&str| l.starts_with("small, 10 mm: ") || *l == "small, 10 mm";
        let lines = out.lines().skip_while(|l| !is_first(l));
        lines
            .take_while(|l| !l.is_empty())
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let warm = bench.run(&["run"]);
    assert!(warm.out.contains("nothing to do"), "{}", warm.out);
    let said = of_campaign(&warm.out);
    assert!(said[0].contains(", 10 mm: "), "{said:?}");
    assert!(said[1].trim_start().starts_with("error"), "{said:?}");
    let full = of_campaign(&bench.run(&["summary", "--full"]).out);
    for label in ["models", "found", "error", "sources"] {
        let has = |l: &String| l.trim_start().starts_with(label);
        assert!(full.iter().any(has), "{label}: {full:?}");
    }
    let summary = bench.run(&["summary"]);
    assert_eq!(of_campaign(&summary.out), said);
    assert!(summary.out.contains("6 sessions") && !summary.out.contains("out of date"));
    touch(
        &bench.raw().join("small/b/c50/session.toml"),
        "campaign",
        "date = \"2026-02\"\ncampaign",
    );
    assert!(bench.run(&["summary"]).out.contains("out of date"));
    let json = bench.run(&["summary", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    let models = &value["answers"][0]["models"];
    assert!(models["readings"].as_u64() > Some(0), "{value}");
    assert_eq!(models["rmse_n"][0]["model"], "new", "{value}");
    let elsewhere = bench.run(&["summary", "--raw", "elsewhere"]);
    assert!(elsewhere.out.contains("no raw directory elsewhere"));
    assert_eq!(of_campaign(&elsewhere.out), said);
    assert_eq!(Bench::empty().run(&["summary"]).code, 2);
}
