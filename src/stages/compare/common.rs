//! The new model beside those that designers use today, each on the same readings of specimens that it has not seen.
//!
//! A statistic over whatever a model answers cannot be compared with another's: the Festo tool answers a part of the readings only, and these are
//! the easier ones. So here a reading counts where every one of the models has an answer.

use crate::{NEW, NEW_LOSO};
use pipeline_base::row::Row;
use pipeline_fit::is_fitted;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The models that stand beside the new one, where they have an answer for the diameter.
const BESIDE: [&str; 2] = ["hunt2017", "festo_tool"];

/// The errors of some models on the readings that all of them answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Common {
    /// Readings that all of them answer.
    pub readings: usize,
    /// Readings in question.
    pub of: usize,
    /// Model id and root of the mean squared error, N; the new model first, on each specimen by the fit that has not seen it.
    pub rmse: Vec<(String, f64)>,
}

/// The comparison on common readings; none where no specimen could be left out or no model answers beside the new one.
pub fn common(rows: &[Row], by_model: &BTreeMap<String, Vec<f64>>) -> Option<Common> {
    let answers = |force: &[f64]| {
        rows.iter()
            .zip(force)
            .any(|(r, f)| is_fitted(r) && f.is_finite())
    };
    let beside = BESIDE
        .iter()
        .filter_map(|id| Some((*id, by_model.get(*id)?)));
    let beside = beside.filter(|(_, force)| answers(force));
    let models: Vec<(&str, &Vec<f64>)> = std::iter::once((NEW, by_model.get(NEW_LOSO)?))
        .chain(beside)
        .collect();
    let fitted: Vec<usize> = (0..rows.len()).filter(|k| is_fitted(&rows[*k])).collect();
    let answered = |k: &usize| models.iter().all(|(_, force)| force[*k].is_finite());
    let shared: Vec<usize> = fitted.iter().copied().filter(answered).collect();
    if shared.is_empty() || models.len() < 2 {
        return None;
    }
    let rmse = |force: &[f64]| {
        let squares = shared
            .iter()
            .map(|k| rows[*k].force_n - force[*k])
            .map(|error| error * error);
        (squares.sum::<f64>() / shared.len() as f64).sqrt()
    };
    Some(Common {
        readings: shared.len(),
        of: fitted.len(),
        rmse: models
            .iter()
            .map(|(id, force)| ((*id).to_owned(), rmse(force)))
            .collect(),
    })
}
