//! The campaign as it is planned.

use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::toml_reader::{Entry, Reader, Section, parse};
use pipeline_mechanics::models::new;
use serde::Serialize;

/// Schema of a plan.
pub const SCHEMA: &str = "bpa-plan/1";

/// A plan to begin with.
pub const EXAMPLE: &str = r#"# A planned campaign, for `pipeline plan`.
schema = "bpa-plan/1"
diameter_mm = 10
rest_lengths_mm = [112, 182, 257, 382, 455]   # one actuator each
contraction_620 = 0.165                       # of the free actuator at 620 kPa
contractions = [0, 0.25, 0.5, 0.75]           # lengths set, as shares of that; each is a session
pressures_kpa = [50, 100, 150, 200, 250, 300, 350, 400, 450, 500, 550, 620]
venting = true                                # also read while venting
runs = 2                                      # logs per session
scatter_of = ""                               # a campaign of the last run whose scatter is expected; else [scatter]

[scatter]             # standard deviations; the defaults are as here
gain = 0.04           # specimen gain
length_mm = 0.4       # set lengths
contracted = 0.009    # free lengths at 620 kPa about those that the noted ones tell, share of the resting length
zero_n = 1.0          # zero of the force of a session
common_misfit = 0.02  # misfit of the law common to all, share of the force
session_misfit = 0.01 # misfit of each session, along the pressure
noise_n = 2.0         # readings
"#;

/// Expected scatter: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scatter {
    /// Strength of specimens, relative.
    pub gain: f64,
    /// Set lengths, mm.
    pub length_mm: f64,
    /// Contracted lengths about what those noted are worth, share of the resting length.
    pub contracted: f64,
    /// Zero of the force of a session, N.
    pub zero_n: f64,
    /// Misfit that all share, share of the force.
    pub common_misfit: f64,
    /// Misfit of a session along the pressure, share of the force.
    pub session_misfit: f64,
    /// Noise of a reading, N.
    pub noise_n: f64,
}

impl Default for Scatter {
    /// What the laboratory's 10 mm campaigns have, rounded.
    fn default() -> Self {
        Self {
            gain: 0.04,
            length_mm: 0.4,
            contracted: 0.009,
            zero_n: 1.0,
            common_misfit: 0.02,
            session_misfit: 0.01,
            noise_n: 2.0,
        }
    }
}

/// A planned campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Nominal diameter, mm: one with published coefficients.
    pub diameter_mm: u32,
    /// Resting lengths, mm: one specimen each.
    pub rest_lengths_mm: Vec<f64>,
    /// eps_620.
    pub contraction_620: f64,
    /// Relative contractions: each is a session of every specimen.
    pub contractions: Vec<f64>,
    /// Set points of a log, kPa.
    pub pressures_kpa: Vec<f64>,
    /// Whether they are read on the way down too.
    pub venting: bool,
    /// Logs of a session.
    pub runs: usize,
    /// A campaign whose scatter is expected.
    pub scatter_of: Option<String>,
    /// Expected scatter.
    pub scatter: Scatter,
    /// Standard deviation of set lengths that will be declared, mm.
    pub declared_length_mm: Option<f64>,
    /// Standard deviation of contracted lengths that will be declared, mm.
    pub declared_contracted_mm: Option<f64>,
}

impl Plan {
    /// Readings of the campaign.
    pub fn readings(&self) -> usize {
        let log = self.pressures_kpa.len() * if self.venting { 2 } else { 1 };
        self.rest_lengths_mm.len() * self.contractions.len() * self.runs * log
    }

    /// Median of the resting lengths, mm.
    pub fn middle_rest_length_mm(&self) -> f64 {
        let (all, n) = (&self.rest_lengths_mm, self.rest_lengths_mm.len());
        0.5 * (all[(n - 1) / 2] + all[n / 2])
    }

    /// Standard deviation of the contracted length of an actuator of this resting length, m.
    pub fn contracted_sd_m(&self, rest_length_m: f64) -> f64 {
        let expected = self.scatter.contracted * rest_length_m;
        let declared = self.declared_contracted_mm.map(|mm| 1e-3 * mm);
        declared.map_or(expected, |sd| sd.min(expected))
    }
}

/// Reads and checks the text of a plan; messages call it `file`.
///
/// # Errors
/// Every mistake of the file, in the order of its lines.
pub fn read(file: &str, text: &str) -> Result<Plan, Vec<Diagnostic>> {
    let table = parse(file, text).map_err(|d| vec![d])?;
    let reader = Reader::new(file, text);
    let root = reader.root(&table);
    let plan = plan(&root);
    root.close();
    let mistakes = reader.finish();
    match plan {
        Some(plan) if mistakes.is_empty() => Ok(plan),
        _ => Err(mistakes),
    }
}

/// A number from `low` to `high`.
fn within(entry: &Entry, (low, high): (f64, f64), unit: &str) -> Option<f64> {
    let number = entry.number()?;
    if (low..=high).contains(&number) {
        return Some(number);
    }
    let expected = format!("a number from {low} to {high} {unit}");
    entry.reject(expected.trim_end(), "check the unit");
    None
}

/// A list of at least `fewest` numbers, all different, in rising order.
fn numbers(
    root: &Section,
    key: &'static str,
    fewest: usize,
    range: (f64, f64),
    unit: &str,
) -> Option<Vec<f64>> {
    let expected = format!("a list of {fewest} or more numbers in {unit}");
    let entry = root.require(key, &expected, "`pipeline plan --example` prints one")?;
    let list = entry.list()?;
    let mut values = list
        .iter()
        .map(|e| within(e, range, unit))
        .collect::<Option<Vec<f64>>>()?;
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() < fewest {
        entry.reject(&expected, "fewer say nothing about others");
        return None;
    }
    Some(values)
}

fn plan(root: &Section) -> Option<Plan> {
    if let Some(entry) = root.require("schema", SCHEMA, "write schema = \"bpa-plan/1\"") {
        entry.choice(&[(SCHEMA, ())]);
    }
    let diameter = root.require(
        "diameter_mm",
        "10, 20 or 40",
        "a law is published for these",
    );
    let diameter_mm = diameter.and_then(|entry| {
        let whole = entry.integer().and_then(|d| u32::try_from(d).ok());
        let known = whole.filter(|d| new::published(*d, new::SYMBOLS).is_some());
        if known.is_none() {
            entry.reject("10, 20 or 40", "a law is published for these");
        }
        known
    });
    let rest = numbers(root, "rest_lengths_mm", 2, (20.0, 2000.0), "mm");
    let contraction_620 = root
        .require(
            "contraction_620",
            "a number from 0.05 to 0.4",
            "such as 0.165",
        )
        .and_then(|e| within(&e, (0.05, 0.4), ""));
    let contractions = numbers(root, "contractions", 1, (0.0, 1.1), "eps/eps_620");
    let pressures = numbers(root, "pressures_kpa", 2, (0.0, 1000.0), "kPa");
    let venting = root.get("venting").map_or(Some(true), |e| e.boolean());
    let runs = root.get("runs").map_or(Some(1), |entry| {
        let runs = entry.integer().and_then(|n| usize::try_from(n).ok());
        let runs = runs.filter(|n| (1..=20).contains(n));
        if runs.is_none() {
            entry.reject("a whole number from 1 to 20", "logs of a session");
        }
        runs
    });
    let scatter_of = root.get("scatter_of").and_then(|e| e.string());
    let table = root.get("scatter").and_then(|e| e.table());
    let scatter = table.map_or_else(Scatter::default, |t| scatter(&t, contraction_620));
    Some(Plan {
        diameter_mm: diameter_mm?,
        rest_lengths_mm: rest?,
        contraction_620: contraction_620?,
        contractions: contractions?,
        pressures_kpa: pressures?,
        venting: venting?,
        runs: runs?,
        scatter_of: scatter_of.filter(|c| !c.is_empty()),
        scatter,
        declared_length_mm: None,
        declared_contracted_mm: None,
    })
}

fn scatter(table: &Section, contraction_620: Option<f64>) -> Scatter {
    // Noted lengths that are off by more than a fifth of the stroke are no measurement of it; to three decimals, as the message has it.
    let contracted = (200.0 * contraction_620.unwrap_or(0.25)).floor() / 1e3;
    let mut scatter = Scatter::default();
    let all: [(&'static str, &mut f64, f64, &str); 7] = [
        ("gain", &mut scatter.gain, 1.0, ""),
        ("length_mm", &mut scatter.length_mm, 50.0, "mm"),
        ("contracted", &mut scatter.contracted, contracted, ""),
        ("zero_n", &mut scatter.zero_n, 200.0, "N"),
        ("common_misfit", &mut scatter.common_misfit, 0.5, ""),
        ("session_misfit", &mut scatter.session_misfit, 0.5, ""),
        ("noise_n", &mut scatter.noise_n, 200.0, "N"),
    ];
    for (key, value, most, unit) in all {
        let entry = table.get(key);
        if let Some(given) = entry.and_then(|e| within(&e, (0.0, most), unit)) {
            *value = given;
        }
    }
    table.close();
    scatter
}
