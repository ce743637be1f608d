//! The measured maximum force of each specimen: at 620 kPa and resting length.
//!
//! Few logs stand exactly there, so the rows near it are brought to it: a straight line in pressure through the rows at resting length
//! within four times `near_620_kpa`, or, for specimens whose lengths were varied at 620 kPa, a parabola in eps* through the rows near
//! 620 kPa up to eps* = 0.6, which extrapolates and says so.

use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_mechanics::models::P_620_KPA;
use pipeline_numerics::matrix::Matrix;
use pipeline_numerics::qr::PivotedQr;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The maximum force of one specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Maximum {
    /// Specimen id.
    pub specimen: String,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// Force at 620 kPa and eps* = 0, N.
    pub force_n: f64,
    /// Rows that gave it.
    pub rows: usize,
    /// How it was brought to 620 kPa and resting length.
    pub method: String,
}

/// How a maximum was made of readings at other lengths.
pub const ALONG_LENGTH: &str = "parabola in contraction at 620 kPa";

/// The maximum of every specimen that has rows near it, by specimen id.
pub fn maxima(rows: &[&Row], options: &FitOptions) -> Vec<Maximum> {
    let mut by_specimen: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_specimen.entry(&row.specimen).or_default().push(row);
    }
    by_specimen
        .into_iter()
        .filter_map(|(id, rows)| {
            let (force_n, used, method) =
                at_rest(&rows, options).or_else(|| along_length(&rows, options))?;
            Some(Maximum {
                specimen: id.to_owned(),
                rest_length_m: rows[0].rest_length_m,
                force_n,
                rows: used,
                method: method.to_owned(),
            })
        })
        .collect()
}

fn at_rest(rows: &[&Row], options: &FitOptions) -> Option<(f64, usize, &'static str)> {
    let near = |row: &&&Row, span: f64| {
        row.contraction_rel.abs() <= options.at_rest && (row.pressure_kpa - P_620_KPA).abs() <= span
    };
    let closest = rows
        .iter()
        .filter(|r| near(r, options.near_620_kpa))
        .count();
    if closest == 0 {
        return None;
    }
    let used: Vec<&&Row> = rows
        .iter()
        .filter(|r| near(r, 4.0 * options.near_620_kpa))
        .collect();
    let pressures: Vec<f64> = used.iter().map(|r| r.pressure_kpa - P_620_KPA).collect();
    let forces: Vec<f64> = used.iter().map(|r| r.force_n).collect();
    let span = pressures.iter().copied().fold(f64::NEG_INFINITY, f64::max)
        - pressures.iter().copied().fold(f64::INFINITY, f64::min);
    if used.len() < 3 || span < options.near_620_kpa {
        return Some((
            forces.iter().sum::<f64>() / forces.len() as f64,
            used.len(),
            "mean near 620 kPa",
        ));
    }
    let force = polynomial_at_zero(&pressures, &forces, 1)?;
    Some((force, used.len(), "line in pressure, at resting length"))
}

fn along_length(rows: &[&Row], options: &FitOptions) -> Option<(f64, usize, &'static str)> {
    const UP_TO: f64 = 0.6;
    const STARTS_BELOW: f64 = 0.3;
    let used: Vec<&&Row> = rows
        .iter()
        .filter(|r| {
            (r.pressure_kpa - P_620_KPA).abs() <= options.near_620_kpa && r.contraction_rel <= UP_TO
        })
        .collect();
    let contractions: Vec<f64> = used.iter().map(|r| r.contraction_rel).collect();
    let forces: Vec<f64> = used.iter().map(|r| r.force_n).collect();
    let least = contractions.iter().copied().fold(f64::INFINITY, f64::min);
    if used.len() < 4 || least > STARTS_BELOW {
        return None;
    }
    let force = polynomial_at_zero(&contractions, &forces, 2)?;
    Some((force, used.len(), ALONG_LENGTH))
}

/// The value at zero of the least-squares polynomial of that degree; `None` where the points do not determine it.
fn polynomial_at_zero(x: &[f64], y: &[f64], degree: usize) -> Option<f64> {
    let mut design = Matrix::zeros(x.len(), degree + 1);
    for (i, x) in x.iter().enumerate() {
        let mut power = 1.0;
        for j in 0..=degree {
            design[(i, j)] = power;
            power *= x;
        }
    }
    let qr = PivotedQr::new(design);
    if qr.rank(qr.default_tolerance()) <= degree {
        return None;
    }
    qr.solve_least_squares(y, degree + 1).first().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_recovered_at_zero() {
        let x = [-2.0, -1.0, 0.5, 1.0, 3.0];
        let y: Vec<f64> = x.iter().map(|x| 4.0 - 2.0 * x + 0.5 * x * x).collect();
        assert!((polynomial_at_zero(&x, &y, 2).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(
            polynomial_at_zero(&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0], 1),
            None
        );
    }
}
