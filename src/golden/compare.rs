//! The differences of two tables: cell by cell where both have row and column, in words where they do not.

use crate::settings::Tolerance;
use crate::table::Table;
use serde::Serialize;

/// What differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A cell.
    Cell,
    /// A golden row is missing from the fresh table.
    RowMissing,
    /// The fresh table has a row that the golden one has not.
    RowNew,
    /// A golden column is missing from the fresh table.
    ColumnMissing,
    /// The fresh table has a column that the golden one has not.
    ColumnNew,
    /// A golden table was not made by the run.
    TableMissing,
    /// A table of the settings was made and never blessed.
    TableNew,
    /// A table was made that the settings do not know.
    TableUnknown,
    /// The settings name a table that is neither golden nor made.
    TableUnmade,
    /// A golden file belongs to no table.
    TableLeftOver,
}

impl Kind {
    /// What it means, in words; nothing for a cell, whose values speak.
    pub fn text(self) -> &'static str {
        match self {
            Kind::Cell => "",
            Kind::RowMissing => "the row is missing",
            Kind::RowNew => "the row is new",
            Kind::ColumnMissing => "the column is missing",
            Kind::ColumnNew => "the column is new",
            Kind::TableMissing => "the run does not make this table any more",
            Kind::TableNew => "the table has no golden copy yet; --bless accepts it",
            Kind::TableUnknown => {
                "the table is new; give it an entry in golden.toml (or leave_out)"
            }
            Kind::TableUnmade => "golden.toml names this table, and the run does not make it",
            Kind::TableLeftOver => "a golden table without an entry in golden.toml",
        }
    }
}

/// One difference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Table.
    pub table: String,
    /// The texts of the row's key columns, with an ordinal where several rows have them; empty where no single row is meant.
    pub row: String,
    /// Column; empty where no single column is meant.
    pub column: String,
    /// What differs.
    pub kind: Kind,
    /// The golden text.
    pub golden: String,
    /// The fresh text.
    pub fresh: String,
    /// Fresh minus golden, for numbers.
    pub difference: Option<f64>,
    /// By how much the numbers may differ.
    pub tolerance: Option<f64>,
}

impl Difference {
    fn new(table: &str, kind: Kind, row: String, column: &str) -> Self {
        Self {
            table: table.to_owned(),
            row,
            column: column.to_owned(),
            kind,
            golden: String::new(),
            fresh: String::new(),
            difference: None,
            tolerance: None,
        }
    }

    /// A difference of a table as a whole.
    pub(super) fn of_table(table: &str, kind: Kind) -> Self {
        Self::new(table, kind, String::new(), "")
    }
}

/// The differences of one table.
#[derive(Clone, Debug, Default)]
pub struct Compared {
    /// Cells that both tables have, key columns left aside.
    pub cells: usize,
    /// What differs.
    pub differences: Vec<Difference>,
}

impl Compared {
    /// Nothing but one difference.
    pub(super) fn only(difference: Difference) -> Self {
        Self {
            cells: 0,
            differences: vec![difference],
        }
    }
}

/// Compares two tables whose rows are known by `key`; `tolerance` is that of a column.
pub fn tables(
    name: &str,
    key: &[String],
    tolerance: &dyn Fn(&str) -> Tolerance,
    old: &Table,
    new: &Table,
) -> Compared {
    let mut compared = Compared::default();
    let differences = &mut compared.differences;
    columns(name, old, new, differences);
    let shared: Vec<(&str, usize, usize, Tolerance)> = old
        .columns
        .iter()
        .enumerate()
        .filter(|(_, column)| !key.contains(column))
        .filter_map(|(k, column)| {
            Some((column.as_str(), k, new.column(column)?, tolerance(column)))
        })
        .collect();
    let (old_rows, new_rows) = (old.by_key(key), new.by_key(key));
    let mut in_order: Vec<_> = old_rows.iter().collect();
    in_order.sort_by_key(|(_, place)| **place);
    for (known_by, place) in in_order {
        let Some(fresh) = new_rows.get(known_by) else {
            differences.push(Difference::new(name, Kind::RowMissing, label(known_by), ""));
            continue;
        };
        for (column, k, l, tolerance) in &shared {
            compared.cells += 1;
            let (golden, fresh) = (&old.rows[*place][*k], &new.rows[*fresh][*l]);
            if let Some(by) = cell(golden, fresh, *tolerance) {
                differences.push(Difference {
                    golden: golden.clone(),
                    fresh: fresh.clone(),
                    difference: by.map(|b| b.0),
                    tolerance: by.map(|b| b.1),
                    ..Difference::new(name, Kind::Cell, label(known_by), column)
                });
            }
        }
    }
    let mut unknown: Vec<_> = new_rows
        .iter()
        .filter(|(k, _)| !old_rows.contains_key(k))
        .collect();
    unknown.sort_by_key(|(_, place)| **place);
    for (known_by, _) in unknown {
        differences.push(Difference::new(name, Kind::RowNew, label(known_by), ""));
    }
    compared
}

fn columns(name: &str, old: &Table, new: &Table, differences: &mut Vec<Difference>) {
    let mut lost = |from: &Table, to: &Table, kind| {
        let missing = from.columns.iter().filter(|c| to.column(c).is_none());
        differences.extend(missing.map(|c| Difference::new(name, kind, String::new(), c)));
    };
    lost(old, new, Kind::ColumnMissing);
    lost(new, old, Kind::ColumnNew);
}

/// A row as its key tells it, the ordinal from the second on.
fn label((texts, ordinal): &(Vec<&str>, usize)) -> String {
    let text = texts.join(" | ");
    match ordinal {
        1 => text,
        n => format!("{text} (no. {n})"),
    }
}

/// Whether two cells differ: `None` where they do not; for numbers by how much, and by how much they may.
fn cell(golden: &str, fresh: &str, tolerance: Tolerance) -> Option<Option<(f64, f64)>> {
    if golden == fresh {
        return None;
    }
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
    match (number(golden), number(fresh)) {
        (Some(a), Some(b)) => {
            let (difference, allowed) = (b - a, tolerance.around(a));
            (difference.abs() > allowed).then_some(Some((difference, allowed)))
        }
        _ => Some(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: Tolerance = Tolerance {
        absolute: 1e-3,
        relative: 1e-2,
    };

    fn compare(old: &str, new: &str) -> Vec<Difference> {
        let (old, new) = (Table::parse(old).unwrap(), Table::parse(new).unwrap());
        let key = ["k".to_owned()];
        tables("t", &key, &|_| TOLERANCE, &old, &new).differences
    }

    #[test]
    fn numbers_within_the_larger_of_both_tolerances_are_equal() {
        let golden = "k,v\na,100\nb,0.0\nc,-1e3\n";
        assert!(compare(golden, "k,v\na,101\nb,0.001\nc,-1010.0\n").is_empty());
        let found = compare(golden, "k,v\na,101.1\nb,-0.0011\nc,-989\n");
        let rows: Vec<&str> = found.iter().map(|d| d.row.as_str()).collect();
        assert_eq!(rows, ["a", "b", "c"]);
        assert!((found[0].difference.unwrap() - 1.1).abs() < 1e-12);
        assert_eq!(found[0].tolerance, Some(1.0));
        assert_eq!(found[1].tolerance, Some(1e-3));
    }

    #[test]
    fn texts_compare_as_texts_and_empty_equals_only_empty() {
        assert!(compare("k,v,w\na,ok,\n", "k,v,w\na,ok,\n").is_empty());
        let found = compare(
            "k,v,w\na,ok,\nb,inf,1\n",
            "k,v,w\na,at a bound,0\nb,1,1.0\n",
        );
        let columns: Vec<(&str, &str)> = found
            .iter()
            .map(|d| (d.row.as_str(), d.column.as_str()))
            .collect();
        assert_eq!(columns, [("a", "v"), ("a", "w"), ("b", "v")]);
        assert!(found.iter().all(|d| d.difference.is_none()));
    }

    #[test]
    fn rows_are_matched_by_key_and_columns_by_name() {
        assert!(compare("k,v,w\na,1,x\nb,2,y\n", "w,v,k\ny,2,b\nx,1,a\n").is_empty());
    }

    #[test]
    fn rows_and_columns_that_come_and_go_are_said_in_words() {
        let found = compare(
            "k,v,w\na,1,1\nb,2,2\nb,3,3\n",
            "k,v,x\na,1,1\nb,2,2\nc,4,4\n",
        );
        let kinds: Vec<(Kind, &str, &str)> = found
            .iter()
            .map(|d| (d.kind, d.row.as_str(), d.column.as_str()))
            .collect();
        assert_eq!(
            kinds,
            [
                (Kind::ColumnMissing, "", "w"),
                (Kind::ColumnNew, "", "x"),
                (Kind::RowMissing, "b (no. 2)", ""),
                (Kind::RowNew, "c", ""),
            ]
        );
    }
}
