#![warn(missing_docs)]
//! Golden tables: what the results of the shipped sessions were when somebody last looked at them and said why they are right.
//!
//! ```text
//! tests/golden/golden.toml   which tables, their key columns, the tolerances       settings
//! tests/golden/<table>.csv   the tables as they were blessed                        table
//! tests/golden/BLESSED.md    every blessing: reason, tables, number of changed cells bless
//! ```
//! Rows are matched by their key columns, never by position ([`compare`]); numbers compare as numbers, texts as texts. Deliberately
//! absent: knowledge of any single table. A new table is one entry in `golden.toml` and a blessing; until it has its entry, it counts as
//! a difference, so that no result goes unwatched by mistake.
//! What differs is said in the order of `golden.toml`, which begins with what matters most. A project of a laboratory's own needs no entries:
//! `standard = true` stands for those of the pipeline's own tables ([`start`]).

pub mod bless;
pub mod compare;
pub mod settings;
pub mod table;

use compare::{Difference, Kind};
use pipeline_base::error::{Error, Result};
use serde::Serialize;
use settings::{SETTINGS, Settings};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use table::Table;

/// The settings of a project that has said nothing yet.
const FIRST_SETTINGS: &str = r#"# What `pipeline check` compares the tables of a run with: the tables beside this file, as they were when somebody last looked at them and wrote
#
#     pipeline check --bless --reason "why the results are right"
#
# Rows are matched by the columns that tell them apart, never by position.

# Every table that the pipeline makes is compared. An entry of your own, [table.NAME] with `key`, `tolerance` or `columns.NAME`, takes the place
# of the standard one.
standard = true

# Tables that are written and not compared.
leave_out = ["audit"] # the papers' claims, which your sessions do not change

# Numbers may differ by the larger of `absolute` and `relative` times the golden number.
[tolerance]
absolute = 1e-9
relative = 1e-6
"#;

/// How one table fared.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TableResult {
    /// Name, without extension.
    pub table: String,
    /// Rows of the golden table.
    pub rows: usize,
    /// Cells that were compared, those of key columns not among them.
    pub cells: usize,
    /// Differences found.
    pub differences: usize,
}

/// What a comparison found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// Every table, in the order of golden.toml.
    pub tables: Vec<TableResult>,
    /// Every difference: by table, then in the order of its rows and columns.
    pub differences: Vec<Difference>,
}

impl Findings {
    /// Whether fresh and golden tables are equal within their tolerances.
    pub fn equal(&self) -> bool {
        self.differences.is_empty()
    }
}

/// Compares the tables that the last run left below `reports` with the golden ones.
///
/// # Errors
/// There are no golden tables, or something cannot be read or understood.
pub fn check(golden: &Path, reports: &Path) -> Result<Findings> {
    let settings = Settings::load(golden)?;
    let blessed = blessed(golden)?;
    if blessed.is_empty() {
        return Err(Error::Usage(format!(
            "no golden tables in {}: look at {}, and if the results are right, `pipeline check --init` writes them",
            golden.display(),
            reports.join("tables").display()
        )));
    }
    let fresh = fresh(reports)?;
    let mut findings = Findings {
        tables: Vec::new(),
        differences: Vec::new(),
    };
    for name in names(&settings, &blessed, &fresh) {
        let (old, new) = (blessed.get(name), fresh.get(name));
        let found = one(&settings, name, old, new)?;
        findings.tables.push(TableResult {
            table: name.clone(),
            rows: old.map_or(0, |t| t.rows.len()),
            cells: found.cells,
            differences: found.differences.len(),
        });
        findings.differences.extend(found.differences);
    }
    Ok(findings)
}

/// The tables in question: in the order of the settings, then those that these do not know.
fn names<'a>(
    settings: &'a Settings,
    blessed: &'a BTreeMap<String, Table>,
    fresh: &'a BTreeMap<String, Table>,
) -> Vec<&'a String> {
    let others: BTreeSet<&String> = blessed.keys().chain(fresh.keys()).collect();
    let others = others.into_iter();
    let others = others.filter(|name| !settings.table.contains_key(*name));
    let all = settings.order.iter().chain(others);
    all.filter(|name| !settings.leave_out.contains(name))
        .collect()
}

/// One table, which may be missing on either side or from the settings.
fn one(
    settings: &Settings,
    name: &str,
    old: Option<&Table>,
    new: Option<&Table>,
) -> Result<compare::Compared> {
    let whole = |kind| compare::Compared::only(Difference::of_table(name, kind));
    Ok(match (settings.table.get(name), old, new) {
        (None, _, None) => whole(Kind::TableLeftOver),
        (None, _, Some(_)) => whole(Kind::TableUnknown),
        (Some(_), None, None) => whole(Kind::TableUnmade),
        (Some(_), Some(_), None) => whole(Kind::TableMissing),
        (Some(_), None, Some(_)) => whole(Kind::TableNew),
        (Some(of_table), Some(old), Some(new)) => {
            settings.check_columns(name, old, new)?;
            let tolerance = |column: &str| settings.tolerance_of(of_table, column);
            compare::tables(name, &of_table.key, &tolerance, old, new)
        }
    })
}

/// Writes a `golden.toml` for a project that has none: all standard tables, the usual tolerance. Whether there was none.
///
/// # Errors
/// The file cannot be written.
pub fn start(golden: &Path) -> Result<bool> {
    let path = golden.join(SETTINGS);
    if path.exists() {
        return Ok(false);
    }
    std::fs::create_dir_all(golden).map_err(Error::io("create the folder", golden))?;
    std::fs::write(&path, FIRST_SETTINGS).map_err(Error::io("write", &path))?;
    Ok(true)
}

/// Whether somebody has taken tables as golden ones.
pub fn are_blessed(golden: &Path) -> bool {
    blessed(golden).is_ok_and(|tables| !tables.is_empty())
}

/// The golden tables, by name.
fn blessed(golden: &Path) -> Result<BTreeMap<String, Table>> {
    let entries = std::fs::read_dir(golden).map_err(|e| {
        Error::Usage(format!(
            "cannot read the golden tables in {}: {e}; give their place with --golden DIR",
            golden.display()
        ))
    })?;
    let mut tables = BTreeMap::new();
    for entry in entries {
        let path = entry.map_err(Error::io("read", golden))?.path();
        if path.extension().is_some_and(|e| e == "csv") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            tables.insert(name.into_owned(), Table::read(&path)?);
        }
    }
    Ok(tables)
}

/// The tables of the last run, by name, as its `summary.json` lists them: a file that an older version left is none of them.
fn fresh(reports: &Path) -> Result<BTreeMap<String, Table>> {
    let path = reports.join("summary.json");
    let text = std::fs::read(&path).map_err(Error::io("read", &path))?;
    let summary: serde_json::Value = serde_json::from_slice(&text).map_err(Error::internal)?;
    let listed = summary["tables"].as_array().into_iter().flatten();
    let mut tables = BTreeMap::new();
    for relative in listed.filter_map(|t| t.as_str()) {
        let path = reports.join(relative);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        tables.insert(name.into_owned(), Table::read(&path)?);
    }
    Ok(tables)
}

/// The file of the settings, for messages.
fn settings_file(golden: &Path) -> String {
    golden.join(SETTINGS).display().to_string()
}
