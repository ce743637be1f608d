#![warn(missing_docs)]
//! `pipeline.toml`: every option with its default, and strict reading (`checks`).
//!
//! Each section belongs to one stage, and only its options enter that stage's cache key: a changed report title redoes no fit.

mod checks;
mod part;

use pipeline_base::error::{Error, Result};
use pipeline_base::toml_syntax;
use pipeline_numerics::plateaus::PlateauOptions;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use part::Part;

/// Keeps the doc comments of options beside their names, so that `pipeline config` prints what stands here. rustfmt does not format what
/// stands in it.
macro_rules! documented {
    ($(#[$meta:meta])* pub struct $name:ident { $($(#[doc = $doc:literal])+ pub $key:ident: $type:ty,)* }) => {
        $(#[$meta])*
        pub struct $name { $($(#[doc = $doc])+ pub $key: $type,)* }
        impl $name {
            /// Every option with the lines of its doc comment.
            const COMMENTS: Comments = &[$((stringify!($key), &[$($doc),+])),*];
        }
    };
}

/// Most effects in one model of the loop.
pub const MOST_EFFECTS: usize = 6;

/// Options with the lines of their doc comments.
type Comments = &'static [(&'static str, &'static [&'static str])];

documented! {
/// All options. `pipeline config` prints the defaults.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Where things are, relative to this file; the options of the command line come before it.
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
}
}

documented! {
/// Where things are. No result depends on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathOptions {
    /// Raw directories, which are only read.
    pub raw: Vec<PathBuf>,
    /// The cache and the tidy data.
    pub derived: PathBuf,
    /// Reports, tables and figures.
    pub reports: PathBuf,
    /// Golden tables and golden.toml, for `pipeline check`.
    pub golden: PathBuf,
}
}

impl Default for PathOptions {
    fn default() -> Self {
        Self {
            raw: vec!["raw".into()],
            derived: "derived".into(),
            reports: "reports".into(),
            golden: "tests/golden".into(),
        }
    }
}

impl PathOptions {
    /// The same paths from the folder in which the command runs, of a file in `folder`.
    fn from(self, folder: &Path) -> Self {
        Self {
            raw: self.raw.iter().map(|raw| folder.join(raw)).collect(),
            derived: folder.join(self.derived),
            reports: folder.join(self.reports),
            golden: folder.join(self.golden),
        }
    }
}

/// Where the zero of the force channel comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroRule {
    /// The session's zero log; see `stages::clean::zero` for what happens where it cannot be used.
    ZeroLog,
    /// Forces are taken as they were logged.
    None,
}

/// How the interval of a coefficient is made; `stages::fit::intervals` has the methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IntervalMethod {
    /// Refits without each specimen, Student's t.
    Jackknife,
    /// Refits to specimens drawn with replacement, percentiles.
    Bootstrap,
    /// Profile of the sum of squares; counts every row as independent.
    Profile,
    /// Covariance of the linearised model; counts every row as independent.
    Linearised,
}

impl IntervalMethod {
    /// Every method, in the order of the tables.
    pub const ALL: [IntervalMethod; 4] = [
        IntervalMethod::Jackknife,
        IntervalMethod::Bootstrap,
        IntervalMethod::Profile,
        IntervalMethod::Linearised,
    ];

    /// What tables call it.
    pub fn name(self) -> &'static str {
        match self {
            IntervalMethod::Jackknife => "jackknife by specimen",
            IntervalMethod::Bootstrap => "bootstrap by specimen",
            IntervalMethod::Profile => "profile likelihood",
            IntervalMethod::Linearised => "linearised",
        }
    }
}

documented! {
/// Options of the clean stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CleanOptions {
    /// "zero-log" or "none".
    pub zero: ZeroRule,
    /// Width of the bins in which the pressure is looked at, s.
    pub bin_s: f64,
    /// Rate of pressure above which a valve must be open, kPa/s.
    pub step_rate_kpa_per_s: f64,
    /// Time after a step that is left out, s.
    pub settle_s: f64,
    /// Length of a plateau's window, s.
    pub window_s: f64,
    /// Shortest window that is used, s.
    pub shortest_window_s: f64,
    /// Pressure by which two windows between the same two steps must differ, kPa.
    pub distinct_kpa: f64,
    /// A pause of the clock that ends a plateau, s.
    pub longest_gap_s: f64,
    /// Change of pressure that turns filling into venting where no state is logged, kPa.
    pub turning_kpa: f64,
    /// Fewest samples of a plateau.
    pub fewest_samples: usize,
    /// Pressure may drift by this much within a window, kPa.
    pub largest_drift_kpa: f64,
    /// Force may drift by this fraction of the session's range of force within a window (at least 2 N).
    pub largest_force_drift: f64,
    /// Fraction of a plateau's samples at the converter's limit above which it is censored.
    pub most_clipped: f64,
    /// Fraction of unusable rows above which a log is left out.
    pub most_bad_rows: f64,
    /// Gauge pressures outside are no pressures, kPa.
    pub pressure_range_kpa: [f64; 2],
    /// Forces beyond are no forces, N.
    pub largest_force_n: f64,
    /// An isolated sample that differs from its neighbours by this fraction of the channel's range is a spike.
    pub spike_fraction: f64,
}
}

impl Default for CleanOptions {
    fn default() -> Self {
        Self {
            zero: ZeroRule::ZeroLog,
            bin_s: 0.02,
            step_rate_kpa_per_s: 60.0,
            settle_s: 0.15,
            window_s: 0.25,
            shortest_window_s: 0.1,
            distinct_kpa: 5.0,
            longest_gap_s: 0.1,
            turning_kpa: 4.0,
            fewest_samples: 10,
            largest_drift_kpa: 5.0,
            largest_force_drift: 0.01,
            most_clipped: 0.05,
            most_bad_rows: 0.01,
            pressure_range_kpa: [-50.0, 1500.0],
            largest_force_n: 20_000.0,
            spike_fraction: 0.1,
        }
    }
}

impl CleanOptions {
    /// The options of the plateau search.
    pub fn plateaus(&self) -> PlateauOptions {
        PlateauOptions {
            bin_s: self.bin_s,
            step_rate_kpa_per_s: self.step_rate_kpa_per_s,
            settle_s: self.settle_s,
            window_s: self.window_s,
            shortest_window_s: self.shortest_window_s,
            distinct_kpa: self.distinct_kpa,
            longest_gap_s: self.longest_gap_s,
        }
    }
}

documented! {
/// Options of the fit stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitOptions {
    /// "huber", "least_squares", "lar", "bisquare" or "cauchy".
    pub loss: String,
    /// Where Huber's loss bends, in units of the least-squares RMSE.
    pub huber_at_rmse: f64,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Which interval the tables print: "jackknife", "bootstrap", "profile" or "linearised"; the first two go by specimen. All are in
    /// `intervals.csv`.
    pub interval: IntervalMethod,
    /// Refits of the bootstrap by specimen; of more than 10,000 readings fewer, down to 200, where steps from the full fit do not give them.
    pub bootstrap_refits: usize,
    /// Seed of the bootstrap and of the split by row.
    pub seed: u64,
    /// Fraction of each session's rows that the split by row trains on, as in the force paper.
    pub train_fraction: f64,
    /// Rows with |eps*| up to this count as measured at resting length.
    pub at_rest: f64,
    /// Rows within this of 620 kPa give the measured maximum force, kPa.
    pub near_620_kpa: f64,
    /// Length at which the end caps of 10 mm actuators touch, m.
    pub l_0_10mm_m: f64,
    /// The same for 20 mm.
    pub l_0_20mm_m: f64,
    /// Also fit each diameter over all measured campaigns that have it.
    pub pool: bool,
}
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            loss: "huber".to_owned(),
            huber_at_rmse: 3.0,
            confidence: 0.95,
            interval: IntervalMethod::Jackknife,
            bootstrap_refits: 1000,
            seed: 1,
            train_fraction: 0.8,
            at_rest: 0.05,
            near_620_kpa: 15.0,
            l_0_10mm_m: 0.0075,
            l_0_20mm_m: 0.013,
            pool: true,
        }
    }
}

documented! {
/// Options of the compare stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CompareOptions {
    /// Ids of the published models to compare; empty for all.
    pub models: Vec<String>,
}
}

documented! {
/// Options of the residual search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DiagnoseOptions {
    /// The model whose residual is searched: "new", "new_published", or the id of another published model.
    pub base_model: String,
    /// Whether its coefficients are fitted anew with every effect (of a published model: a factor on its force; those of "new_published" are
    /// held in any case).
    pub refit: bool,
    /// Most effects in one answer, at most 6.
    pub most_effects: usize,
    /// The search looks at so many readings of a campaign, an equal share of each session.
    pub most_readings: usize,
    /// Draws from the fitted null model, with which the strongest candidate is compared.
    pub draws: usize,
    /// Smallest effect of interest, N (root mean square over the readings that it acts on): a smaller one is listed as negligible and
    /// changes no verdict.
    pub smallest_effect_n: f64,
    /// The same of torques, N.m.
    pub smallest_effect_nm: f64,
    /// All campaigns of one diameter are searched together as well, with a gain, a zero and a noise of each campaign, where they have at most so
    /// many specimens; 0 for never.
    pub pooled_specimens: usize,
    /// Seed of draws and of the shuffled column.
    pub seed: u64,
}
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self {
            base_model: "new".to_owned(),
            refit: true,
            most_effects: 6,
            most_readings: 4000,
            draws: 199,
            smallest_effect_n: 0.5,
            smallest_effect_nm: 0.05,
            pooled_specimens: 12,
            seed: 1,
        }
    }
}

documented! {
/// Options of the torque stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueOptions {
    /// Length of one end fitting where a session states none, mm.
    pub fitting_mm: f64,
    /// Words by which the notes of a torque session say that it is in doubt: it is shown, and takes part in no fit. `[]` for none.
    pub doubtful_words: Vec<String>,
}
}

impl Default for TorqueOptions {
    fn default() -> Self {
        let words = [
            "superseded",
            "excluded",
            "reject",
            "rejected",
            "doubtful",
            "uncertain",
            "unsure",
            "slipped",
            "unreliable",
        ];
        Self {
            fitting_mm: 25.4,
            doubtful_words: words.map(str::to_owned).to_vec(),
        }
    }
}

documented! {
/// Options of the report stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReportOptions {
    /// Title of `force.pdf`.
    pub title: String,
    /// Authors, as they are to be printed; empty for none.
    pub author: String,
    /// Date of the document, ISO 8601; empty for none. Never today's.
    pub date: String,
    /// Resolution of the PNG figures, dots per inch.
    pub png_dpi: f64,
    /// Widths of the figures, one and two columns: "house" (85 and 175 mm), "ieee" (88 and 181 mm), "elsevier" (90 and 190 mm).
    pub figure_widths: FigureWidths,
    /// Whether `audit.pdf` is made: the papers' numeric claims, each recomputed. The table `audit` is there in any case.
    pub audit: bool,
}
}

/// For whose columns figures are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FigureWidths {
    /// Ours: two columns are as wide as the text of the reports.
    House,
    /// Journals of the IEEE.
    Ieee,
    /// Journals of Elsevier.
    Elsevier,
}

impl FigureWidths {
    /// Widths of one and of two columns, mm.
    pub fn columns_mm(self) -> [f64; 2] {
        match self {
            Self::House => [85.0, 175.0],
            Self::Ieee => [88.0, 181.0],
            Self::Elsevier => [90.0, 190.0],
        }
    }
}

impl Default for ReportOptions {
    fn default() -> Self {
        Self {
            title: "Isometric force of braided pneumatic actuators".to_owned(),
            author: String::new(),
            date: String::new(),
            png_dpi: 150.0,
            figure_widths: FigureWidths::House,
            audit: false,
        }
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
            _ => &[],
        }
    }

    /// Every option on which a result may depend, by dotted name, as it enters cache keys.
    ///
    /// # Errors
    /// A value that TOML cannot hold.
    pub fn flattened(&self) -> Result<BTreeMap<String, String>> {
        let mut sections = toml::Table::try_from(self).map_err(Error::internal)?;
        sections.remove("paths");
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

/// The comment on one option.
fn find(comments: Comments, key: &str) -> &'static [&'static str] {
    let found = comments.iter().find(|(name, _)| *name == key);
    found.map_or(&[], |(_, lines)| lines)
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
                "an option without a comment in src/config/lib.rs: {line}"
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
