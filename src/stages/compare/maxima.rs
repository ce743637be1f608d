//! What the models say of the measured maxima, the force at 620 kPa and resting length of each specimen: the right half of the force
//! paper's Table 1.

use pipeline_config::FitOptions;
use pipeline_fit::GroupFit;
use pipeline_fit::engine::Goodness;
use pipeline_fit::equations::{FORCE_AT_REST, force_at_rest_offset_m};
use pipeline_mechanics::models::festo_tool::FestoTool;
use pipeline_mechanics::models::{ForceModel, P_620_KPA, State, new};
use pipeline_numerics::statistics::GoodnessOfFit;
use serde::{Deserialize, Serialize};

/// Predictions of the measured maxima; no model here was fitted to them, so p is 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaximaComparison {
    /// Eq. 7 as fitted, at 620 kPa; none where it was not fitted.
    pub force_at_rest: Option<Goodness>,
    /// The Festo tool at 620 kPa without contraction.
    pub festo_tool: Option<Goodness>,
}

/// Compares the maxima of a group; none where it has none.
pub fn compare(fit: &GroupFit, options: &FitOptions) -> Option<MaximaComparison> {
    let measured: Vec<(f64, f64)> = fit
        .specimens
        .iter()
        .filter_map(|s| Some((s.rest_length_m, s.maximum.as_ref()?.force_n)))
        .collect();
    if measured.is_empty() {
        return None;
    }
    let diameter = fit.group.diameter_mm;
    let eq7 = fit.equation(FORCE_AT_REST).map(|e| {
        let (a, offset) = (e.values(), force_at_rest_offset_m(diameter, options));
        goodness(&measured, |l| {
            Some(new::fmax(a[0], a[1], offset, l, P_620_KPA))
        })
    });
    let festo = FestoTool.diameters().contains(&diameter).then(|| {
        goodness(&measured, |l| {
            FestoTool
                .predict(&State::relative(diameter, l, 0.2, 0.0, P_620_KPA))
                .force_n()
        })
    });
    Some(MaximaComparison {
        force_at_rest: eq7,
        festo_tool: festo,
    })
}

fn goodness(measured: &[(f64, f64)], predict: impl Fn(f64) -> Option<f64>) -> Goodness {
    let answered: Vec<(f64, f64)> = measured
        .iter()
        .filter_map(|(length, force)| Some((*force, predict(*length)?)))
        .collect();
    let (observed, predicted): (Vec<f64>, Vec<f64>) = answered.into_iter().unzip();
    Goodness::new(&GoodnessOfFit::new(&observed, &predicted, 0))
}
