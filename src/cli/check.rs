//! `pipeline check`.

use crate::args::PlaceArgs;
use crate::columns::{Align, aligned, shortened};
use crate::print::{self, line, print_json};
use crate::{DIFFERENCE, DONE, doubts, nothing_usable, options, progress};
use pipeline_base::error::{Error, Result};
use pipeline_golden as golden;
use pipeline_golden::Findings;
use pipeline_golden::bless::{self, Blessing};
use pipeline_golden::compare::{Difference, Kind};
use pipeline_run as run;
use serde_json::json;
use std::path::{Path, PathBuf};

/// How many differences are printed before the rest is counted.
const SHOWN: usize = 40;
/// Longest texts in the diff table.
const LONGEST_KEY: usize = 72;
const LONGEST_CELL: usize = 24;

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// Where things are
    #[command(flatten)]
    pub places: PlaceArgs,
    /// Rerun this stage regardless of the cache
    #[arg(long, value_name = "STAGE")]
    pub force: Option<String>,
    /// Where the golden tables and golden.toml are [default: paths.golden of pipeline.toml, else tests/golden]
    #[arg(long, value_name = "DIR")]
    pub golden: Option<PathBuf>,
    /// Write a golden.toml if there is none, and take the tables of this run as the first golden ones
    #[arg(long, conflicts_with = "bless")]
    pub init: bool,
    /// Accept the new tables as golden, with a reason
    #[arg(long, requires = "reason")]
    pub bless: bool,
    /// Why the new results are right; kept in BLESSED.md
    #[arg(long, value_name = "WHY", requires = "bless")]
    pub reason: Option<String>,
}

/// Runs what changed, then compares or blesses.
pub fn command(args: &CheckArgs) -> Result<u8> {
    let (json, verbose) = (args.places.json, args.places.verbose);
    let places = args.places.places()?;
    let golden = args.golden.as_ref().unwrap_or(&places.golden);
    if args.init && golden::are_blessed(golden) {
        return Err(Error::Usage(format!(
            "there are golden tables in {} already; `pipeline check` compares with them, and --bless --reason \"why\" replaces them",
            golden.display()
        )));
    }
    let options = options(&places, args.places.jobs, args.force.as_deref(), false)?;
    let progress = progress::Shown::new(json);
    let outcome = run::run(&options, &progress)?;
    progress.finish();
    print::diagnostics(&doubts::messages(&outcome), &options.raw, verbose);
    nothing_usable(&outcome)?;
    print::left_out(&outcome.left_out);
    if args.init {
        golden::start(golden)?;
    }
    let first = args.init.then_some("the first tables");
    if let Some(reason) = args.reason.as_deref().or(first) {
        let blessing = bless::bless(golden, &places.reports, reason)?;
        print_blessing(&blessing, golden, json)?;
        return Ok(DONE);
    }
    let findings = golden::check(golden, &places.reports)?;
    print_findings(&findings, golden, json)?;
    Ok(if findings.equal() { DONE } else { DIFFERENCE })
}

fn print_blessing(blessing: &Blessing, golden: &Path, as_json: bool) -> Result<()> {
    if as_json {
        return print_json(&json!({ "golden": golden, "blessed": blessing }));
    }
    for change in &blessing.changed {
        line(format!("{}: {}", change.table, change.text()));
    }
    for table in &blessing.removed {
        line(format!(
            "{table}: removed, because golden.toml does not name it"
        ));
    }
    line(match blessing.is_empty() {
        true => "nothing changed, and nothing was written".to_owned(),
        false => format!(
            "written to {}, with the reason in {}",
            golden.display(),
            bless::LOG
        ),
    });
    Ok(())
}

fn print_findings(findings: &Findings, golden: &Path, as_json: bool) -> Result<()> {
    if as_json {
        return print_json(
            &json!({ "golden": golden, "equal": findings.equal(), "findings": findings }),
        );
    }
    for text in diff_table(&findings.differences) {
        line(text);
    }
    let left = findings.differences.len().saturating_sub(SHOWN);
    if left > 0 {
        line(format!("and {left} more; --json has them all"));
    }
    let cells: usize = findings.tables.iter().map(|t| t.cells).sum();
    let compared = format!("{} tables, {cells} cells", findings.tables.len());
    if findings.equal() {
        line(format!(
            "equal to {} within the tolerances: {compared}",
            golden.display()
        ));
        return Ok(());
    }
    line("");
    for table in findings.tables.iter().filter(|t| t.differences > 0) {
        line(format!(
            "{}: {} differences in {} rows, {} cells",
            table.table, table.differences, table.rows, table.cells
        ));
    }
    line(format!(
        "{} differences ({compared} compared); if the new results are right: pipeline check --bless --reason \"why\"",
        findings.differences.len()
    ));
    Ok(())
}

/// The first differences as aligned lines, with a heading.
fn diff_table(differences: &[Difference]) -> Vec<String> {
    if differences.is_empty() {
        return Vec::new();
    }
    let head = [
        "table",
        "row",
        "column",
        "golden",
        "fresh",
        "difference",
        "tolerance",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(differences.iter().take(SHOWN).map(cells));
    let (text, number) = (Align::Left, Align::Right);
    aligned(&rows, &[text, text, text, number, number, number, number])
}

/// A cell's difference in numbers; another one in words, which stand where the row's key would.
fn cells(d: &Difference) -> Vec<String> {
    let size = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.3e}"));
    let row = match (d.kind, d.row.is_empty()) {
        (Kind::Cell, _) => shortened(&d.row, LONGEST_KEY),
        (kind, true) => kind.text().to_owned(),
        (kind, false) => format!("{}: {}", shortened(&d.row, LONGEST_KEY), kind.text()),
    };
    let value = |text: &str| match (d.kind, text) {
        (Kind::Cell, "") => "(empty)".to_owned(),
        (_, text) => shortened(text, LONGEST_CELL),
    };
    vec![
        d.table.clone(),
        row,
        d.column.clone(),
        value(&d.golden),
        value(&d.fresh),
        size(d.difference),
        size(d.tolerance),
    ]
}
