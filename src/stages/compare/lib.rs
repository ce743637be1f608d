#![warn(missing_docs)]
//! Compare: every model on the same rows, with the honest statistics.
//!
//! The new model as fitted is judged on the rows it was fitted to (`train`, RMSE over n - p), on each specimen by the fit that has not
//! seen it (`loso`, leave one specimen out), on what its owner held out, and by the force paper's split by row (`rows_train`,
//! `rows_validation`: a fit to four fifths of each session's rows). A published model has seen none of the rows, so p is 0 and all its
//! splits are predictions. Models that answer different readings cannot be ranked by these: `common` has the errors of all on the readings that
//! the new model, Hunt's and the Festo tool all answer, the new model by the fits that have not seen them. Where a model has no answer the row is not counted for it (`n_excluded`); where it
//! answers beyond what it was fitted to, the row counts and is said so (`n_extrapolated`).

pub mod maxima;

use maxima::MaximaComparison;
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_config::{CompareOptions, FitOptions};
use pipeline_fit::equations::{JOINT, joint_force};
use pipeline_fit::split::{self, Part};
use pipeline_fit::{Group, GroupFit, is_fitted, is_usable};
use pipeline_mechanics::models::{Direction, ForceModel, Prediction, State, gate, published};
use pipeline_numerics::statistics::GoodnessOfFit;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// Id of the new model with the coefficients fitted here.
pub const NEW: &str = "new";
/// The same with its published coefficients.
pub const NEW_PUBLISHED: &str = "new_published";

/// One line of the comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Model id.
    pub model: String,
    /// Model title, for people.
    pub title: String,
    /// Whether its coefficients were fitted to this group.
    pub fitted_here: bool,
    /// One of [`SPLITS`].
    pub split: String,
    /// Rows compared.
    pub n: usize,
    /// Adjusted R2; NaN is written as null.
    pub adj_r2: Option<f64>,
    /// Root of the mean squared error, N.
    pub rmse: Option<f64>,
    /// Largest absolute error, N.
    pub max_abs_error: Option<f64>,
    /// Largest absolute error in percent of its specimen's measured maximum.
    pub max_abs_error_pct: Option<f64>,
    /// Mean of measured minus predicted, N.
    pub bias: Option<f64>,
    /// Rows for which the model gives nothing.
    pub n_excluded: usize,
    /// Rows for which it answers beyond what it was fitted to.
    pub n_extrapolated: usize,
}

/// One model on one specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecimenComparison {
    /// Specimen id.
    pub specimen: String,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// The statistics; its split is `loso` for a fit that has not seen the specimen, else `all`.
    pub comparison: Comparison,
}

/// Why a model left rows out or went beyond its data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DomainNote {
    /// Model id.
    pub model: String,
    /// Whether the rows are left out, or answered all the same.
    pub excluded: bool,
    /// An example of the reason.
    pub reason: String,
    /// How many rows.
    pub count: usize,
}

/// The comparison of one group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupComparison {
    /// Which rows.
    pub group: Group,
    /// Every model and split.
    pub comparisons: Vec<Comparison>,
    /// Every model on each specimen; the fitted one by the fit that has not seen it, where there is one.
    pub by_specimen: Vec<SpecimenComparison>,
    /// What was predicted of the measured maxima.
    pub maxima: Option<MaximaComparison>,
    /// Where models end.
    pub domain: Vec<DomainNote>,
}

/// The predictions of a group: measured rows and, by model id, what it predicts (NaN where it gives nothing).
#[derive(Clone, Debug, Default)]
pub struct Predictions {
    /// The usable rows.
    pub rows: Vec<Row>,
    /// Predicted force by model, N; `new (loso)` holds the predictions of the fits that have not seen the row's specimen.
    pub by_model: BTreeMap<String, Vec<f64>>,
}

/// Name of the predictions by the fits that have not seen the row's specimen.
pub const NEW_LOSO: &str = "new (loso)";

struct Answers {
    id: String,
    title: String,
    fitted_here: bool,
    predictions: Vec<Prediction>,
}

/// Compares the models on the rows of a group.
pub fn compare(
    fit: &GroupFit,
    rows: &[Row],
    options: &CompareOptions,
    fit_options: &FitOptions,
) -> (GroupComparison, Predictions) {
    let rows: Vec<Row> = rows.iter().filter(|r| is_usable(r)).cloned().collect();
    let strongest = strongest(&rows);
    let mut comparisons = Vec::new();
    let mut by_specimen = Vec::new();
    let mut domain = Vec::new();
    let mut by_model = BTreeMap::new();
    let new = new_model(fit, &rows, fit_options);
    let loso = leave_one_specimen_out(fit, &rows, fit_options);
    let by_rows = split_by_row(fit, &rows, fit_options);
    let splits = Splits::new(&rows, fit_options);
    let baselines = chosen(fit.group.diameter_mm, options).map(|m| baseline(m, &rows));
    let all: Vec<Answers> = new.into_iter().chain(baselines).collect();
    let common = common(&all, loso.as_ref(), &rows);
    for answers in all {
        let parameters = if answers.fitted_here {
            parameters(fit)
        } else {
            0
        };
        for split in SPLITS {
            let (used, p) = match (split, answers.fitted_here) {
                ("loso" | COMMON, true) => (loso.as_ref(), 0),
                ("rows_train", true) => (by_rows.as_ref(), parameters),
                ("rows_validation", true) => (by_rows.as_ref(), 0),
                ("train" | "all", true) => (Some(&answers), parameters),
                _ => (Some(&answers), 0),
            };
            let members = match split {
                COMMON => common.clone(),
                _ => splits.members(split, &rows),
            };
            let line = used
                .and_then(|used| statistics(used, &answers, split, &rows, &members, p, &strongest));
            comparisons.extend(line);
        }
        let unseen = loso.as_ref().filter(|_| answers.fitted_here);
        by_specimen.extend(of_specimens(&answers, unseen, &rows, &strongest));
        domain.extend(domain_notes(&answers));
        by_model.insert(answers.id.clone(), forces(&answers.predictions));
    }
    if let Some(loso) = &loso {
        by_model.insert(NEW_LOSO.to_owned(), forces(&loso.predictions));
    }
    let comparison = GroupComparison {
        group: fit.group.clone(),
        comparisons,
        by_specimen,
        maxima: maxima::compare(fit, fit_options),
        domain,
    };
    (comparison, Predictions { rows, by_model })
}

/// The published models of a diameter that are compared.
fn chosen(
    diameter_mm: u32,
    options: &CompareOptions,
) -> impl Iterator<Item = &'static dyn ForceModel> {
    published().into_iter().filter(move |m| {
        m.diameters().contains(&diameter_mm)
            && gate::passes(*m, diameter_mm)
            && (options.models.is_empty() || options.models.iter().any(|id| id == m.id()))
    })
}

/// The splits, in the order of the tables.
pub const SPLITS: [&str; 8] = [
    "train",
    "loso",
    COMMON,
    "validation",
    "holdout",
    "rows_train",
    "rows_validation",
    "all",
];

/// The split of the readings that the models of [`RANKED`] all answer.
pub const COMMON: &str = "common";
/// The models that are ranked: what is new, the best that was published before, and the manufacturer's. Others may leave out what they like.
pub const RANKED: [&str; 3] = [NEW, "hunt2017", "festo_tool"];

/// The fitted readings that all ranked models answer, the new one without having seen them.
fn common(all: &[Answers], unseen: Option<&Answers>, rows: &[Row]) -> Vec<usize> {
    let ranked = all.iter().filter(|a| RANKED.contains(&a.id.as_str()));
    let ranked: Vec<&Answers> = ranked.filter(|a| !a.fitted_here).chain(unseen).collect();
    let is_answered = |k: &usize| ranked.iter().all(|a| a.predictions[*k].force_n().is_some());
    (0..rows.len())
        .filter(|k| is_fitted(&rows[*k]) && is_answered(k))
        .collect()
}

struct Splits {
    by_row: Vec<Option<Part>>,
}

impl Splits {
    fn new(rows: &[Row], options: &FitOptions) -> Self {
        let rows: Vec<&Row> = rows.iter().collect();
        Self {
            by_row: split::by_row(&rows, options),
        }
    }

    /// The rows of a split.
    fn members(&self, split: &str, rows: &[Row]) -> Vec<usize> {
        let belongs = |k: &usize| match split {
            "train" | "loso" => is_fitted(&rows[*k]),
            "validation" => rows[*k].role == Some(Role::Validation),
            "holdout" => rows[*k].role == Some(Role::Holdout),
            "rows_train" => self.by_row[*k] == Some(Part::Train),
            "rows_validation" => self.by_row[*k] == Some(Part::Validation),
            _ => true,
        };
        (0..rows.len()).filter(belongs).collect()
    }
}

/// One model on each specimen, by resting length.
fn of_specimens(
    answers: &Answers,
    unseen: Option<&Answers>,
    rows: &[Row],
    strongest: &BTreeMap<String, f64>,
) -> Vec<SpecimenComparison> {
    let mut members: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (k, row) in rows.iter().enumerate() {
        members.entry(&row.specimen).or_default().push(k);
    }
    let (used, split) = match unseen {
        Some(unseen) => (unseen, "loso"),
        None => (answers, "all"),
    };
    let mut found: Vec<SpecimenComparison> = members
        .into_iter()
        .filter_map(|(specimen, members)| {
            Some(SpecimenComparison {
                specimen: specimen.to_owned(),
                rest_length_m: rows[members[0]].rest_length_m,
                comparison: statistics(used, answers, split, rows, &members, 0, strongest)?,
            })
        })
        .collect();
    found.sort_by(|a, b| a.rest_length_m.total_cmp(&b.rest_length_m));
    found
}

fn forces(predictions: &[Prediction]) -> Vec<f64> {
    predictions
        .iter()
        .map(|p| p.force_n().unwrap_or(f64::NAN))
        .collect()
}

/// Number of coefficients that the joint fit determined.
fn parameters(fit: &GroupFit) -> usize {
    fit.equation(JOINT).map_or(0, |e| e.p)
}

fn strongest(rows: &[Row]) -> BTreeMap<String, f64> {
    let mut strongest = BTreeMap::new();
    for row in rows {
        let slot = strongest
            .entry(row.specimen.clone())
            .or_insert(f64::NEG_INFINITY);
        *slot = row.force_n.max(*slot);
    }
    strongest
}

fn state(row: &Row) -> State {
    State {
        diameter_mm: row.diameter_mm,
        rest_length_m: row.rest_length_m,
        contracted_length_m: row.contracted_length_m,
        length_m: row.length_m,
        pressure_kpa: row.pressure_kpa,
        direction: Direction::Isometric,
    }
}

fn baseline(model: &dyn ForceModel, rows: &[Row]) -> Answers {
    Answers {
        id: model.id().to_owned(),
        title: model.title().to_owned(),
        fitted_here: false,
        predictions: rows.iter().map(|r| model.predict(&state(r))).collect(),
    }
}

fn new_model(fit: &GroupFit, rows: &[Row], options: &FitOptions) -> Option<Answers> {
    let coefficients = fit.equation(JOINT)?.values();
    let force = |r: &Row| joint_force(&coefficients, fit.group.diameter_mm, r, options);
    Some(Answers {
        id: NEW.to_owned(),
        title: "New model, fitted here".to_owned(),
        fitted_here: true,
        predictions: rows
            .iter()
            .map(|r| Prediction::new(force(r), None))
            .collect(),
    })
}

/// Every row predicted by the fit without its specimen; rows of specimens that no fit left out get nothing.
fn leave_one_specimen_out(fit: &GroupFit, rows: &[Row], options: &FitOptions) -> Option<Answers> {
    let joint = fit.equation(JOINT)?;
    if joint.folds.is_empty() {
        return None;
    }
    let folds: BTreeMap<&str, &[f64]> = joint
        .folds
        .iter()
        .map(|f| (f.left_out.as_str(), f.coefficients.as_slice()))
        .collect();
    let predict = |row: &Row| match folds.get(row.specimen.as_str()) {
        Some(c) => Prediction::new(joint_force(c, fit.group.diameter_mm, row, options), None),
        None => Prediction::outside(pipeline_mechanics::models::Reason::NotAState(
            "no fit left this specimen out",
        )),
    };
    Some(Answers {
        id: NEW_LOSO.to_owned(),
        title: String::new(),
        fitted_here: true,
        predictions: rows.iter().map(predict).collect(),
    })
}

/// Every row predicted by the fit to the training rows of the split by row.
fn split_by_row(fit: &GroupFit, rows: &[Row], options: &FitOptions) -> Option<Answers> {
    let split = fit.equation(JOINT)?.by_rows.as_ref()?;
    let diameter = fit.group.diameter_mm;
    let force = |r: &Row| joint_force(&split.coefficients, diameter, r, options);
    Some(Answers {
        id: NEW.to_owned(),
        title: String::new(),
        fitted_here: true,
        predictions: rows
            .iter()
            .map(|r| Prediction::new(force(r), None))
            .collect(),
    })
}

/// The statistics of one model on one split; `None` where the split has no rows.
fn statistics(
    used: &Answers,
    named: &Answers,
    split: &str,
    rows: &[Row],
    members: &[usize],
    parameters: usize,
    strongest: &BTreeMap<String, f64>,
) -> Option<Comparison> {
    if members.is_empty() {
        return None;
    }
    let answered: Vec<(usize, f64)> = members
        .iter()
        .filter_map(|k| Some((*k, used.predictions[*k].force_n()?)))
        .collect();
    let observed: Vec<f64> = answered.iter().map(|(k, _)| rows[*k].force_n).collect();
    let predicted: Vec<f64> = answered.iter().map(|(_, f)| *f).collect();
    let goodness = GoodnessOfFit::new(&observed, &predicted, parameters);
    let percent = |(k, f): &(usize, f64)| {
        let most = strongest
            .get(&rows[*k].specimen)
            .copied()
            .unwrap_or(f64::NAN);
        100.0 * (rows[*k].force_n - f).abs() / most
    };
    let finite = |x: f64| x.is_finite().then_some(x);
    let extrapolated =
        |k: &&usize| matches!(used.predictions[**k], Prediction::Extrapolated { .. });
    Some(Comparison {
        model: named.id.clone(),
        title: named.title.clone(),
        fitted_here: named.fitted_here,
        split: split.to_owned(),
        n: goodness.n,
        adj_r2: finite(goodness.adjusted_r2),
        rmse: finite(goodness.rmse),
        max_abs_error: finite(goodness.max_abs_error),
        max_abs_error_pct: answered
            .iter()
            .map(percent)
            .reduce(f64::max)
            .and_then(finite),
        bias: finite(goodness.bias),
        n_excluded: members.len() - answered.len(),
        n_extrapolated: members.iter().filter(extrapolated).count(),
    })
}

/// The reasons of one model, alike ones together: their quantity and bounds, without the value of the single row.
fn domain_notes(answers: &Answers) -> Vec<DomainNote> {
    let mut notes: Vec<DomainNote> = Vec::new();
    for prediction in &answers.predictions {
        let Some(reason) = prediction.reason() else {
            continue;
        };
        let excluded = prediction.force_n().is_none();
        let kind = reason.kind();
        match notes
            .iter_mut()
            .find(|n| n.excluded == excluded && n.reason == kind)
        {
            Some(note) => note.count += 1,
            None => notes.push(DomainNote {
                model: answers.id.clone(),
                excluded,
                reason: kind,
                count: 1,
            }),
        }
    }
    notes.sort_by(|a, b| (a.excluded, &a.reason).cmp(&(b.excluded, &b.reason)));
    notes
}
