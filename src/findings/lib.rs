#![warn(missing_docs)]
//! What the loop says: `findings.json` (schema `bpa-findings/2`), as values. Sentences are made of them by the report and the command
//! line, and nothing reads a sentence back.
//!
//! Numbers are in the unit that stands beside them: N for isometric campaigns, N.m for torque, unless a field says otherwise.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Schema of `findings.json`.
pub const SCHEMA: &str = "bpa-findings/2";

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// [`SCHEMA`].
    pub schema: String,
    /// One entry a campaign and diameter, a pool of them, or a joint.
    pub campaigns: Vec<CampaignFindings>,
}

/// The answer for one campaign, pool or joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignFindings {
    /// Campaign id; of a pool "pooled-10mm".
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
    /// How much was searched.
    pub design: Design,
    /// What was found.
    pub verdict: Verdict,
    /// Why nothing could be said; only with [`Verdict::NotAssessed`].
    pub not_assessed: Option<NotAssessed>,
    /// Effects that have one value for what they act on, strongest first.
    pub effects: Vec<EffectFinding>,
    /// What varies from group to group: the random effects of the model.
    pub scatter: Vec<Scatter>,
    /// What the contractions noted at 620 kPa are worth; none of torque, and where all are declared or noted alike.
    #[serde(default)]
    pub noted_contractions: Option<NotedContractions>,
    /// How far the law itself is from right; none where the mixed model was not fitted.
    pub misfit: Option<Misfit>,
    /// Columns that explain what no effect does.
    pub unexplained: Vec<Unexplained>,
    /// Sessions, specimens and tests that the model fitted without them makes too improbable.
    pub recording_errors: Vec<RecordingError>,
    /// Errors of the model without effects.
    pub before: Errors,
    /// Errors with them.
    pub after: Errors,
    /// The same, one held-out specimen (actuator) at a time.
    pub by_unit: Vec<UnitErrors>,
    /// What the expected squared error on an unseen specimen is made of; the variances add up.
    pub budget: Vec<BudgetEntry>,
    /// Root of the budget's sum; none where there is no budget.
    pub expected_rmse_heldout: Option<f64>,
    /// Share of held-out readings inside their 50% interval.
    pub inside_50: Option<f64>,
    /// Share of held-out readings inside their 95% interval.
    pub inside_95: Option<f64>,
    /// Histogram of the probability integral transform of the held-out readings, ten equal bins, as shares.
    pub pit: Vec<f64>,
    /// Standard deviation of a reading, everything else known; none where it was not estimated.
    pub noise: Option<f64>,
    /// Noise that is correlated in time, which the search takes for independent; none where the readings show none, and of torques.
    pub noise_in_time: Option<NoiseInTime>,
    /// Held-out error of a smooth black box on the residual of the base model, both fitted without what was held out.
    pub black_box_rmse_heldout: Option<f64>,
    /// What was tested at the first step, strongest first: one entry an effect's form or a column.
    pub tested: Vec<Tested>,
    /// The smallest amplitude of every effect that this campaign could have shown in 80 of 100 cases.
    pub detection_limits: Vec<DetectionLimit>,
    /// The smallest dependence on a column that it could have shown in as many; of forces alone.
    #[serde(default)]
    pub column_limits: Vec<ColumnLimit>,
    /// Effects that this design cannot show at all.
    pub not_measurable: Vec<NotMeasurable>,
    /// Pairs of effects with nearly one sensitivity.
    pub aliases: Vec<Alias>,
    /// What to measure next, best first.
    pub next_measurement: Vec<NextMeasurement>,
    /// Coefficients of the base model before and after.
    pub coefficients: Vec<CoefficientChange>,
    /// The law with and without its parts, side by side: what a length law, a frame and the shape of the ends explain of one another.
    pub alternatives: Vec<Alternative>,
}

impl CampaignFindings {
    /// Of a campaign of which nothing is said yet, not even its name.
    pub fn unassessed(design: Design) -> Self {
        Self {
            campaign: String::new(),
            part: None,
            diameter_mm: 0,
            simulated: false,
            kind: String::new(),
            base_model: String::new(),
            base_refitted: false,
            unit: String::new(),
            design,
            verdict: Verdict::NotAssessed,
            not_assessed: None,
            effects: Vec::new(),
            scatter: Vec::new(),
            noted_contractions: None,
            misfit: None,
            unexplained: Vec::new(),
            recording_errors: Vec::new(),
            before: Errors::default(),
            after: Errors::default(),
            by_unit: Vec::new(),
            budget: Vec::new(),
            expected_rmse_heldout: None,
            inside_50: None,
            inside_95: None,
            pit: Vec::new(),
            noise: None,
            noise_in_time: None,
            black_box_rmse_heldout: None,
            tested: Vec::new(),
            detection_limits: Vec::new(),
            column_limits: Vec::new(),
            not_measurable: Vec::new(),
            aliases: Vec::new(),
            next_measurement: Vec::new(),
            coefficients: Vec::new(),
            alternatives: Vec::new(),
        }
    }

    /// The error on unseen units of the model that is the answer: with what was found, and without effects where nothing was, whatever the searches
    /// without one unit found.
    pub fn rmse_of_answer(&self) -> Option<f64> {
        self.errors_of_answer()
            .rmse_heldout
            .or(self.before.rmse_heldout)
    }

    /// All errors of that model.
    pub fn errors_of_answer(&self) -> &Errors {
        if self.effects.is_empty() && self.unexplained.is_empty() {
            &self.before
        } else {
            &self.after
        }
    }

    /// The standard deviation that predictions take of what varies from group to group, by its id, in its unit.
    pub fn scatter_sd(&self, id: &str) -> Option<f64> {
        let found = self.scatter.iter().find(|s| s.id == id);
        found.map(|s| s.sd_predictive)
    }

    /// Standard deviation of the contracted length of a specimen of this resting length, mm, beside its rounding where it is not declared.
    pub fn contracted_sd_mm(&self, rest_length_mm: f64) -> f64 {
        let found = self.scatter.iter().find(|s| s.id == "contracted_length");
        let of = |s: &Scatter| {
            let share = s.share_of_rest_length;
            share.map_or(s.sd_predictive, |share| share * rest_length_mm)
        };
        found.map_or(0.0, of)
    }
}

/// How much was searched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Design {
    /// Readings in the search.
    pub readings: usize,
    /// Readings for which the base model has no value: outside its domain.
    pub readings_outside_domain: usize,
    /// Sessions (tests) in the search.
    pub sessions: usize,
    /// Specimens (actuators) in the search.
    pub specimens: usize,
    /// Readings of sessions with the role `holdout`.
    pub readings_held_out: usize,
    /// What the held-out errors are of.
    pub held_out_by: HeldOutBy,
    /// Whether there are none but tests that their owner doubts, which were then searched by themselves.
    pub doubtful_only: bool,
    /// How sure the draws and this number of specimens (actuators) can make anyone.
    pub smallest_p: SmallestP,
}

/// The smallest probabilities that a design allows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SmallestP {
    /// Family-wise, by the bootstrap: 1/(draws + 1). A decision that the draws leave open is made with more of them.
    pub familywise: f64,
    /// That all specimens (actuators) agree in the sign of an effect by chance, two-sided: 2^(1 - K) of K. None of a single one.
    pub signs: Option<f64>,
}

impl SmallestP {
    /// Of a bootstrap with so many draws, and so many specimens (actuators).
    pub fn of(draws: usize, units: usize) -> Self {
        Self {
            familywise: 1.0 / (draws + 1) as f64,
            signs: (units > 1).then(|| (1..units).fold(1.0, |p, _| 0.5 * p)),
        }
    }
}

/// What the held-out errors are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldOutBy {
    /// Sessions with the role `holdout`.
    Holdout,
    /// Each specimen in turn, the whole search without it.
    Specimen,
    /// Groups of specimens in turn, where there are many.
    SpecimenGroups,
    /// Each actuator of a joint in turn.
    Actuator,
    /// Nothing: there is one specimen only.
    None,
}

/// The answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// At least one effect of the library; structure without a name may be left beside it (`unexplained`).
    EffectFound,
    /// No structure beyond noise, scatter and the declared misfit.
    None,
    /// Structure that no effect accounts for.
    Unexplained,
    /// Too little to go by.
    NotAssessed,
}

/// Why nothing could be said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NotAssessed {
    /// Fewer readings than the model has parameters to spare for.
    TooFewReadings,
    /// Fewer than two specimens (actuators).
    TooFewSpecimens,
    /// The fit of the null model did not converge.
    NoConvergence,
}

/// On what the one value of an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ActsOn {
    /// Every reading.
    All,
    /// One level of a column of labels: a value for each level but the first.
    Levels,
    /// The sessions from a change point on.
    From,
}

/// An effect that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectFinding {
    /// Id.
    pub id: String,
    /// The alias set: it and every effect that this campaign cannot tell from it.
    pub class: Vec<String>,
    /// Where it acts.
    pub acts_on: ActsOn,
    /// The column of labels, where it acts on levels.
    pub column: Option<String>,
    /// The level on which it does not act, beside which the others have their values.
    pub reference_level: Option<String>,
    /// The first session that it acts on, where it acts from a change point on.
    pub from: Option<String>,
    /// Its numbers, amplitude first.
    pub parameters: Vec<Parameter>,
    /// Name of the form: "linear", "constant", …
    pub form: String,
    /// Equation of the form.
    pub equation: String,
    /// Probability, under the model without it, of a candidate as strong as this anywhere.
    pub p_familywise: f64,
    /// Gain in marginal log-likelihood, variances estimated again; none where no likelihood was computed.
    pub log_likelihood_gain: Option<f64>,
    /// Share of the searches without one fold that found it again, or else a member of its class that stands for no other effect; none where
    /// nothing was held out.
    pub found_in_folds: Option<f64>,
    /// Whether it is smaller than the smallest effect of interest: it then changes no verdict.
    pub negligible: bool,
    /// Root mean square of what it does to the readings that it acts on.
    pub rms: f64,
    /// Each specimen's (actuator's) own estimate of the amplitude, where it has one: a description, no test.
    pub by_specimen: BTreeMap<String, Estimate>,
    /// Profile of the marginal likelihood: amplitude, log-likelihood less its largest.
    pub profile: Vec<(f64, f64)>,
    /// Whether one number is enough for its size; none where it has no argument of its own, or where that hardly varies.
    pub free_form: Option<FreeForm>,
    /// Likelihood of each member of the class in its place: id, log-likelihood less that of the effect.
    pub in_its_place: Vec<(String, f64)>,
    /// Columns a dependence on which explains the readings as well.
    pub explained_as_well_by: Vec<String>,
    /// What would measure it apart from the readings.
    pub measurement: String,
    /// Where it is described.
    pub source: String,
}

/// An estimate with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
}

/// The amplitude of an effect as a smooth function of its own argument.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeForm {
    /// The argument: "force_n", "pressure_kpa", …
    pub argument: String,
    /// Its unit.
    pub unit: String,
    /// Gain in restricted log-likelihood over one number for all readings.
    pub log_likelihood_gain: f64,
    /// Probability, where one number is right for all effects of the campaign, of as large a gain of any of them.
    pub p: f64,
    /// Whether `p` is below the level of the loop: the size changes along the argument.
    pub differs: bool,
    /// The amplitude over the range of the argument.
    pub curve: Vec<FormPoint>,
}

/// The amplitude of an effect at one value of its argument.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormPoint {
    /// The argument.
    pub at: f64,
    /// The amplitude, in the unit of the first parameter.
    pub amplitude: f64,
    /// Lower end of its 95% interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A parameter with its 95% interval; an end that is `null` is unbounded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Symbol.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Lower end.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
    /// Unit.
    pub unit: String,
    /// The level of `column` whose value it is, of an effect that acts on levels: beside `reference_level`.
    pub of_level: Option<String>,
}

/// The level of a random effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// A campaign of a pool.
    Campaign,
    /// A physical actuator, isometric.
    Specimen,
    /// One set-up.
    Session,
    /// One log of a session.
    Log,
    /// An actuator about a knee.
    Actuator,
    /// One set-up about a knee.
    Test,
}

/// A random effect with its standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Id of the effect whose operator it is: `length_offset`, `specimen_variation`, `force_zero_offset`, …; or `rest_length`; or `contracted_length`,
    /// whose standard deviation, where not declared, is proportional to the resting length, rounding apart: `sd` is its value at the median resting length.
    pub id: String,
    /// What has a value of its own.
    pub level: Level,
    /// Standard deviation: the largest restricted likelihood times the prior of its scale, which may hold it below what the values of a few groups show.
    pub sd: f64,
    /// Standard deviation with which unseen groups are predicted: never 0 because a handful of groups happen to be alike.
    pub sd_predictive: f64,
    /// The same as a share of the resting length, where it is proportional to that.
    pub share_of_rest_length: Option<f64>,
    /// Lower end of its 95% interval.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Standard deviation that was declared. It is not estimated unless the readings contradict it.
    pub declared: Option<f64>,
    /// Whether the readings contradict the declared value (probability below the level of the loop). Declared set lengths are then estimated.
    pub declared_contradicted: bool,
    /// Gain in log-likelihood over a model without it; none where it was declared, or taken as usual (lengths that are recorded in whole mm).
    pub log_likelihood_gain: Option<f64>,
    /// Predicted value of each group.
    pub values: BTreeMap<String, f64>,
}

/// What the contractions at 620 kPa that were noted are worth: an actuator is taken to have `mean + (1 - error) (noted - mean)`, and scatters about that
/// by `share_of_rest_length` of the scatter `contracted_length`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotedContractions {
    /// Number of specimens whose contracted length is noted and not declared, held-out ones included.
    pub specimens: usize,
    /// Mean of what was noted.
    pub mean: f64,
    /// Standard deviation of what was noted.
    pub sd: f64,
    /// Share of what the noted contractions differ by that is an error of noting, as the forces show it: 0 believes what was noted, 1 gives all specimens
    /// the mean. Its prior is normal, 0.5 with the standard deviation 0.5.
    pub error: f64,
    /// Standard deviation of that share.
    pub error_sd: f64,
}

impl NotedContractions {
    /// The contraction at 620 kPa of an actuator of which so much is noted.
    pub fn taken(&self, noted: f64) -> f64 {
        noted - self.error * (noted - self.mean)
    }
}

/// The smooth misfit of the law, as shares of the force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Misfit {
    /// Common to all specimens, over eps* and P*.
    pub common: f64,
    /// Of each session, along the pressure.
    pub session: f64,
    /// Of each stroke (the filling or the venting of one log), along the pressure; none where the readings show none.
    pub stroke: Option<f64>,
    /// Ids of effects, or columns, whose place in the answer changes where the prior scales are halved or doubled.
    pub sensitive: Vec<String>,
}

/// Noise that is correlated in time within a stroke (the filling or the venting of one log), or a misfit of the law finer than the model has, and what was
/// found beside it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NoiseInTime {
    /// Standard deviation of what the force wanders by, N.
    pub sd: f64,
    /// Standard deviation of a reading beside it, N.
    pub noise: f64,
    /// Gain in log-likelihood over the model of the search.
    pub log_likelihood_gain: f64,
    /// What was found: effects and columns, fitted again beside it.
    pub beside: Vec<BesideNoise>,
}

/// An effect or a column where noise is correlated in time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BesideNoise {
    /// Id, or column.
    pub id: String,
    /// First parameter of the effect; none of a column.
    pub value: Option<f64>,
    /// Lower end of its 95% interval, by its standard error; none where it has come to its bound.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
    /// Gain in log-likelihood, beside what stands; of what does not, beside that and what fell after it.
    pub log_likelihood_gain: f64,
    /// Whether it would have come in.
    pub stands: bool,
}

/// A column that explains what no effect does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unexplained {
    /// Column.
    pub column: String,
    /// "gain" (share of the force) or "offset" (N).
    pub shape: String,
    /// Probability of a candidate as strong as this anywhere.
    pub p_familywise: f64,
    /// Gain in marginal log-likelihood; none where no likelihood was computed.
    pub log_likelihood_gain: Option<f64>,
    /// Share of the variance of what the model without it leaves.
    pub share_of_variance: f64,
    /// Columns, and ids of effects, that explain the readings as well in its place.
    pub explained_as_well_by: Vec<String>,
    /// The empirical correction: value of the column, correction. A zero of the force that was found beside an offset is in it.
    pub curve: Vec<(f64, f64)>,
}

/// What kind of mistake a recording error looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorKind {
    /// A set, resting or contracted length.
    Length,
    /// Force and pressure exchanged.
    SwappedColumns,
    /// A column in another unit: the factor is `value`.
    Unit,
    /// A column with the wrong sign.
    Sign,
    /// The zero of a channel.
    Zero,
    /// Far off, and none of the others explains it.
    Outlier,
}

/// A recording error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordingError {
    /// Id of the session, specimen or test.
    pub group: String,
    /// What it is.
    pub level: Level,
    /// What it looks like.
    pub kind: ErrorKind,
    /// The column or quantity concerned: "length", "rest_length", "force", "pressure", …
    pub quantity: Option<String>,
    /// Its size: true less recorded, or the factor of a unit; of exchanged columns the zero of the force that is then left.
    pub value: Option<f64>,
    /// Unit of `value`.
    pub unit: String,
    /// Probability under the model fitted without the group (about a knee: of the ratio of its mean square to that of the others); none where
    /// it was not computed.
    pub p: Option<f64>,
    /// RMS of its readings about that model.
    pub rms: f64,
    /// The same with the mistake taken back; none where no kind explains it.
    pub rms_corrected: Option<f64>,
    /// Whether its readings took no part in the rest. Of a `muscle_length` or `moment_arm` measured by hand it means these lengths or arms alone:
    /// the torques of the test take part.
    pub set_aside: bool,
}

/// Errors of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// On the readings it was fitted to, with what all share (campaigns of a pool their gain and zero) and nothing of specimens and sessions; none for a unit
    /// that was held out.
    pub rmse_train: Option<f64>,
    /// On readings that took no part, random effects 0; none with one specimen.
    pub rmse_heldout: Option<f64>,
    /// Largest of them.
    pub max_abs_error_heldout: Option<f64>,
    /// With the gain, the lengths and the zeros of the held-out specimen as estimated from all its readings, law and effects as they were fitted without
    /// it: in sample in these.
    pub rmse_heldout_calibrated: Option<f64>,
    /// After the first 1, 2, 3, 5 readings of each session in time order, scored on the others.
    pub rmse_heldout_after: BTreeMap<String, f64>,
    /// After 1, 2, 3, 5 readings of each session spread over it, scored on the others: the one of which the largest force (torque) is expected, and
    /// evenly spaced ones below it.
    #[serde(default)]
    pub rmse_heldout_spread: BTreeMap<String, f64>,
    /// Joint log predictive density of the held-out readings of a specimen, summed over specimens, a reading.
    pub log_density_heldout: Option<f64>,
}

/// Errors of one held-out unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitErrors {
    /// The specimen (group of specimens, actuator).
    pub unit: String,
    /// Readings of it.
    pub readings: usize,
    /// Errors of the model without effects.
    pub before: Errors,
    /// With the effects that were found without it.
    pub after: Errors,
    /// Mean squared error over the expected one: 1 where the model knows how wrong it is; none without predictive distribution.
    pub realised_over_expected: Option<f64>,
    /// Share of its readings inside their 95% interval; none without predictive distribution.
    pub inside_95: Option<f64>,
    /// The effects that were found without it.
    pub found: Vec<String>,
}

/// One source of the expected squared error on an unseen specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BudgetEntry {
    /// "set_length", "specimen_gain", "force_zero", "specimen_lengths", "contracted_length", "common_misfit", "session_misfit", "stroke_misfit", "estimation", "noise", …
    pub source: String,
    /// Mean variance, unit squared.
    pub variance: f64,
    /// Its root.
    pub rmse: f64,
    /// Unit of `rmse`.
    pub unit: String,
}

/// A candidate at the first step of the search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tested {
    /// Id of an effect, or name of a column.
    pub id: String,
    /// Whether `id` is a column.
    pub is_column: bool,
    /// Form that did best.
    pub form: String,
    /// Where it acts, in the best case.
    pub acts_on: ActsOn,
    /// Gain in log-likelihood.
    pub log_likelihood_gain: f64,
    /// Amplitude (linearised), in `unit`; none for a column.
    pub amplitude: Option<f64>,
    /// Unit of the amplitude.
    pub unit: String,
    /// Probability of a candidate as strong as this anywhere.
    pub p_familywise: f64,
}

/// The smallest amplitude that would have been found in 80 of 100 campaigns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetectionLimit {
    /// Id.
    pub id: String,
    /// Form.
    pub form: String,
    /// Amplitude.
    pub smallest: f64,
    /// Unit.
    pub unit: String,
    /// Share of its whitened sensitivity that the fitted coefficients leave.
    pub identifiable_share: f64,
}

/// The smallest straight dependence on a column that would have been found in 80 of 100 campaigns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColumnLimit {
    /// Name of the column.
    pub column: String,
    /// "gain" (a share of the force) or "offset".
    pub shape: String,
    /// Change from the smallest to the largest value of the column; none where no possible one would have been found.
    pub smallest: Option<f64>,
    /// Unit of `smallest`.
    pub unit: String,
}

/// Why a design cannot show an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WhyNot {
    /// The coefficients of the law, or accepted effects, take all of its sensitivity (`by`).
    Absorbed,
    /// A quantity that it needs was not recorded, or is the same in all readings (`by`: `direction`, `later_fillings`, `log_time`, `campaign_time`,
    /// `since_step`, `pressure_rate`, `temperature`, `cycles`, `rest_lengths`, `zeros`; of a joint a column).
    NoColumn,
    /// Its smallest detectable amplitude lies beyond what is physically possible.
    Bound,
    /// It changes none of these readings: the conditions under which it acts do not occur (`by`: the column that would have to vary).
    NoTrace,
}

/// An effect that this campaign cannot show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotMeasurable {
    /// Id.
    pub id: String,
    /// Form, where it is this form alone.
    pub form: Option<String>,
    /// Why.
    pub reason: WhyNot,
    /// The coefficient or effect that absorbs it, or the quantity that is missing.
    pub by: Option<String>,
}

/// Two effects with nearly one sensitivity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alias {
    /// Ids.
    pub ids: [String; 2],
    /// Cosine between their whitened, projected sensitivities.
    pub cosine: f64,
}

/// What a next measurement is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NextKind {
    /// It separates the members of an alias set.
    Separate,
    /// It makes a set-up quantity known better.
    Precision,
    /// More specimens.
    Specimens,
    /// More set points on the specimens there are.
    SetPoints,
}

/// What to measure next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NextMeasurement {
    /// What for.
    pub kind: NextKind,
    /// Ids of the effects that it separates; or the sources of error that it makes known: "set_length", or "specimen_lengths" with "contracted_length".
    pub separates: Vec<String>,
    /// The conditions: quantity with its unit -> value ("pressure_kpa": 450, "sd_mm": 0.2, "specimens": 4; "direction": 1 while filling, -1 while venting).
    pub at: BTreeMap<String, f64>,
    /// What it is worth: by how much the expected held-out error falls; or, where it separates, the expected gain in log-likelihood; none where
    /// that was not computed. The pages omit the former where errors on unseen units contradict the expected one.
    pub worth: Option<f64>,
    /// Unit of `worth`: that of the errors, or "1".
    pub unit: String,
}

/// A coefficient of the base model before and after the effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoefficientChange {
    /// Symbol.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Without effects.
    pub before: f64,
    /// With them.
    pub after: f64,
    /// Standard error after.
    pub standard_error: f64,
    /// Published value.
    pub published: Option<f64>,
    /// Whether the fit with effects ended at a bound.
    pub at_bound: bool,
    /// Whether the one without them did.
    pub before_at_bound: bool,
    /// Whether the effects took its place: `after` is then where the law has none of it, and no reading was used for that.
    #[serde(default)]
    pub left_out: bool,
}

/// The part of [`Alternative`] that is the law's own dependence on the resting length.
pub const LENGTH_LAW: &str = "length_law";

/// The law with or without one of its parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Parts: "length_law", and ids of effects. None: neither.
    pub parts: Vec<String>,
    /// Fitted coefficients and amplitudes.
    pub parameters: usize,
    /// Marginal log-likelihood less that of the first entry, of the readings alone: what is published of the dependence on the resting length counts for
    /// nothing.
    pub log_likelihood: f64,
    /// Held-out error with these parts fixed, random effects 0.
    pub rmse_heldout: Option<f64>,
    /// Log predictive density a held-out reading.
    pub log_density_heldout: Option<f64>,
    /// Amplitudes and coefficients of the parts: name, value, unit.
    pub numbers: Vec<Parameter>,
}

/// The residual for figures: one entry a reading of the search.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Session ids.
    pub session: Vec<String>,
    /// Specimen ids.
    pub specimen: Vec<String>,
    /// Measured less predicted without effects, random effects of groups 0; of forces with the misfit that all specimens share.
    pub before: Vec<f64>,
    /// The same with effects.
    pub after: Vec<f64>,
    /// Measured less predicted with effects and predicted random effects.
    pub conditional: Vec<f64>,
    /// Measured less predicted without effects, by a fit without the reading's unit; NaN where it was not held out.
    #[serde(default)]
    pub unseen_before: Vec<f64>,
    /// The same with the effects that the search without the unit found.
    #[serde(default)]
    pub unseen: Vec<f64>,
    /// Predicted without effects.
    pub predicted: Vec<f64>,
    /// The columns that were tested, and of a joint the knee angle before them, by name, one value a reading.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Log file of each reading, within its session.
    #[serde(default)]
    pub log: Vec<String>,
    /// First line of the log that entered each reading.
    #[serde(default)]
    pub row: Vec<i64>,
    /// What is left as in `after`, with the effects one after the other, in the order of the findings, then the columns that explain what no effect
    /// does: id or name of what came in last, one value a reading.
    #[serde(default)]
    pub steps: Vec<(String, Vec<f64>)>,
}
