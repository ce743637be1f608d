//! What is kept of a search: one line of the log.

use serde::{Deserialize, Serialize};

/// The smallest effect, or dependence on a column, that a campaign could have shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Id, or column.
    pub id: String,
    /// Form, or shape.
    pub form: String,
    /// Amplitude, or change over the range of the column; none where it could have shown none.
    pub smallest: Option<f64>,
}

/// The size of what was put in.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Size {
    /// Amplitude of each effect, in the unit of the findings.
    pub amplitudes: Vec<f64>,
    /// The findings have no limit for it, so the generating model's stands in.
    pub generating_limit: bool,
    /// The size asked for is absurd; the largest that is not was taken.
    pub capped: bool,
}

/// Whether an interval covers what was put in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Covered {
    /// The interval of the effect, where it was found in the form that was put in.
    pub found: Option<bool>,
    /// Where it was not found, the estimate of the first step with 1.96 standard errors.
    pub not_found: Option<bool>,
}

/// What came of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Verdict, as in `findings.json`.
    pub verdict: String,
    /// Effects that were found and are not negligible: id and class.
    pub found: Vec<Vec<String>>,
    /// Columns that explain what no effect does.
    pub columns: Vec<String>,
    /// Sessions and specimens pointed at as recording errors.
    pub pointed: Vec<String>,
    /// All that was put in was found, in its class.
    pub detected: bool,
    /// It was, and nothing else.
    pub exact: bool,
    /// Effects with a name that nobody put in.
    pub wrong_names: usize,
    /// The size of what was put in.
    pub size: Size,
    /// Whether intervals cover it.
    pub covered: Covered,
    /// Log density of held-out readings, a reading, less the generating model's.
    pub log_density_gap: Option<f64>,
    /// Error on unseen specimens after the effects, N.
    pub rmse: Option<f64>,
    /// The same over that of the campaign without the effect.
    pub error_ratio: Option<f64>,
    /// Estimated over true standard deviation of set length and of gain.
    pub scatter_ratios: [Option<f64>; 2],
    /// Smallest family-wise p of the first step.
    pub smallest_p: Option<f64>,
    /// Share of held-out readings inside their 50% and 95% intervals.
    pub inside: [Option<f64>; 2],
    /// Specimens.
    pub specimens: usize,
    /// Detection limits, of campaigns without an effect.
    pub limits: Vec<Limit>,
    /// Time of the search, s.
    pub seconds: f64,
}

impl Outcome {
    /// What was found, in few words.
    pub fn text(&self) -> String {
        let effects = self.found.iter().map(|f| f[0].clone());
        let columns = self.columns.iter().map(|c| format!("?{c}"));
        let pointed = self.pointed.iter().map(|_| "!recording".to_owned());
        let mut list: Vec<String> = effects.chain(columns).chain(pointed).collect();
        list.sort();
        if list.is_empty() {
            return "nothing".to_owned();
        }
        list.join(" + ")
    }
}
