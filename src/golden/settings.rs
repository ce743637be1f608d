//! `golden.toml`: which tables are compared, by which columns their rows are known, and how far numbers may differ.

use crate::table::Table;
use pipeline_base::diagnostics::{Diagnostic, nearest};
use pipeline_base::error::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Name of the file in the golden directory.
pub const SETTINGS: &str = "golden.toml";

/// How far two numbers may differ: by the larger of `absolute` and `relative` times the golden number's size.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// In the unit of the column.
    pub absolute: f64,
    /// As a fraction of the golden number.
    pub relative: f64,
}

impl Tolerance {
    /// Not a bit may differ.
    pub const EXACT: Tolerance = Tolerance {
        absolute: 0.0,
        relative: 0.0,
    };

    /// How far a number may lie from this golden one.
    pub fn around(self, golden: f64) -> f64 {
        self.absolute.max(self.relative * golden.abs())
    }
}

/// What a table or column says of its tolerance; what it does not say holds as before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Override {
    /// In the unit of the column.
    pub absolute: Option<f64>,
    /// As a fraction of the golden number.
    pub relative: Option<f64>,
}

impl Override {
    fn over(self, before: Tolerance) -> Tolerance {
        Tolerance {
            absolute: self.absolute.unwrap_or(before.absolute),
            relative: self.relative.unwrap_or(before.relative),
        }
    }

    fn numbers(self) -> impl Iterator<Item = f64> {
        self.absolute.into_iter().chain(self.relative)
    }
}

/// The settings for the tables that the pipeline makes: those of its own repository.
const STANDARD: &str = include_str!("../../tests/golden/golden.toml");

/// One table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSettings {
    /// The columns that tell its rows apart.
    pub key: Vec<String>,
    /// The tolerance of its columns.
    #[serde(default)]
    pub tolerance: Override,
    /// The tolerance of single columns.
    #[serde(default)]
    pub columns: BTreeMap<String, Override>,
}

/// All of it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// The tolerance of everything that says nothing else.
    pub tolerance: Tolerance,
    /// Tables that are knowingly not compared.
    #[serde(default)]
    pub leave_out: Vec<String>,
    /// Whether all tables that the pipeline makes have an entry without being named here.
    #[serde(default)]
    pub standard: bool,
    /// The tables, by name.
    #[serde(default)]
    pub table: BTreeMap<String, TableSettings>,
    /// The names of the tables in the order of the file, the standard ones after those that it names itself.
    #[serde(skip)]
    pub order: Vec<String>,
    /// The file, for messages.
    #[serde(skip)]
    file: String,
}

impl Settings {
    /// Reads the settings of a golden directory.
    ///
    /// # Errors
    /// There is no file, or it says something that is not understood.
    pub fn load(golden: &Path) -> Result<Self> {
        let file = super::settings_file(golden);
        let text = std::fs::read_to_string(golden.join(SETTINGS)).map_err(|e| {
            Error::Usage(format!(
                "cannot read {file}, which says what is compared, by which columns and how closely: {e}; `pipeline check --init` begins with one, --golden DIR \
                 names another folder"
            ))
        })?;
        Self::read(&file, &text)
    }

    /// Reads the text of the settings; messages call it `file`.
    ///
    /// # Errors
    /// A line that is not understood, a table without key, a tolerance that is none.
    pub fn read(file: &str, text: &str) -> Result<Self> {
        let expected =
            "[tolerance] absolute, relative; leave_out; [table.NAME] key, tolerance, columns";
        let mut settings: Settings = toml::from_str(text).map_err(|e| {
            let found = e.message().lines().collect::<Vec<_>>().join(" ");
            let row = e
                .span()
                .map(|s| 1 + text[..s.start].matches('\n').count() as u64);
            let mut diagnostic = Diagnostic::error(file, found, expected, "correct the line");
            diagnostic.row = row;
            Error::Config(vec![diagnostic])
        })?;
        settings.file = file.to_owned();
        settings.order = order_of_tables(text);
        if settings.standard {
            settings.add_standard()?;
        }
        let mistakes = settings.mistakes();
        if mistakes.is_empty() {
            Ok(settings)
        } else {
            Err(Error::Config(mistakes))
        }
    }

    fn add_standard(&mut self) -> Result<()> {
        let standard = Self::read("the standard settings", STANDARD)?;
        for name in standard.leave_out {
            if !self.leave_out.contains(&name) && !self.table.contains_key(&name) {
                self.leave_out.push(name);
            }
        }
        for name in standard.order {
            if !self.leave_out.contains(&name) && !self.table.contains_key(&name) {
                self.table
                    .insert(name.clone(), standard.table[&name].clone());
                self.order.push(name);
            }
        }
        Ok(())
    }

    fn mistakes(&self) -> Vec<Diagnostic> {
        let mut mistakes = Vec::new();
        let mut mistake = |place: String, found: &str, expected: &str| {
            let hint = "see the comments at the head of the file";
            mistakes.push(
                Diagnostic::error(self.file.as_str(), found, expected, hint).in_column(place),
            );
        };
        let bad = |x: f64| !(x.is_finite() && x >= 0.0);
        let number = "a number that is zero or more";
        if bad(self.tolerance.absolute) || bad(self.tolerance.relative) {
            mistake("tolerance".to_owned(), "no tolerance", number);
        }
        for (name, table) in &self.table {
            if table.key.is_empty() {
                let expected = "the columns that tell its rows apart";
                mistake(format!("table.{name}.key"), "nothing", expected);
            }
            if self.leave_out.contains(name) {
                let expected = "an entry, or a place in leave_out, not both";
                mistake(
                    format!("table.{name}"),
                    "a table that is left out",
                    expected,
                );
            }
            if table.tolerance.numbers().any(bad) {
                mistake(format!("table.{name}.tolerance"), "no tolerance", number);
            }
            for (column, tolerance) in &table.columns {
                if tolerance.numbers().any(bad) {
                    mistake(
                        format!("table.{name}.columns.{column}"),
                        "no tolerance",
                        number,
                    );
                }
            }
        }
        mistakes
    }

    /// The tolerance of a column.
    pub fn tolerance_of(&self, table: &TableSettings, column: &str) -> Tolerance {
        let of_table = table.tolerance.over(self.tolerance);
        let of_column = table.columns.get(column);
        of_column.map_or(of_table, |c| c.over(of_table))
    }

    /// A tolerance for a column that neither the golden nor the fresh table has is a slip of the finger.
    ///
    /// # Errors
    /// The first such column.
    pub(super) fn check_columns(&self, name: &str, old: &Table, new: &Table) -> Result<()> {
        let known: Vec<&str> = old
            .columns
            .iter()
            .chain(&new.columns)
            .map(String::as_str)
            .collect();
        let named = self.table[name].columns.keys();
        let Some(stranger) = named.into_iter().find(|c| !known.contains(&c.as_str())) else {
            return Ok(());
        };
        let hint = match nearest(stranger, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "take the entry out".to_owned(),
        };
        let found = "a column that the table does not have";
        let diagnostic = Diagnostic::error(self.file.as_str(), found, known.join(", "), hint)
            .in_column(format!("table.{name}.columns.{stranger}"));
        Err(Error::Config(vec![diagnostic]))
    }
}

/// The names of the tables in the order in which the file has them.
fn order_of_tables(text: &str) -> Vec<String> {
    let Ok(all) = DeTable::parse(text) else {
        return Vec::new();
    };
    let Some(DeValue::Table(tables)) = all.get_ref().get("table").map(Spanned::get_ref) else {
        return Vec::new();
    };
    let mut names: Vec<_> = tables.iter().map(|(name, _)| name).collect();
    names.sort_by_key(|name| name.span().start);
    names.into_iter().map(|n| n.get_ref().to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[tolerance]\nabsolute = 1e-9\nrelative = 1e-6\n\n[table.fits]\nkey = [\"campaign\"]\n\
                        tolerance.relative = 1e-3\ncolumns.rmse = { absolute = 0.5 }\n";

    #[test]
    fn a_column_inherits_what_it_does_not_say() {
        let settings = Settings::read("golden.toml", GOOD).unwrap();
        let fits = &settings.table["fits"];
        let of = |column| settings.tolerance_of(fits, column);
        assert_eq!((of("n").absolute, of("n").relative), (1e-9, 1e-3));
        assert_eq!((of("rmse").absolute, of("rmse").relative), (0.5, 1e-3));
        assert_eq!(of("rmse").around(2000.0), 2.0);
        assert_eq!(of("rmse").around(-1.0), 0.5);
    }

    #[test]
    fn the_standard_tables_come_behind_those_of_the_file_which_hold() {
        let text = format!("standard = true\nleave_out = [\"sessions\"]\n{GOOD}");
        let settings = Settings::read("golden.toml", &text).unwrap();
        assert_eq!(settings.order.first().map(String::as_str), Some("fits"));
        assert_eq!(settings.table["fits"].key, ["campaign"]);
        assert!(settings.table.contains_key("coefficients"));
        assert!(!settings.table.contains_key("sessions"));
        let mut named: Vec<&String> = settings.order.iter().collect();
        named.sort();
        assert_eq!(named, settings.table.keys().collect::<Vec<_>>());
    }

    #[test]
    fn mistakes_name_their_place() {
        for (change, place) in [
            (("1e-9", "-1.0"), "[tolerance]"),
            (("[\"campaign\"]", "[]"), "[table.fits.key]"),
            (("0.5", "nan"), "[table.fits.columns.rmse]"),
            (("key", "keys"), "golden.toml:6"),
            (
                ("[tolerance]", "leave_out = [\"fits\"]\n[tolerance]"),
                "[table.fits]",
            ),
        ] {
            let text = GOOD.replacen(change.0, change.1, 1);
            let error = Settings::read("golden.toml", &text).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(place), "{error}");
        }
    }
}
