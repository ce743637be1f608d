//! What the measured campaigns at hand give for a statistic that cannot be recomputed, to be shown beside it.
//!
//! Simulated campaigns are left out: they know the published coefficients.

use super::claims::{ErrorOf, Fit, Kind, Split, Statistic};
use pipeline_compare::GroupComparison;
use pipeline_fit::GroupFit;
use pipeline_fit::engine::{Compatible, EquationFit};

/// One number beside a claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// The campaign, or what else it is from.
    pub from: String,
    /// The honest number, in the claim's unit.
    pub honest: Option<f64>,
    /// The one that the authors' kind of robust fit prints.
    pub compatible: Option<f64>,
}

/// The resting lengths that count as one, m.
const SAME_LENGTH_M: f64 = 0.0015;

/// The same statistic of the same equation, one entry a measured group that has it. `percent`: shares become percentages.
pub fn of_fits(
    fit: &Fit,
    statistic: &Statistic,
    percent: bool,
    groups: &[&GroupFit],
) -> Vec<Beside> {
    let of =
        |group: &&&GroupFit| group.group.diameter_mm == fit.diameter_mm && !group.group.simulated;
    let scale = if percent { 100.0 } else { 1.0 };
    let entry = |group: &&GroupFit| {
        let (honest, compatible) = numbers(group.equation(&fit.equation)?, statistic);
        let any = honest.is_some() || compatible.is_some();
        any.then(|| Beside {
            from: group.group.campaign.clone(),
            honest: honest.map(|x| scale * x),
            compatible: compatible.map(|x| scale * x),
        })
    };
    groups.iter().filter(of).filter_map(entry).collect()
}

/// The error of a model at a resting length, one entry a measured specimen of that length.
pub fn of_models(error: &ErrorOf, comparisons: &[&GroupComparison]) -> Vec<Beside> {
    let mut found = Vec::new();
    for group in comparisons {
        if group.group.diameter_mm != error.diameter_mm
            || group.group.simulated
            || group.group.members.len() > 1
        {
            continue;
        }
        for of in &group.by_specimen {
            let near = (of.rest_length_m - error.rest_length_m).abs() <= SAME_LENGTH_M;
            if near && of.comparison.model == error.model {
                found.push(Beside {
                    from: format!("{}, {}", group.group.campaign, of.specimen),
                    honest: of.comparison.rmse,
                    compatible: None,
                });
            }
        }
    }
    found
}

/// The honest and the LAR-compatible number. A fit with training and validation rows is compared with the split by row, as in the papers.
fn numbers(fit: &EquationFit, statistic: &Statistic) -> (Option<f64>, Option<f64>) {
    let split = fit.by_rows.as_ref();
    match (statistic.split, statistic.kind) {
        (Split::Comparison, _) | (_, Kind::Sse) => (None, None),
        (Split::Validation, kind) => {
            let on = split.map(|s| &s.validation);
            let honest = on.and_then(|on| match kind {
                Kind::Rmse => on.rmse,
                Kind::AdjR2 => on.adjusted_r2,
                Kind::MaxError => on.max_abs_error,
                _ => None,
            });
            (honest, None)
        }
        (Split::Model, Kind::Value | Kind::CiLow | Kind::CiHigh) => coefficient(fit, statistic),
        (Split::Model, kind) => {
            let compatible = split
                .and_then(|s| s.compatible.as_ref())
                .or(fit.compatible.as_ref());
            let honest = match (kind, split) {
                (Kind::Rmse, Some(s)) => s.train.rmse,
                (Kind::AdjR2, Some(s)) => s.train.adjusted_r2,
                (Kind::MaxError, Some(s)) => s.train.max_abs_error,
                (Kind::Rmse, None) => Some(fit.rmse),
                (Kind::AdjR2, None) => Some(fit.adjusted_r2),
                _ => Some(fit.max_abs_error),
            };
            (
                honest.filter(|x| x.is_finite()),
                compatible.and_then(|c| goodness(c, kind)),
            )
        }
    }
}

fn goodness(compatible: &Compatible, kind: Kind) -> Option<f64> {
    match kind {
        Kind::Rmse => Some(compatible.rmse),
        Kind::AdjR2 => compatible.adjusted_r2,
        Kind::MaxError => Some(compatible.max_abs_error),
        _ => None,
    }
}

fn coefficient(fit: &EquationFit, statistic: &Statistic) -> (Option<f64>, Option<f64>) {
    let symbol = statistic.symbol.as_deref().unwrap_or_default();
    let Some(place) = fit.coefficients.iter().position(|c| c.symbol == symbol) else {
        return (None, None);
    };
    let honest = &fit.coefficients[place];
    let robust = fit.compatible.as_ref();
    let interval = robust.and_then(|c| c.intervals.get(place).copied().flatten());
    match statistic.kind {
        Kind::CiLow => (honest.ci_low, interval.map(|i| i.0)),
        Kind::CiHigh => (honest.ci_high, interval.map(|i| i.1)),
        _ => (
            Some(honest.value),
            robust.and_then(|c| c.coefficients.get(place).copied()),
        ),
    }
}
