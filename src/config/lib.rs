#![warn(missing_docs)]
//! `pipeline.toml`: every option with its default, a file a section, and strict reading (`checks`).
//!
//! Each section belongs to one stage, and only its options enter that stage's cache key: a changed report title redoes no fit. No result depends on
//! `[paths]` and `[bundle]`.

#[macro_use]
mod documented;

mod bundle;
mod checks;
mod clean;
mod compare;
mod diagnose;
mod fit;
mod part;
mod paths;
mod report;
mod torque;

use documented::{Comments, find};
use pipeline_base::error::{Error, Result};
use pipeline_base::toml_syntax;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

pub use bundle::{Author, BundleOptions};
pub use clean::{CleanOptions, ZeroRule};
pub use compare::CompareOptions;
pub use diagnose::{DiagnoseOptions, FEWEST_DRAWS, MOST_EFFECTS};
pub use fit::{FitOptions, IntervalMethod};
pub use part::Part;
pub use paths::PathOptions;
pub use report::{FigureWidths, ReportOptions};
pub use torque::TorqueOptions;

/// Sections on which no result depends.
const NO_RESULT: [&str; 2] = ["paths", "bundle"];

documented! {
/// All options. `pipeline config` prints the defaults.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Where things are, relative to this file; options on the command line override it.
    pub paths: PathOptions,
    /// Cleaning of logs.
    pub clean: CleanOptions,
    /// Fits of the new model.
    pub fit: FitOptions,
    /// Which models are compared.
    pub compare: CompareOptions,
    /// The residual search.
    pub diagnose: DiagnoseOptions,
    /// Torque about a knee.
    pub torque: TorqueOptions,
    /// The reports.
    pub report: ReportOptions,
    /// The bundle for a repository: its metadata.
    pub bundle: BundleOptions,
}
}

impl Config {
    /// The defaults as TOML.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string(self).map_err(Error::internal)
    }

    /// The same for people, every section and option below a comment that says what it is.
    ///
    /// # Errors
    /// None for options that can be written as TOML.
    pub fn to_commented_toml(&self) -> Result<String> {
        let mut section = "";
        let mut text = String::new();
        let plain = self.to_toml()?;
        for line in plain.lines() {
            let of_section = line.strip_prefix('[').and_then(|l| l.strip_suffix(']'));
            section = of_section.unwrap_or(section);
            let option = line.split_once(" = ").map(|(key, _)| key);
            let comment = match (of_section, option) {
                (Some(section), _) => find(Self::COMMENTS, section),
                (None, Some(key)) => find(Self::comments_of(section), key),
                (None, None) => &[],
            };
            text.extend(comment.iter().map(|c| format!("#{c}\n")));
            text.push_str(line);
            text.push('\n');
        }
        Ok(text)
    }

    /// The comments on the options of a section.
    fn comments_of(section: &str) -> Comments {
        match section {
            "paths" => PathOptions::COMMENTS,
            "clean" => CleanOptions::COMMENTS,
            "fit" => FitOptions::COMMENTS,
            "compare" => CompareOptions::COMMENTS,
            "diagnose" => DiagnoseOptions::COMMENTS,
            "torque" => TorqueOptions::COMMENTS,
            "report" => ReportOptions::COMMENTS,
            "bundle" => BundleOptions::COMMENTS,
            _ => &[],
        }
    }

    /// Every option on which a result may depend, by dotted name, as it enters cache keys.
    ///
    /// # Errors
    /// A value that TOML cannot hold.
    pub fn flattened(&self) -> Result<BTreeMap<String, String>> {
        let mut sections = toml::Table::try_from(self).map_err(Error::internal)?;
        for section in NO_RESULT {
            sections.remove(section);
        }
        let mut all = BTreeMap::new();
        for (section, options) in &sections {
            all.extend(flatten(section, options)?);
        }
        Ok(all)
    }

    /// The configuration file: the one that is given, else `pipeline.toml`, if there is one.
    pub fn place(path: Option<&Path>) -> Option<&Path> {
        let default = Path::new("pipeline.toml");
        path.or_else(|| default.exists().then_some(default))
    }

    /// Reads a configuration file, or the defaults where there is none at the default place.
    ///
    /// # Errors
    /// The file cannot be read, or says something that is not understood.
    pub fn load(path: Option<&Path>) -> Result<Self> {
        let Some(path) = Self::place(path) else {
            return Ok(Self::default());
        };
        let text = std::fs::read_to_string(path).map_err(|e| {
            Error::Usage(format!(
                "cannot read the configuration {}: {e}",
                path.display()
            ))
        })?;
        let config = Self::read(&path.display().to_string(), &text)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let paths = config.paths.clone().from(folder);
        Ok(Self { paths, ..config })
    }

    /// Reads the text of a configuration; messages call it `file`.
    ///
    /// # Errors
    /// Every unknown key with the nearest known one and every value of a wrong type, or every value that makes no sense; each with its line
    /// and its key.
    pub fn read(file: &str, text: &str) -> Result<Self> {
        if let Some(defect) = toml_syntax::defect(file, text) {
            return Err(Error::Config(vec![defect]));
        }
        let given: toml::Table = toml::from_str(text).map_err(Error::internal)?;
        let known = toml::Table::try_from(Config::default()).map_err(Error::internal)?;
        let place = checks::Rows::new(text);
        let mut wrong = Vec::new();
        checks::find_unknown(file, &place, "", &given, &known, &mut wrong);
        wrong.extend(checks::wrong_types(file, &place, &given, &known));
        if !wrong.is_empty() {
            return Err(Error::Config(wrong));
        }
        let config: Config = toml::from_str(text).map_err(Error::internal)?;
        let mut mistakes = config.mistakes(file);
        for mistake in &mut mistakes {
            mistake.row = mistake.column.as_deref().and_then(|key| place.of(key));
        }
        if mistakes.is_empty() {
            Ok(config)
        } else {
            Err(Error::Config(mistakes))
        }
    }
}

/// The options of one section by dotted name.
fn flatten(section: &str, options: &impl Serialize) -> Result<BTreeMap<String, String>> {
    let table = toml::Table::try_from(options).map_err(Error::internal)?;
    Ok(table
        .into_iter()
        .map(|(key, value)| (format!("{section}.{key}"), value.to_string()))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_defaults_read_back_as_the_defaults() {
        let text = Config::default().to_toml().unwrap();
        assert_eq!(
            Config::read("pipeline.toml", &text).unwrap(),
            Config::default()
        );
        let commented = Config::default().to_commented_toml().unwrap();
        assert_eq!(
            Config::read("pipeline.toml", &commented).unwrap(),
            Config::default()
        );
        assert_eq!(
            Config::read("pipeline.toml", "").unwrap(),
            Config::default()
        );
    }

    #[test]
    fn no_section_and_no_option_is_printed_without_a_comment() {
        let text = Config::default().to_commented_toml().unwrap();
        let lines: Vec<&str> = text.lines().filter(|l| !l.is_empty()).collect();
        assert!(
            lines
                .iter()
                .filter(|l| l.contains(" = ") && !l.starts_with('#'))
                .count()
                > 30
        );
        for (k, line) in lines
            .iter()
            .enumerate()
            .filter(|(_, l)| !l.starts_with('#'))
        {
            let commented = k > 0 && lines[k - 1].starts_with("# ");
            assert!(
                commented,
                "an option without a comment in src/config: {line}"
            );
        }
    }

    #[test]
    fn an_unknown_key_is_an_error_that_names_the_nearest() {
        let error = Config::read("p.toml", "\n[clean]\nsetle_s = 0.1\n").unwrap_err();
        let text = error.to_string();
        assert!(text.contains("p.toml:3 [clean.setle_s]"), "{text}");
        assert!(text.contains("did you mean `settle_s`?"), "{text}");
        assert_eq!(error.exit_code(), 2);
        assert!(
            Config::read("p.toml", "[clena]\n")
                .unwrap_err()
                .to_string()
                .contains("`clean`")
        );
    }

    #[test]
    fn a_wrong_value_says_what_was_expected_without_the_names_of_rust() {
        let said = |text: &str| Config::read("p.toml", text).unwrap_err().to_string();
        let text = said("[diagnose]\ndraws = -3");
        assert!(
            text.contains("found -3; expected a whole number, zero or more"),
            "{text}"
        );
        let text = said("[fit]\nseed = 2\n[clean]\nbin_s = \"x\"\n[diagnose]\nseed = 'one'");
        assert!(
            text.contains("p.toml:4 [clean.bin_s]: found \"x\"; expected a number"),
            "{text}"
        );
        assert!(
            text.contains(
                "p.toml:6 [diagnose.seed]: found \"one\"; expected a whole number, zero or more"
            ),
            "{text}"
        );
        let text = said("[clean]\npressure_range_kpa = [1, 'x']");
        assert!(
            text.contains("p.toml:2 [clean.pressure_range_kpa]"),
            "{text}"
        );
        for value in ["'first'", "3"] {
            let text = said(&format!("[clean]\nzero = {value}"));
            assert!(text.contains("p.toml:2 [clean.zero]: found"), "{text}");
            assert!(text.contains("`zero-log` or `none`"), "{text}");
        }
        let text = said("[report]\npng_dpi = 1e9\ndate = 'soon'");
        assert!(text.contains("p.toml:2 [report.png_dpi]"), "{text}");
        assert!(text.contains("p.toml:3 [report.date]"), "{text}");
        let text = said("clean = 3");
        assert!(text.contains("p.toml:1 [clean]: found 3"), "{text}");
        let text = said("[clean]\n\nbin_s = -1.0");
        assert!(text.contains("p.toml:3 [clean.bin_s]: found -1"), "{text}");
        let text = said("[diagnose]\nbase_model = \"hunt2071\"");
        assert!(text.contains("did you mean `hunt2017`?"), "{text}");
    }

    #[test]
    fn wrong_types_and_senseless_values_are_errors() {
        for text in [
            "[clean]\nbin_s = \"x\"",
            "[clean]\nbin_s = -1.0",
            "[fit]\nloss = \"cubic\"",
            "[fit]\nconfidence = 1.5",
            "[compare]\nmodels = [\"hunt\"]",
            "[clean",
            "[diagnose]\nbase_model = \"hunt2071\"",
            "[diagnose]\ndraws = -3",
        ] {
            assert!(Config::read("p.toml", text).is_err(), "{text}");
        }
    }
}
