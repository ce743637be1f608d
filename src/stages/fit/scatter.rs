//! How far specimens lie from the joint fit: what a muscle that was not measured may differ by.
//!
//! The gain of specimen g is k_g = sum(y f)/sum(f^2) over its fitted rows, f being the force of Eq. 9: its force as a multiple of the
//! law's. Two laws are put to it, the fit to all specimens (r_g = k_g - 1) and the fit that has not seen it (d_g = k'_g - 1).
//!
//! **Between specimens.** r_g is too small for the scatter of new specimens, because each specimen pulls the fit towards itself, and d_g
//! is too large, because it holds the error of a fit to one specimen less. In a linear model with leverage h_g, d_g = r_g/(1 - h_g) and
//! E[r_g^2] = (1 - h_g) tau^2, so that E[r_g d_g] = tau^2 whatever the leverages: the mean of r_g d_g estimates the variance of the
//! gains without bias. Its degrees of freedom are the specimens less the coefficients of the law of length (b1, and b2 where it is
//! fitted), for those are what the gains determine.
//!
//! **Within a specimen.** What is left around k_g f: noise, zeros, hysteresis, and whatever the surface has not caught. Its mean square is
//! averaged over specimens, each counting the same.

use crate::engine::EquationFit;
use crate::equations::joint_force;
use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_numerics::statistics::{mean, sum, sum_of_squares};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Coefficients of the joint fit that belong to the surface; the others are the law of length.
const OF_THE_SURFACE: usize = 3;

/// How one specimen lies to the joint fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecimenScatter {
    /// Specimen id.
    pub specimen: String,
    /// Its gain against the fit to all specimens.
    pub gain: f64,
    /// Its gain against the fit that has not seen it.
    pub gain_unseen: f64,
    /// Standard deviation of its rows around its own gain, N.
    pub within_n: f64,
}

/// How the specimens of a group scatter about the joint fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Standard deviation of the gains of specimens, as a fraction of the force.
    pub between: f64,
    /// Standard deviation of readings around the law times the specimen's gain, N.
    pub within_n: f64,
    /// Degrees of freedom of `between`.
    pub freedom: usize,
    /// The specimens, by id.
    pub specimens: Vec<SpecimenScatter>,
}

/// The scatter of the specimens; `None` where there are no more of them than the law of length has coefficients, or where one of them
/// could not be left out.
pub fn scatter(
    joint: &EquationFit,
    diameter_mm: u32,
    rows: &[&Row],
    options: &FitOptions,
) -> Option<Scatter> {
    let all = joint.values();
    let mut of_specimen: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        of_specimen.entry(&row.specimen).or_default().push(row);
    }
    let specimens: Vec<SpecimenScatter> = joint
        .folds
        .iter()
        .filter_map(|fold| {
            let of = of_specimen.get(fold.left_out.as_str())?;
            let forces = |c: &[f64]| -> Vec<f64> {
                of.iter()
                    .map(|r| joint_force(c, diameter_mm, r, options))
                    .collect()
            };
            let (seen, unseen) = (forces(&all), forces(&fold.coefficients));
            let (gain, gain_unseen) = (gain(of, &seen)?, gain(of, &unseen)?);
            Some(SpecimenScatter {
                specimen: fold.left_out.clone(),
                gain,
                gain_unseen,
                within_n: within(of, &seen, gain)?,
            })
        })
        .collect();
    let freedom = of_specimen
        .len()
        .checked_sub(joint.p.checked_sub(OF_THE_SURFACE)?)?;
    if freedom == 0 || specimens.len() < of_specimen.len() {
        return None;
    }
    let products: Vec<f64> = specimens
        .iter()
        .map(|s| (s.gain - 1.0) * (s.gain_unseen - 1.0))
        .collect();
    let squares: Vec<f64> = specimens.iter().map(|s| s.within_n * s.within_n).collect();
    Some(Scatter {
        between: mean(&products).max(0.0).sqrt(),
        within_n: mean(&squares).sqrt(),
        freedom,
        specimens,
    })
}

/// k = sum(y f)/sum(f^2); `None` where the law gives no force at any of the rows.
fn gain(rows: &[&Row], forces: &[f64]) -> Option<f64> {
    let products: Vec<f64> = rows
        .iter()
        .zip(forces)
        .map(|(r, f)| r.force_n * f)
        .collect();
    let gain = sum(&products) / sum_of_squares(forces);
    gain.is_finite().then_some(gain)
}

/// Standard deviation about k f, over n - 1; `None` for a single row.
fn within(rows: &[&Row], forces: &[f64], gain: f64) -> Option<f64> {
    let left: Vec<f64> = rows
        .iter()
        .zip(forces)
        .map(|(r, f)| r.force_n - gain * f)
        .collect();
    let variance = sum_of_squares(&left) / (left.len().checked_sub(1)? as f64);
    variance.is_finite().then(|| variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::joint;
    use pipeline_mechanics::models::P_620_KPA;
    use pipeline_mechanics::models::new;

    /// A campaign without noise, its specimens stronger or weaker than the published law by the given fractions.
    fn campaign(deviations: &[f64]) -> Vec<Row> {
        let mut rows = Vec::new();
        for (g, deviation) in deviations.iter().enumerate() {
            for (k, relative) in [0.0, 0.2, 0.4, 0.6].iter().enumerate() {
                for pressure in [200.0, 350.0, 500.0, 620.0] {
                    let mut row = Row::blank();
                    row.specimen = format!("s{g}");
                    row.session = format!("s{g}-{k}");
                    row.rest_length_m = 0.1 + 0.05 * g as f64;
                    row.contraction_rel = *relative;
                    row.pressure_rel = pressure / P_620_KPA;
                    let f620 = new::f620(303.5, 19.03, 0.0075, row.rest_length_m);
                    let c = [0.5682, 4.254, 0.5597];
                    row.force_n = (1.0 + deviation)
                        * new::force(c, f620, row.contraction_rel, row.pressure_rel);
                    rows.push(row);
                }
            }
        }
        rows
    }

    /// Averaged over every assignment of signs, the estimate of a variance that is drawn with independent signs is its expectation.
    #[test]
    fn the_variance_between_specimens_is_estimated_without_bias() {
        let (tau, specimens) = (0.02, 6);
        let mut variances = Vec::new();
        for signs in 0..1_u32 << specimens {
            let of = |g: usize| if signs >> g & 1 == 1 { tau } else { -tau };
            let deviations: Vec<f64> = (0..specimens).map(of).collect();
            let rows = campaign(&deviations);
            let rows: Vec<&Row> = rows.iter().collect();
            let options = FitOptions {
                bootstrap_refits: 0,
                ..FitOptions::default()
            };
            let fit = joint(10, &rows, &options).unwrap();
            let scatter = scatter(&fit, 10, &rows, &options).unwrap();
            assert_eq!((scatter.freedom, scatter.specimens.len()), (4, 6));
            variances.push(scatter.between * scatter.between);
        }
        let ratio = mean(&variances) / (tau * tau);
        assert!((0.95..1.05).contains(&ratio), "{ratio}");
    }

    #[test]
    fn too_few_specimens_have_no_scatter() {
        let rows = campaign(&[0.01, -0.01]);
        let rows: Vec<&Row> = rows.iter().collect();
        let options = FitOptions::default();
        let fit = joint(10, &rows, &options).unwrap();
        assert_eq!(scatter(&fit, 10, &rows, &options), None);
    }
}
