//! The pages of the reports, as they are laid out: nothing outside the type area, no page nearly empty, no letters too small to read.

use crate::support::{Bench, read_table};
use pipeline::report::layout::{Layout, Sheet};
use std::collections::BTreeMap;

/// Half of a rule at the margin lies beyond it, mm.
const HALF_A_RULE_MM: f64 = 0.5;
const LEAST_FILLED: f64 = 1.0 / 3.0;
/// Of documents whose blocks are packed.
const LEAST_FILLED_IF_PACKED: f64 = 0.6;
const PACKED: [&str; 4] = ["force.pdf", "knee.pdf", "residual.pdf", "supplement.pdf"];
const SMALLEST_PT: f64 = 8.0;

/// What is wrong with the pages of a run.
fn defects(bench: &Bench) -> Vec<String> {
    let layout = std::fs::read(bench.root().join("derived/layout.json")).unwrap();
    let documents: BTreeMap<String, Layout> = serde_json::from_slice(&layout).unwrap();
    for name in ["force.pdf", "residual.pdf", "supplement.pdf"] {
        assert!(documents.contains_key(name), "{name} was not measured");
    }
    let of_document = |(name, layout): (&String, &Layout)| {
        let Layout { sheets, warnings } = layout;
        let sheet = |k: usize| {
            let ends_chapter = sheets.get(k + 1).is_none_or(|next| next.opens_chapter);
            let place = format!("{name}, page {}", k + 1);
            let least = if PACKED.contains(&name.as_str()) {
                LEAST_FILLED_IF_PACKED
            } else {
                LEAST_FILLED
            };
            let found = of_sheet(&sheets[k], least, ends_chapter).into_iter();
            found.map(move |what| format!("{place}: {what}"))
        };
        let warnings = warnings.iter().map(|w| format!("{name}: {w}"));
        warnings
            .chain((0..sheets.len()).flat_map(sheet))
            .collect::<Vec<_>>()
    };
    documents.iter().flat_map(of_document).collect()
}

fn of_sheet(sheet: &Sheet, least_filled: f64, ends_chapter: bool) -> Vec<String> {
    let mut found = Vec::new();
    if sheet.beyond_mm > HALF_A_RULE_MM {
        found.push(format!("{:.1} mm over the margin", sheet.beyond_mm));
    }
    if sheet.filled < least_filled && !ends_chapter {
        found.push(format!("only {:.0}% filled", 100.0 * sheet.filled));
    }
    let smallest = sheet.smallest.iter().filter(|s| s.pt < SMALLEST_PT - 1e-6);
    found.extend(smallest.map(|s| format!("{:.2} pt: {}", s.pt, s.text)));
    found
}

#[test]
fn the_pages_of_a_small_laboratory_are_well_laid_out() {
    assert_eq!(defects(&Bench::small_done()), [""; 0]);
}

#[test]
fn models_are_ranked_on_readings_that_all_ranked_models_answer() {
    let bench = Bench::small_done();
    let table = bench.table("model_comparison");
    let of = |model: &str, split: &str| {
        let mut rows = table.iter();
        let row = rows.find(|r| r["model"] == model && r["split"] == split);
        row.unwrap_or_else(|| panic!("{model}, {split}")).clone()
    };
    let common: usize = of("new", "common")["n"].parse().unwrap();
    assert!(common > 0);
    for model in ["new", "hunt2017", "festo_tool"] {
        let [on_common, on_all] = ["common", "loso"].map(|split| of(model, split));
        assert_eq!(on_common["n"], common.to_string(), "{model}");
        assert_eq!(on_common["n_excluded"], "0", "{model}");
        assert!(on_all["n"].parse::<usize>().unwrap() >= common, "{model}");
    }
}

#[test]
fn the_first_figure_shows_the_errors_that_the_table_gives() {
    let bench = Bench::small_done();
    let table = bench.table("model_comparison");
    let drawn = read_table(&bench.root().join("reports/figures/common-readings.csv"));
    for (title, model) in [
        ("New model, fitted", "new"),
        ("New model, published", "new_published"),
        ("Hunt 2017", "hunt2017"),
        ("Festo tool", "festo_tool"),
    ] {
        let of_model = drawn
            .iter()
            .filter(|r| r["title"] == title && r["kind"] == "marks");
        let number = |r: &BTreeMap<String, String>, key: &str| r[key].parse::<f64>().unwrap();
        let errors: Vec<f64> = of_model.map(|r| number(r, "y") - number(r, "x")).collect();
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let rmse = (squares / errors.len() as f64).sqrt();
        let mut rows = table.iter();
        let row = rows.find(|r| r["model"] == model && r["split"] == "common");
        let row = row.unwrap_or_else(|| panic!("{model}"));
        assert_eq!(row["n"], errors.len().to_string(), "{model}");
        assert!((number(row, "rmse") - rmse).abs() < 1e-6, "{model}: {rmse}");
    }
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;
    use std::path::Path;

    #[test]
    #[ignore = "long: 21 s of processor time"]
    fn the_pages_of_the_shipped_sessions_are_well_laid_out() {
        let bench = Bench::empty();
        let raw = Path::new(env!("CARGO_MANIFEST_DIR")).join("raw");
        let said = bench.run(&["run", "--raw", raw.to_str().unwrap()]);
        assert_eq!(said.code, 0, "{}", said.err);
        assert_eq!(defects(&bench), [""; 0]);
    }
}

/// The pages speak of the levels that decide, which they do not import.
#[test]
fn the_levels_in_words_are_those_of_the_decisions() {
    use pipeline::inference::decisions;
    use pipeline::report::wording;
    assert_eq!(wording::COMES_IN, decisions::COMES_IN);
    assert_eq!(wording::SIGNIFICANT, decisions::LEVEL);
    assert_eq!(wording::ALIKE, decisions::ALIKE);
}
