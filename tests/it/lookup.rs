//! `explain`, `graph` and `gc` on what a run left.

use crate::support::Bench;
use std::collections::BTreeSet;

#[test]
fn a_number_leads_back_to_the_files_of_its_session() {
    let bench = Bench::small_done();
    let rows = bench.table("plateaus");
    let line = rows
        .iter()
        .position(|r| r["session"] == "small-b-c50")
        .unwrap()
        + 2;
    let cell = format!("reports/tables/plateaus.csv:{line}:force_n");
    let said = bench.run(&["explain", &cell]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.out.contains(&format!(
            "line {line}, force_n = {}",
            rows[line - 2]["force_n"]
        )),
        "{}",
        said.out
    );
    assert!(
        said.out.contains("small/b/c50/test8.csv") && !said.out.contains("small/a/"),
        "{}",
        said.out
    );
    assert!(said.out.contains("unchanged"), "{}", said.out);
    assert!(
        !said.out.contains("diagnose:"),
        "a reading depends on no search: {}",
        said.out
    );
}

#[test]
fn a_report_leads_back_to_every_raw_file_and_json_says_it_all() {
    let bench = Bench::small_done();
    let said = bench.run(&["explain", "force.pdf", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let raw = bench.snapshot("raw").len();
    assert_eq!(told["raw_files"].as_object().unwrap().len(), raw);
    let text = |unit: &serde_json::Value, key: &str| unit[key].as_str().unwrap().to_owned();
    let units = told["units"].as_array().unwrap().iter();
    let units: BTreeSet<String> = units
        .map(|u| text(u, "stage") + " " + &text(u, "unit"))
        .collect();
    for stage in ["ingest", "clean", "normalize"] {
        for session in ["a-c00", "a-c50", "b-c00", "b-c50", "c-c00", "c-c50"] {
            assert!(
                units.contains(&format!("{stage} small-{session}")),
                "{units:?}"
            );
        }
    }
    for stage in ["fit", "compare", "diagnose"] {
        assert!(units.contains(&format!("{stage} small 10 mm")), "{units:?}");
    }
    assert!(
        units.contains("report reports") && !units.contains("report tables"),
        "{units:?}"
    );
    assert_eq!(told["made_by"], "report reports");
}

#[test]
fn a_changed_file_an_option_and_a_wrong_name_are_said() {
    let bench = Bench::small();
    std::fs::write(
        bench.root().join("pipeline.toml"),
        "[clean]\nsettle_s = 0.2\n",
    )
    .unwrap();
    assert_eq!(bench.run(&["run"]).code, 0);
    std::fs::write(bench.root().join("reports/tables/zeros.csv"), "mine\n").unwrap();
    let said = bench.run(&["explain", "tables/zeros.csv"]);
    assert!(said.out.contains("changed since the run"), "{}", said.out);
    assert!(
        said.out.contains("clean.settle_s = 0.2 (default 0.15)"),
        "{}",
        said.out
    );
    let said = bench.run(&["explain", "zeroes.csv"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("did you mean zeros.csv?"), "{}", said.err);
    let said = Bench::empty().run(&["explain", "zeros.csv"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("pipeline run"), "{}", said.err);
}

#[test]
fn a_column_may_be_a_number_and_what_has_no_cells_says_where_they_are() {
    let bench = Bench::small_done();
    let says = |cell: &str| bench.run(&["explain", cell]);
    let value = &bench.table("coefficients")[1]["value"];
    let header = std::fs::read_to_string(bench.root().join("reports/tables/coefficients.csv"));
    let header = header.unwrap();
    let at = header
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == "value");
    for column in ["value".to_owned(), (at.unwrap() + 1).to_string()] {
        let said = says(&format!("coefficients.csv:3:{column}"));
        assert!(
            said.out.contains(&format!("line 3, value = {value}")),
            "{}{}",
            said.out,
            said.err
        );
        assert!(
            said.out.contains("least squares"),
            "how it is computed: {}",
            said.out
        );
    }
    for (cell, part) in [
        ("coefficients.csv:3:99", "it has"),
        ("coefficients.csv:3", "FILE:LINE:COLUMN"),
        ("coefficients.md:3:value", "coefficients.csv:LINE:value"),
        ("force.pdf:1:2", "CSV"),
    ] {
        let said = says(cell);
        assert_eq!(said.code, 2, "{cell}");
        assert!(said.err.contains(part), "{cell}: {}", said.err);
    }
}

#[test]
fn the_graph_joins_the_stages_from_raw_files_to_reports() {
    let bench = Bench::small_done();
    let said = bench.run(&["graph"]);
    for edge in [
        "raw --> ingest",
        "ingest --> clean",
        "clean --> normalize",
        "normalize --> fit",
        "fit --> compare",
        "compare --> report",
        "report --> force_pdf",
    ] {
        assert!(said.out.contains(edge), "{edge} in {}", said.out);
    }
    let raw = bench.snapshot("raw").len();
    let tables = bench.snapshot("reports/tables").into_keys();
    let tables = tables.filter(|name| name.ends_with(".csv")).count();
    for node in [format!("raw ({raw} files)"), format!("tables ({tables})")] {
        assert!(said.out.contains(&node), "{node} in {}", said.out);
    }
    assert!(!said.out.contains("figures (0)"), "{}", said.out);
    let units = bench.run(&["graph", "--format", "dot", "--units"]);
    assert!(units.out.contains("clean small-b-c50"), "{}", units.out);
}

#[test]
fn rubbish_goes_and_what_is_needed_stays() {
    let bench = Bench::small_done();
    std::fs::write(
        bench.root().join("pipeline.toml"),
        "[clean]\nsettle_s = 0.2\n",
    )
    .unwrap();
    assert_eq!(bench.run(&["run"]).code, 0);
    let before = bench.snapshot("derived/cache").len();
    let reports = bench.snapshot("reports");
    let dry = bench.run(&["gc", "--older-than", "0", "--dry-run"]);
    assert_eq!(bench.snapshot("derived/cache").len(), before);
    let gone = bench.run(&["gc", "--older-than", "0"]);
    let what = |out: &str| out.split_once(": ").unwrap().1.to_owned();
    assert_eq!(
        what(&gone.out),
        what(&dry.out),
        "the dry run says what then goes"
    );
    assert!(bench.snapshot("derived/cache").len() < before);
    assert_eq!(bench.outcome(&["run"])["computed"], serde_json::json!([]));
    assert_eq!(bench.snapshot("reports"), reports);
}

#[test]
fn gc_leaves_nothing_where_nothing_was_run() {
    let bench = Bench::empty();
    let said = bench.run(&["gc"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("nothing has been run"), "{}", said.err);
    assert!(!bench.root().join("derived").exists());
}
