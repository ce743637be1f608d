//! What the columns of the tables mean: one line a column in `meanings.tsv`, of all tables that have it or of those that it names.

const LINES: &str = include_str!("meanings.tsv");
/// Stands for every table without a line of its own.
const ANY: &str = "*";
/// Before the column whose words are explained.
const WORD: char = '@';

/// What the numbers in a column of a table are, with formula and source; none where nobody has said it.
pub fn of_column(table: &str, column: &str) -> Option<&'static str> {
    let of = |tables: &str| {
        let mut lines = lines().filter(|(key, of, _)| *key == column && is_among(of, tables));
        lines.next().map(|(.., meaning)| meaning)
    };
    of(table).or_else(|| of(ANY))
}

/// What a word in a column stands for: the formula of an equation, the readings of a split. None for most words.
pub fn of_word(column: &str, word: &str) -> Option<&'static str> {
    let of_column = |(key, ..): &(&str, &str, &str)| key.strip_prefix(WORD) == Some(column);
    let mut lines = lines().filter(of_column).filter(|(_, w, _)| *w == word);
    lines.next().map(|(.., meaning)| meaning)
}

fn is_among(tables: &str, table: &str) -> bool {
    tables.split(' ').any(|t| t == table)
}

/// Column, tables or word, meaning.
fn lines() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    let lines = LINES.lines().filter(|l| !l.starts_with('#'));
    lines.filter_map(|line| {
        let mut fields = line.splitn(3, '\t');
        Some((fields.next()?, fields.next()?, fields.next()?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// The columns of every golden table.
    fn columns() -> BTreeSet<(String, String)> {
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden");
        let files = std::fs::read_dir(golden).unwrap().flatten();
        let tables = files
            .map(|f| f.path())
            .filter(|p| p.extension().is_some_and(|e| e == "csv"));
        let of = |path: std::path::PathBuf| {
            let table = path.file_stem().unwrap().to_string_lossy().into_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            let header: Vec<String> = text
                .lines()
                .next()
                .unwrap()
                .split(',')
                .map(str::to_owned)
                .collect();
            header
                .into_iter()
                .map(move |column| (table.clone(), column))
        };
        tables.flat_map(of).collect()
    }

    /// `docs/tables.md` below its heading: every column of every golden table, in the order of its file.
    fn page() -> String {
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden");
        let tables: BTreeSet<String> = columns().into_iter().map(|(table, _)| table).collect();
        let cell = |text: &str| text.replace('|', "\\|").replace('\t', "; ");
        let mut lines = Vec::new();
        for table in tables {
            let text = std::fs::read_to_string(golden.join(format!("{table}.csv"))).unwrap();
            lines.push(format!("## {table}\n\n| column | meaning |\n|---|---|"));
            let header = text.lines().next().unwrap().split(',');
            lines.extend(header.map(|column| {
                let meaning = of_column(&table, column).unwrap_or_default();
                format!("| `{column}` | {} |", cell(meaning))
            }));
            lines.push(String::new());
        }
        lines.join("\n")
    }

    #[test]
    fn the_page_of_the_tables_has_every_column() {
        let there = include_str!("../../../docs/tables.md");
        let page = page();
        assert!(
            there.ends_with(&page),
            "docs/tables.md should end with:\n{page}"
        );
    }

    #[test]
    fn every_column_of_every_golden_table_has_its_meaning() {
        let without: Vec<_> = columns()
            .into_iter()
            .filter(|(table, column)| of_column(table, column).is_none())
            .collect();
        assert!(without.is_empty(), "add to meanings.tsv: {without:?}");
    }

    #[test]
    fn no_line_is_cut_short_twice_or_for_a_table_that_is_not_there() {
        let tables: BTreeSet<String> = columns().into_iter().map(|(table, _)| table).collect();
        let mut seen = BTreeSet::new();
        for line in LINES.lines().filter(|l| !l.starts_with('#')) {
            let fields: Vec<&str> = line.split('\t').collect();
            let [column, of, meaning] = fields[..] else {
                panic!("{line}");
            };
            assert!(!meaning.is_empty() && seen.insert((column, of)), "{line}");
            let known =
                |t: &str| t == ANY || tables.contains(t) || ["plateaus", "provenance"].contains(&t);
            assert!(
                column.starts_with(WORD) || of.split(' ').all(known),
                "{line}"
            );
        }
    }

    #[test]
    fn the_line_of_a_table_comes_before_that_of_all() {
        assert_ne!(of_column("budget", "rmse"), of_column("zeros", "rmse"));
        assert_eq!(
            of_column("comparison_by_length", "rmse"),
            of_column("any", "rmse")
        );
        assert!(
            of_word("equation", "F*(eps*, P*)")
                .unwrap()
                .contains("Eq. 8")
        );
        assert_eq!(of_word("equation", "F"), None);
    }
}
