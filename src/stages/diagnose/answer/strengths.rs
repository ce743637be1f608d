//! The strengths of the specimens: usual, scattering, or going with a column that has one value a specimen.

use super::super::Work;
use super::super::between::{self, Column};
use super::super::candidates::STRENGTHS;
use super::super::findings::{EffectFinding, ParameterFinding, Unexplained};
use super::super::model::{Fitted, Model, USUAL_SCATTER};
use crate::base::columns::TEMPERATURE;
use crate::effects;
use crate::numerics::distributions::chi_square_upper_tail;
use std::collections::BTreeSet;

/// p below which the strengths scatter more than is usual.
const MORE_THAN_USUAL: f64 = 0.005;
/// Corrected p below which they go with a column.
const GOES_WITH: f64 = 0.01;
/// Fewest specimens whose scatter can be more than usual, and degrees of freedom.
const FEWEST: (usize, f64) = (4, 2.0);

/// What the strengths show.
pub(super) enum Strengths {
    /// The scatter of one make, or too few specimens.
    Usual,
    /// More than that; and what they cannot be told from.
    Scatter(Box<EffectFinding>, Option<String>),
    /// A column without a name in the library.
    GoWith(Unexplained),
}

/// What the strengths of a fitted model show.
pub(super) fn strengths(work: &Work, fitted: &Fitted, full: &Model) -> Strengths {
    let seen: BTreeSet<usize> = work.train.specimen.iter().copied().collect();
    let coefficients = work.base.coefficients.iter().take(2);
    let lost = coefficients.filter(|c| c.free).count();
    let freedom = seen.len() as f64 - lost as f64;
    if seen.len() < FEWEST.0 || freedom < FEWEST.1 {
        return Strengths::Usual;
    }
    let squares: f64 = seen
        .iter()
        .map(|k| fitted.strengths[*k] * fitted.strengths[*k])
        .sum();
    let p = more_than_usual(squares, freedom);
    if p > MORE_THAN_USUAL {
        return Strengths::Usual;
    }
    let columns = between::columns(work.train, &fitted.strengths);
    let explains = |c: &&Column| {
        c.p_adjusted < GOES_WITH
            && more_than_usual(c.left, (freedom - 1.0).max(1.0)) > MORE_THAN_USUAL
    };
    let column = columns.iter().find(explains);
    match column {
        Some(column) if column.name != TEMPERATURE => Strengths::GoWith(Unexplained {
            column: column.name.clone(),
            shape: "gain, between specimens".to_owned(),
            p_adjusted: column.p_adjusted,
            share_of_residual: column.regression.share,
            rmse_heldout_before: None,
            rmse_heldout_after: None,
            curve: column.line.to_vec(),
        }),
        column => {
            let mut finding = finding(work, fitted, full, (squares / freedom).sqrt(), freedom, p);
            finding
                .class
                .extend(column.map(|_| "temperature".to_owned()));
            Strengths::Scatter(Box::new(finding), note(&columns))
        }
    }
}

/// Probability that strengths of the usual scatter have this sum of squares.
fn more_than_usual(squares: f64, freedom: f64) -> f64 {
    chi_square_upper_tail(squares / (USUAL_SCATTER * USUAL_SCATTER), freedom)
}

/// What else differs from specimen to specimen.
fn note(columns: &[Column]) -> Option<String> {
    let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "Each specimen has one value of {}: whether the specimens differ or that acts on them cannot be told here. One specimen at two \
             values would tell.",
            names.join(", ")
        )
    })
}

fn finding(
    work: &Work,
    fitted: &Fitted,
    full: &Model,
    sd: f64,
    freedom: f64,
    p: f64,
) -> EffectFinding {
    let described = effects::all()[effects::index(STRENGTHS).unwrap_or_default()];
    let form = &described.forms()[0];
    // Wilson and Hilferty's quantile of chi-square.
    let quantile = |z: f64| {
        let cube = 1.0 - 2.0 / (9.0 * freedom) + z * (2.0 / (9.0 * freedom)).sqrt();
        freedom * cube * cube * cube
    };
    let rmse = |with_strengths: bool| {
        let predicted = full.predict(fitted, with_strengths);
        let errors = work.train.force.iter().zip(&predicted);
        let squares: f64 = errors.map(|(y, f)| (y - f) * (y - f)).sum();
        (squares / predicted.len() as f64).sqrt()
    };
    EffectFinding {
        id: described.id().to_owned(),
        title: described.title().to_owned(),
        equation: form.equation.to_owned(),
        form: form.name.to_owned(),
        class: [STRENGTHS, "force_gain", "misalignment"]
            .map(str::to_owned)
            .to_vec(),
        scope: "specimen".to_owned(),
        acts_on: "every specimen, each with its own value".to_owned(),
        parameters: vec![ParameterFinding {
            name: form.amplitude.name.to_owned(),
            value: sd,
            ci_low: sd * (freedom / quantile(1.96)).sqrt(),
            ci_high: sd * (freedom / quantile(-1.96).max(1e-3)).sqrt(),
            unit: form.amplitude.unit.to_owned(),
        }],
        p_adjusted: p,
        selected_in_folds: 1.0,
        chosen_in_folds: 1.0,
        helps_in_folds: 0.0,
        rmse_before: rmse(false),
        rmse_after: rmse(true),
        rmse_heldout_before: work.held.after.rmse(),
        rmse_heldout_after: work.held.after.rmse_own_strength(),
        criterion_gain: 0.0,
        source: described.source().to_owned(),
        measurement: described.measurement().to_owned(),
    }
}
