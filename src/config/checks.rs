//! What is wrong with a configuration: keys that are no options, values of a wrong type, values that make no sense.

use super::Config;
use crate::bundle::{author, is_license};
use pipeline_base::date::is_date;
use pipeline_base::diagnostics::{Diagnostic, nearest};
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// Resolutions of the PNG figures: with fewer dots nothing can be seen, with more a figure fills the memory.
const PNG_DPI: std::ops::RangeInclusive<f64> = 10.0..=1200.0;

/// Numbers that make no sense unless a condition holds.
struct Rule<'a> {
    options: &'a [(&'static str, f64)],
    holds: fn(f64) -> bool,
    expected: &'static str,
}

impl Rule<'_> {
    fn mistakes(&self, file: &str) -> Vec<Diagnostic> {
        let wrong = self.options.iter().filter(|(_, x)| !(self.holds)(*x));
        wrong
            .map(|(key, x)| mistake(file, key, &x.to_string(), self.expected))
            .collect()
    }
}

impl Config {
    /// Values that are of the right type and make no sense.
    pub(super) fn mistakes(&self, file: &str) -> Vec<Diagnostic> {
        let parts = [
            self.mistakes_of_numbers(file),
            self.mistakes_of_counts(file),
            self.mistakes_of_names(file),
            self.mistakes_of_report(file),
            self.mistakes_of_bundle(file),
        ];
        parts.into_iter().flatten().collect()
    }

    /// Numbers that have to be positive, or shares, or ascend.
    fn mistakes_of_numbers(&self, file: &str) -> Vec<Diagnostic> {
        let (clean, fit, diagnose) = (&self.clean, &self.fit, &self.diagnose);
        let rules = [
            Rule {
                options: &[
                    ("clean.bin_s", clean.bin_s),
                    ("clean.step_rate_kpa_per_s", clean.step_rate_kpa_per_s),
                    ("clean.window_s", clean.window_s),
                    ("clean.shortest_window_s", clean.shortest_window_s),
                    ("clean.longest_gap_s", clean.longest_gap_s),
                    ("clean.spike_fraction", clean.spike_fraction),
                    ("fit.at_rest", fit.at_rest),
                    ("fit.near_620_kpa", fit.near_620_kpa),
                    ("fit.huber_at_rmse", fit.huber_at_rmse),
                    ("torque.fitting_mm", self.torque.fitting_mm),
                ],
                holds: |x| x > 0.0 && x.is_finite(),
                expected: "a positive number",
            },
            Rule {
                options: &[
                    ("clean.settle_s", clean.settle_s),
                    ("clean.distinct_kpa", clean.distinct_kpa),
                    ("clean.turning_kpa", clean.turning_kpa),
                    ("clean.largest_drift_kpa", clean.largest_drift_kpa),
                    ("clean.largest_force_drift", clean.largest_force_drift),
                    ("diagnose.smallest_effect_n", diagnose.smallest_effect_n),
                    ("diagnose.smallest_effect_nm", diagnose.smallest_effect_nm),
                ],
                holds: |x| x >= 0.0 && x.is_finite(),
                expected: "0 or a positive number",
            },
            Rule {
                options: &[
                    ("fit.confidence", fit.confidence),
                    ("fit.train_fraction", fit.train_fraction),
                ],
                holds: |x| x > 0.0 && x < 1.0,
                expected: "a number between 0 and 1",
            },
        ];
        let mut mistakes: Vec<Diagnostic> = rules.iter().flat_map(|r| r.mistakes(file)).collect();
        let [low, high] = clean.pressure_range_kpa;
        if !(low < high && low.is_finite() && high.is_finite()) {
            let found = format!("[{low}, {high}]");
            let expected = "two numbers, the smaller first";
            mistakes.push(mistake(file, "clean.pressure_range_kpa", &found, expected));
        }
        mistakes
    }

    /// Whole numbers that have to lie in a range.
    fn mistakes_of_counts(&self, file: &str) -> Vec<Diagnostic> {
        let d = &self.diagnose;
        let most = crate::MOST_EFFECTS;
        let counts = [
            ("diagnose.most_effects", d.most_effects, 1..=most),
            ("diagnose.most_readings", d.most_readings, 100..=100_000),
            ("diagnose.draws", d.draws, crate::FEWEST_DRAWS..=100_000),
            ("diagnose.pooled_specimens", d.pooled_specimens, 0..=100),
        ];
        let wrong = counts.into_iter().filter(|(_, x, of)| !of.contains(x));
        let said = wrong.map(|(key, x, of)| {
            let expected = format!("a whole number from {} to {}", of.start(), of.end());
            mistake(file, key, &x.to_string(), &expected)
        });
        said.collect()
    }

    /// Names of a loss and of models that are not known.
    fn mistakes_of_names(&self, file: &str) -> Vec<Diagnostic> {
        let mut mistakes = Vec::new();
        let loss = &self.fit.loss;
        if loss.parse::<pipeline_numerics::loss::Loss>().is_err() {
            let expected = "huber, least_squares, lar, bisquare or cauchy";
            mistakes.push(mistake(file, "fit.loss", loss, expected));
        }
        let models = pipeline_mechanics::models::published();
        let ids: Vec<&str> = models.iter().map(|m| m.id()).collect();
        let known = ids.join(", ");
        let unknown = |id: &&String| !ids.contains(&id.as_str());
        for id in self.compare.models.iter().filter(unknown) {
            let expected = format!("ids among {known}");
            mistakes.push(mistake(file, "compare.models", id, &expected));
        }
        let base = &self.diagnose.base_model;
        if base != "new" && unknown(&base) {
            let expected = format!("new, or one of {known}");
            let mut unknown = mistake(file, "diagnose.base_model", base, &expected);
            if let Some(near) = nearest(base, ids.iter().copied()) {
                unknown.hint = format!("did you mean `{near}`?").into();
            }
            mistakes.push(unknown);
        }
        mistakes
    }

    /// Figures that nobody can see or that fill the memory; a date that does not exist.
    fn mistakes_of_report(&self, file: &str) -> Vec<Diagnostic> {
        let mut mistakes = Vec::new();
        let dpi = self.report.png_dpi;
        if !PNG_DPI.contains(&dpi) {
            let (least, most) = (PNG_DPI.start(), PNG_DPI.end());
            let expected = format!("a number from {least} to {most} (dots per inch)");
            mistakes.push(mistake(file, "report.png_dpi", &dpi.to_string(), &expected));
        }
        let date = &self.report.date;
        if !date.is_empty() && !is_date(date) {
            let expected = "a day or a month that exists, in ISO 8601, such as \"2022-11-30\"";
            mistakes.push(mistake(file, "report.date", date, expected));
        }
        mistakes
    }

    /// A license that is none, authors that cannot be read.
    fn mistakes_of_bundle(&self, file: &str) -> Vec<Diagnostic> {
        let options = &self.bundle;
        let mut mistakes = Vec::new();
        if !is_license(&options.license) {
            let expected = "an SPDX identifier, such as \"CC-BY-4.0\", or an address";
            mistakes.push(mistake(file, "bundle.license", &options.license, expected));
        }
        for text in options.authors.iter().filter(|a| author(a).is_none()) {
            let expected =
                "a name, or a name with its ORCID, such as \"Ada Lovelace <0000-0002-1825-0097>\"";
            mistakes.push(mistake(file, "bundle.authors", text, expected));
        }
        mistakes
    }
}

/// What an option has to be, where its value is not that: the words that it may be, which the deserializer knows, or what the default is an
/// example of.
fn expected(section: &str, key: &str, default: &toml::Value) -> String {
    match default {
        toml::Value::Integer(_) => "a whole number, zero or more".to_owned(),
        toml::Value::Float(_) => "a number".to_owned(),
        toml::Value::Boolean(_) => "true or false".to_owned(),
        toml::Value::Array(list) => match list.first() {
            Some(toml::Value::Float(_)) => format!("a list of {} numbers", list.len()),
            _ => "a list of texts in quotes".to_owned(),
        },
        _ => words(section, key).unwrap_or_else(|| "text in quotes".to_owned()),
    }
}

/// The words that an option may be, if only some may.
fn words(section: &str, key: &str) -> Option<String> {
    let error = alone(section, key, &String::new().into()).err()?;
    let line = error.message().lines().next()?.to_owned();
    Some(line.split_once(", expected ")?.1.to_owned())
}

/// One option beside the defaults of all others.
fn alone(
    section: &str,
    key: &str,
    value: &toml::Value,
) -> std::result::Result<Config, toml::de::Error> {
    let option = toml::Table::from_iter([(key.to_owned(), value.clone())]);
    toml::Table::from_iter([(section.to_owned(), option.into())]).try_into::<Config>()
}

fn mistake(file: &str, key: &str, found: &str, expected: &str) -> Diagnostic {
    Diagnostic::error(file, found, expected, "see `pipeline config`").in_column(key)
}

/// The lines of a configuration on which its keys stand, by dotted name.
pub(super) struct Rows(BTreeMap<String, u64>);

impl Rows {
    /// Those of a text; none where it is no TOML, which the deserializer says better.
    pub(super) fn new(text: &str) -> Self {
        let mut rows = BTreeMap::new();
        if let Ok(table) = DeTable::parse(text) {
            Self::add(text, "", table.get_ref(), &mut rows);
        }
        Self(rows)
    }

    fn add(text: &str, path: &str, table: &DeTable, rows: &mut BTreeMap<String, u64>) {
        for (key, value) in table {
            let full = dotted(path, key.get_ref());
            let line = 1 + text[..key.span().start].matches('\n').count() as u64;
            rows.insert(full.clone(), line);
            if let DeValue::Table(inner) = value.get_ref() {
                Self::add(text, &full, inner, rows);
            }
        }
    }

    /// The line of a key, counted from 1; none where it is not in the text.
    pub(super) fn of(&self, key: &str) -> Option<u64> {
        self.0.get(key).copied()
    }
}

fn dotted(path: &str, key: &str) -> String {
    if path.is_empty() {
        key.to_owned()
    } else {
        format!("{path}.{key}")
    }
}

/// Every value that is not of its option's type: each option is read by itself, beside the defaults of all others. Keys that are no options are
/// left to [`find_unknown`].
pub(super) fn wrong_types(
    file: &str,
    rows: &Rows,
    given: &toml::Table,
    known: &toml::Table,
) -> Vec<Diagnostic> {
    let mut wrong = Vec::new();
    for (section, options) in given
        .iter()
        .filter(|(section, _)| known.contains_key(*section))
    {
        let known = known[section].as_table();
        let Some(options) = options.as_table() else {
            let expected = format!("[{section}] on a line of its own, and its options below it");
            let found = options.to_string();
            let diagnostic = Diagnostic::error(file, found, expected, "see `pipeline config`");
            wrong.push(at(diagnostic, rows, section));
            continue;
        };
        for (key, value) in options {
            let Some(default) = known.and_then(|known| known.get(key)) else {
                continue;
            };
            if alone(section, key, value).is_err() {
                let (found, expected) = (value.to_string(), expected(section, key, default));
                let diagnostic = Diagnostic::error(file, found, expected, "see `pipeline config`");
                wrong.push(at(diagnostic, rows, &dotted(section, key)));
            }
        }
    }
    wrong
}

/// The defect with its key and, where that is in the text, its line.
fn at(mut diagnostic: Diagnostic, rows: &Rows, key: &str) -> Diagnostic {
    diagnostic.row = rows.of(key);
    diagnostic.in_column(key)
}

/// Every key that is no option, with the nearest that is.
pub(super) fn find_unknown(
    file: &str,
    rows: &Rows,
    path: &str,
    given: &toml::Table,
    known: &toml::Table,
    unknown: &mut Vec<Diagnostic>,
) {
    for (key, value) in given {
        let full = dotted(path, key);
        match (known.get(key), value) {
            (None, _) => {
                let hint = match nearest(key, known.keys().map(String::as_str)) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => "see `pipeline config` for all options".to_owned(),
                };
                let names: Vec<&str> = known.keys().map(String::as_str).collect();
                let expected = format!("one of {}", names.join(", "));
                let diagnostic = Diagnostic::error(file, "an unknown key", expected, hint);
                unknown.push(at(diagnostic, rows, &full));
            }
            (Some(toml::Value::Table(known)), toml::Value::Table(given)) => {
                find_unknown(file, rows, &full, given, known, unknown);
            }
            _ => {}
        }
    }
}
