//! What a diagnosis says: `findings.json`, and everything that `residual.pdf` shows.

use serde::{Deserialize, Serialize};

/// Schema of `findings.json`.
pub const SCHEMA: &str = "bpa-findings/1";

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// [`SCHEMA`].
    pub schema: String,
    /// One entry a campaign and diameter.
    pub campaigns: Vec<CampaignFindings>,
}

/// The answer for one campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignFindings {
    /// Campaign id.
    pub campaign: String,
    /// The joint, where the campaign is one of torque: "pinned knee, flexor".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Uninflated inner diameter, mm.
    pub diameter_mm: u32,
    /// Whether it is simulated.
    pub simulated: bool,
    /// "isometric" or "knee-torque".
    pub kind: String,
    /// Id of the base model.
    pub base_model: String,
    /// Whether its coefficients were fitted here.
    pub base_refitted: bool,
    /// Unit of the errors.
    pub unit: String,
    /// What was found.
    pub verdict: Verdict,
    /// One sentence for it.
    pub summary: String,
    /// Readings, sessions and specimens that were searched, and readings that were held out.
    pub readings: usize,
    /// See `readings`.
    pub sessions: usize,
    /// See `readings`.
    pub specimens: usize,
    /// See `readings`.
    pub readings_held_out: usize,
    /// How the held-out error was made: "holdout" or "leave-one-specimen-out" (or session, log).
    pub held_out_by: String,
    /// The questions asked of the residual before anything was added.
    pub questions: Vec<Question>,
    /// The same questions of what the effects and empirical corrections leave.
    pub questions_after: Vec<Question>,
    /// The effects found, in the order in which they were found.
    pub effects: Vec<EffectFinding>,
    /// Columns on which the residual depends and that no effect explains.
    pub unexplained: Vec<Unexplained>,
    /// Sessions and specimens that the rest of the campaign does not predict: mistakes of recording rather than effects.
    pub suspects: Vec<Suspect>,
    /// Error of the base model.
    pub before: Errors,
    /// Error with the effects (and not with empirical corrections).
    pub after: Errors,
    /// Error with the effects that were found on all readings, only their sizes and the coefficients found anew without each held-out unit;
    /// none where nothing was found. Between this and `after` lies what the choice itself costs.
    pub after_as_chosen: Option<Errors>,
    /// Error with the effects and the empirical corrections; none where there are none.
    pub after_empirical: Option<Errors>,
    /// The same by held-out specimen.
    pub by_specimen: Vec<FoldErrors>,
    /// Standard deviation of repeated readings, N.
    pub noise_floor: Option<f64>,
    /// Held-out error of a smooth black box on the residual of the base model, N.
    pub black_box_rmse_heldout: Option<f64>,
    /// The same on the residual after the effects.
    pub black_box_after_rmse_heldout: Option<f64>,
    /// Candidates that were looked at and not taken, best first.
    pub rejected: Vec<Rejected>,
    /// The smallest size of every effect that this campaign could have shown.
    pub detection_limits: Vec<DetectionLimit>,
    /// Effects that this design cannot show at all.
    pub not_measurable: Vec<NotMeasurable>,
    /// Pairs of effects that this design cannot tell apart, with the cosine between their traces.
    pub aliases: Vec<Alias>,
    /// The model with and without parts of its base.
    pub readings_of_the_base: Vec<Reading>,
    /// Coefficients of the base model before and after.
    pub coefficients: Vec<CoefficientChange>,
    /// What to measure next.
    pub next_measurement: Vec<NextMeasurement>,
    /// Remarks on the data or the search.
    pub notes: Vec<String>,
}

/// The three answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// At least one effect of the library.
    EffectFound,
    /// No structure beyond noise.
    None,
    /// Structure that no effect accounts for.
    Unexplained,
}

/// One question: does the residual depend on this column?
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Question {
    /// Column.
    pub column: String,
    /// What was permuted: "readings within logs", "sessions", "specimens".
    pub blocks: String,
    /// Share of the residual's sum of squares that the column explains.
    pub share: f64,
    /// Probability of as much by chance, by permutation.
    pub p: f64,
    /// Corrected for the number of questions (Holm).
    pub p_adjusted: f64,
}

/// An effect that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectFinding {
    /// Id.
    pub id: String,
    /// Name for a reader.
    pub title: String,
    /// Equation of the form.
    pub equation: String,
    /// Name of the form.
    pub form: String,
    /// It and every effect that this campaign cannot tell from it.
    pub class: Vec<String>,
    /// "global", "session" or "specimen".
    pub scope: String,
    /// Where exactly, in words: "all readings", "session x", "sessions from x on".
    pub acts_on: String,
    /// Its numbers.
    pub parameters: Vec<ParameterFinding>,
    /// Probability of its t by chance, times the number of candidates.
    pub p_adjusted: f64,
    /// Part of the resamples of specimens in which it (or its class) was chosen again.
    pub selected_in_resamples: f64,
    /// Part of the outer folds (see `by_specimen`) whose own search chose it.
    pub selected_in_folds: f64,
    /// Part of the folds in which it lowers the held-out error.
    pub helps_in_folds: f64,
    /// Training error without it, the others kept, N.
    pub rmse_before: f64,
    /// Training error with it, N.
    pub rmse_after: f64,
    /// Held-out error without it and with it, strength of the held-out specimen taken off, N.
    pub rmse_heldout_before: f64,
    /// See `rmse_heldout_before`.
    pub rmse_heldout_after: f64,
    /// Gain in the criterion, effective readings.
    pub criterion_gain: f64,
    /// Source.
    pub source: String,
    /// What would measure it apart from the force.
    pub measurement: String,
}

/// A parameter with its interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterFinding {
    /// Symbol.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Lower end of the 95% interval.
    pub ci_low: f64,
    /// Upper end.
    pub ci_high: f64,
    /// Unit.
    pub unit: String,
}

/// A column that explains what no effect does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unexplained {
    /// Column.
    pub column: String,
    /// How the force depends on it, empirically: "gain" or "offset".
    pub shape: String,
    /// Probability, corrected.
    pub p_adjusted: f64,
    /// Share of the residual's sum of squares that it explains.
    pub share_of_residual: f64,
    /// Held-out error before and after the empirical correction, N.
    pub rmse_heldout_before: Option<f64>,
    /// See `rmse_heldout_before`.
    pub rmse_heldout_after: Option<f64>,
    /// The correction as a curve: value of the column, N (or share of the force for a gain).
    pub curve: Vec<(f64, f64)>,
}

/// A session or specimen that the rest of the campaign does not predict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// "session x", "specimen y" or "the whole campaign".
    pub what: String,
    /// RMS of measured less predicted from all others, N.
    pub error_n: f64,
    /// Median of the same over all sessions (specimens), N.
    pub usual_n: f64,
    /// The usual mistake that would explain it best.
    pub explanation: String,
    /// Error if it were so, N; none where nothing explains it.
    pub error_then_n: Option<f64>,
    /// Whether its readings took no part in the search.
    pub set_aside: bool,
}

/// Errors of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// On the readings it was fitted to, strengths of the specimens taken for the mean, N.
    pub rmse_train: f64,
    /// On readings that took no part, N.
    pub rmse_heldout: f64,
    /// Largest of them, N.
    pub max_abs_error_heldout: f64,
    /// Held-out error with the strength that each held-out specimen shows itself, N: how strong it is does not count.
    pub rmse_heldout_own_strength: f64,
}

/// Errors of one held-out unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoldErrors {
    /// The specimen (or session, log) that was held out.
    pub unit: String,
    /// Readings of it.
    pub readings: usize,
    /// RMSE of the base model, N.
    pub before: f64,
    /// With the effects that were chosen without it, N.
    pub after: f64,
    /// Of the black box on the base model's residual, N.
    pub black_box: Option<f64>,
    /// The effects that were chosen without it.
    pub chosen: Vec<String>,
}

/// A candidate that was not taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    /// Id, or the column of an empirical dependence.
    pub id: String,
    /// Name of the form; none for an empirical dependence.
    pub form: Option<String>,
    /// Where it would act.
    pub acts_on: String,
    /// Share of the remaining sum of squares that it would explain.
    pub share: f64,
    /// Why not.
    pub why: String,
}

/// The smallest size that would have been found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetectionLimit {
    /// Id.
    pub id: String,
    /// Form.
    pub form: String,
    /// Size.
    pub smallest: f64,
    /// Unit.
    pub unit: String,
    /// Share of its trace that a refit of the base model leaves.
    pub visible: f64,
}

/// An effect that this campaign cannot show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotMeasurable {
    /// Id.
    pub id: String,
    /// Why.
    pub why: String,
}

/// Two effects with one trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alias {
    /// Ids.
    pub ids: [String; 2],
    /// Cosine between their traces after the refit.
    pub cosine: f64,
}

/// The base model with or without one of its parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// In words.
    pub model: String,
    /// Fitted parameters of base and effects.
    pub parameters: usize,
    /// Errors.
    pub errors: Errors,
    /// Strongest numbers, in words: "C = 8.9 um/N".
    pub numbers: Vec<String>,
}

/// A coefficient of the base model before and after the effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoefficientChange {
    /// Symbol.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Base model alone.
    pub before: f64,
    /// With the effects.
    pub after: f64,
    /// Interval after, 95%.
    pub ci_low: f64,
    /// See `ci_low`.
    pub ci_high: f64,
    /// Published value.
    pub published: Option<f64>,
    /// Remark: at its bound, interval open.
    pub remark: String,
}

/// What would decide.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NextMeasurement {
    /// Ids, or two readings of the data.
    pub separates: Vec<String>,
    /// What to do.
    #[serde(rename = "do")]
    pub action: String,
    /// Difference of the two predictions there, N.
    pub difference_n: Option<f64>,
}

/// The residual for figures: one entry a reading.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Session, specimen ids.
    pub session: Vec<String>,
    /// See `session`.
    pub specimen: Vec<String>,
    /// Measured less base model, N.
    pub before: Vec<f64>,
    /// Measured less model with effects, N.
    pub after: Vec<f64>,
    /// Predicted by the base model, N.
    pub predicted: Vec<f64>,
    /// The columns of the questions by name, one value a reading.
    pub columns: Vec<(String, Vec<f64>)>,
}
