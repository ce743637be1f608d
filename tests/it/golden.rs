//! `pipeline check`: golden tables of the small campaign.

use crate::support::Bench;
use std::path::PathBuf;

const SETTINGS: &str = r#"
[tolerance]
absolute = 1e-9
relative = 1e-6

[table.coefficients]
key = ["campaign", "equation", "coefficient"]
columns.rmse = { relative = 0.5 }

[table.sessions]
key = ["session"]
"#;

/// The settings: two tables are compared, and all others that there are left out.
fn settings(bench: &Bench) -> String {
    assert_eq!(bench.run(&["run"]).code, 0);
    let files = bench.snapshot("reports/tables").into_keys();
    let tables = files.filter_map(|f| Some(f.strip_suffix(".csv")?.to_owned()));
    let others = tables.filter(|t| !["coefficients", "sessions"].contains(&t.as_str()));
    let quoted: Vec<String> = others.map(|t| format!("{t:?}")).collect();
    format!("leave_out = [{}]\n{SETTINGS}", quoted.join(", "))
}

/// A bench whose results are blessed.
fn blessed() -> Bench {
    let bench = Bench::small_done();
    std::fs::create_dir_all(golden(&bench, "")).unwrap();
    std::fs::write(golden(&bench, "golden.toml"), settings(&bench)).unwrap();
    let said = bench.run(&["check", "--bless", "--reason", "the first ones"]);
    assert_eq!(said.code, 0, "{}", said.err);
    bench
}

fn golden(bench: &Bench, file: &str) -> PathBuf {
    bench.root().join("tests/golden").join(file)
}

/// Changes a golden file.
fn edit(bench: &Bench, file: &str, change: impl Fn(&str) -> String) {
    let path = golden(bench, file);
    let before = std::fs::read_to_string(&path).unwrap();
    let after = change(&before);
    assert_ne!(before, after, "the edit does nothing");
    std::fs::write(path, after).unwrap();
}

/// The file with the numbers of a column multiplied.
fn scaled(text: &str, column: &str, factor: f64) -> String {
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    // The equation, quoted, holds commas: count from the end.
    let from_end = header.split(',').rev().position(|c| c == column).unwrap();
    let mut out = vec![header.to_owned()];
    for line in lines {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        let k = fields.len() - 1 - from_end;
        let value: f64 = fields[k].parse().unwrap();
        fields[k] = (value * factor).to_string();
        out.push(fields.join(","));
    }
    out.join("\n") + "\n"
}

fn scaled_by(column: &'static str, factor: f64) -> impl Fn(&str) -> String {
    move |text| scaled(text, column, factor)
}

#[test]
fn blessed_results_pass_and_are_logged_without_date() {
    let bench = blessed();
    let said = bench.run(&["check"]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(
        said.out
            .contains("equal to tests/golden within the tolerances: 2 tables"),
        "{}",
        said.out
    );
    let log = std::fs::read_to_string(golden(&bench, "BLESSED.md")).unwrap();
    let rows = bench.table("coefficients").len();
    let expected = format!(
        "- the first ones. *Cells:* coefficients (new, {rows} rows), sessions (new, 6 rows).\n"
    );
    assert!(log.starts_with("# Blessed\n"), "{log}");
    assert!(log.ends_with(&expected), "{log}");
    let again = bench.run(&["check", "--bless", "--reason", "nothing new"]);
    assert!(again.out.contains("nothing changed"), "{}", again.out);
    assert_eq!(
        std::fs::read_to_string(golden(&bench, "BLESSED.md")).unwrap(),
        log
    );
}

#[test]
fn a_changed_cell_is_a_difference_beyond_its_tolerance_only() {
    let bench = blessed();
    edit(&bench, "coefficients.csv", scaled_by("rmse", 1.4));
    edit(
        &bench,
        "coefficients.csv",
        scaled_by("max_abs_error", 1.0 + 5e-7),
    );
    let said = bench.run(&["check"]);
    assert_eq!(said.code, 0, "{}", said.out);
    edit(
        &bench,
        "coefficients.csv",
        scaled_by("max_abs_error", 1.0 + 5e-6),
    );
    let said = bench.run(&["check"]);
    assert_eq!(said.code, 1, "{}", said.out);
    assert!(
        said.out.contains("max_abs_error") && said.out.contains("difference"),
        "{}",
        said.out
    );
    assert!(!said.out.contains(" rmse "), "{}", said.out);
    let value: serde_json::Value =
        serde_json::from_str(&bench.run(&["check", "--json"]).out).unwrap();
    assert_eq!(value["equal"], false);
    let first = &value["findings"]["differences"][0];
    assert_eq!(
        (first["table"].as_str(), first["column"].as_str()),
        (Some("coefficients"), Some("max_abs_error"))
    );
    let relative = first["difference"].as_f64().unwrap()
        / first["golden"].as_str().unwrap().parse::<f64>().unwrap();
    assert!((relative + 5.5e-6).abs() < 1e-8, "{relative}");
}

#[test]
fn rows_and_columns_that_come_and_go_are_said_in_words_and_blessed_away() {
    let bench = blessed();
    edit(&bench, "sessions.csv", |text| {
        let mut lines: Vec<String> = text.lines().map(|l| format!("{l},1")).collect();
        lines[0] = lines[0].replace(",1", ",extra");
        let last = lines.pop().unwrap();
        lines.push(last.replacen("small-", "other-", 1));
        lines.join("\n") + "\n"
    });
    let said = bench.run(&["check"]);
    assert_eq!(said.code, 1);
    for text in [
        "the column is missing",
        "extra",
        "the row is missing",
        "other-c-c50",
        "the row is new",
        "small-c-c50",
    ] {
        assert!(said.out.contains(text), "{text}\n{}", said.out);
    }
    assert_eq!(
        bench
            .run(&["check", "--bless", "--reason", "as it was"])
            .code,
        0
    );
    assert_eq!(bench.run(&["check"]).code, 0);
    let log = std::fs::read_to_string(golden(&bench, "BLESSED.md")).unwrap();
    assert!(
        log.ends_with("- as it was. *Cells:* sessions (3 changed).\n"),
        "{log}"
    );
}

#[test]
fn tables_that_come_and_go_are_differences() {
    let bench = blessed();
    std::fs::remove_file(golden(&bench, "sessions.csv")).unwrap();
    std::fs::write(golden(&bench, "gone.csv"), "a\n1\n").unwrap();
    edit(&bench, "golden.toml", |text| text.replace("\"fits\", ", ""));
    let said = bench.run(&["check"]);
    assert_eq!(said.code, 1);
    for text in [
        "has no golden copy yet",
        "without an entry",
        "give it an entry in golden.toml",
    ] {
        assert!(said.out.contains(text), "{text}\n{}", said.out);
    }
}

#[test]
fn usage_mistakes_exit_with_2() {
    let bench = Bench::small();
    let says = |arguments: &[&str], text: &str| {
        let said = bench.run(arguments);
        assert_eq!(said.code, 2, "{arguments:?}\n{}", said.out);
        assert!(said.err.contains(text), "{arguments:?}\n{}", said.err);
    };
    says(&["check"], "golden.toml");
    std::fs::create_dir_all(golden(&bench, "")).unwrap();
    std::fs::write(golden(&bench, "golden.toml"), settings(&bench)).unwrap();
    says(&["check"], "pipeline check --init");
    says(&["check", "--bless"], "--reason");
    says(&["check", "--bless", "--reason", " "], "--reason");
    says(&["check", "--golden", "nowhere"], "--golden DIR");
    assert_eq!(
        bench.run(&["check", "--bless", "--reason", "first"]).code,
        0
    );
    edit(&bench, "golden.toml", |text| {
        text.replace("columns.rmse", "columns.rsme")
    });
    says(&["check"], "did you mean `rmse`?");
    edit(&bench, "golden.toml", |text| {
        text.replace("columns.rsme", "column.rmse")
    });
    says(&["check"], "golden.toml:");
    edit(&bench, "golden.toml", |text| {
        text.replace("column.rmse", "columns.rmse")
    });
    std::fs::write(golden(&bench, "sessions.csv"), "session\na,b\n").unwrap();
    says(&["check"], "is no table");
}
