//! The scales behind the LAR-compatible statistics: Street's robust scale, and its mixture with the ordinary one.
//!
//! Sources: Street, Carroll and Ruppert, *The American Statistician* 42, 1988, pp. 152-154; DuMouchel and O'Brien 1989.

use super::loss::{BISQUARE_TUNING, Loss, SMALLEST_LAR_RESIDUAL};
use super::statistics::{mean, sum};

/// The constant `t` that residuals are divided by, with either weight.
pub const TUNING: f64 = BISQUARE_TUNING;
/// Step of the central difference for the slope of the influence.
const SLOPE_STEP: f64 = 1e-4;

/// The robust weight of a residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// `1/|u|`, with `u` cut off at [`super::loss::SMALLEST_LAR_RESIDUAL`].
    Lar,
    /// `(1 - u^2)^2` inside 1, zero outside.
    Bisquare,
}

impl Weighting {
    /// Weight of a residual in units of `4.685 sigma`.
    pub fn weight(self, u: f64) -> f64 {
        match self {
            Weighting::Lar => Loss::Lar.weight(u),
            Weighting::Bisquare => Loss::Bisquare { k: 1.0 }.weight(u),
        }
    }

    /// The influence `phi(u) = u w(u)`.
    fn influence(self, u: f64) -> f64 {
        match self {
            // Not as a product: its rounding would give the sign function a slope, of 1e-12 instead of none.
            Weighting::Lar => u / u.abs().max(SMALLEST_LAR_RESIDUAL),
            Weighting::Bisquare => u * self.weight(u),
        }
    }
}

/// The mixed scale `max(s_rob, sqrt((s_ols^2 p^2 + s_rob^2 n)/(p^2 + n)))` (DuMouchel and O'Brien 1989).
pub fn printed_scale(s_ols: f64, s_rob: f64, n: usize, p: usize) -> f64 {
    let (rows, squared) = (n as f64, (p * p) as f64);
    let mixed = (s_ols * s_ols * squared + s_rob * s_rob * rows) / (squared + rows);
    s_rob.max(mixed.sqrt())
}

/// Street's robust scale `K sqrt(m2) t sigma/m1` of `residuals` (`n`) with `leverages` (`n`) after a fit of `p` coefficients.
///
/// Where the influence has no slope at any residual, which happens to LAR, the estimate does not exist and counts as 0.
pub fn street_scale(
    weighting: Weighting,
    residuals: &[f64],
    leverages: &[f64],
    sigma: f64,
    p: usize,
) -> f64 {
    let n = residuals.len() as f64;
    let p = p as f64;
    let scale = TUNING * sigma;
    let phi = |u: f64| weighting.influence(u);
    let slopes: Vec<f64> = residuals
        .iter()
        .map(|r| r / scale)
        .map(|u| (phi(u + SLOPE_STEP) - phi(u - SLOPE_STEP)) / (2.0 * SLOPE_STEP))
        .collect();
    let m1 = mean(&slopes);
    if m1 <= 0.0 {
        return 0.0;
    }
    let squares: Vec<f64> = residuals
        .iter()
        .zip(leverages)
        .map(|(r, h)| (1.0 - h) * phi(r / scale) * phi(r / scale))
        .collect();
    let m2 = sum(&squares) / (n - p);
    let k = 1.0 + p / n * (1.0 - m1) / m1;
    k * m2.sqrt() * scale / m1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The papers' relation: with p = 3 and n = 257 the printed rmse is 0.184 s_ols.
    #[test]
    fn without_a_robust_scale_the_printed_rmse_is_the_worked_one() {
        let printed = printed_scale(0.0278, 0.0, 257, 3);
        assert!((printed / 0.0278 - 3.0 / 266.0_f64.sqrt()).abs() < 1e-15);
        assert!((printed / 0.0278 - 0.184).abs() < 5e-4);
        // 0.005113; the 0.00512 of the papers is within the rounding of 0.0278 to three digits.
        assert!((printed - 0.00512).abs() < 1e-5);
        assert_eq!(printed_scale(1.0, 3.0, 10, 1), 3.0);
    }

    /// Far from outliers the bisquare is nearly least squares, and its scale nearly the ordinary one.
    #[test]
    fn the_bisquare_scale_of_small_residuals_is_their_root_mean_square() {
        let residuals = [0.01, -0.02, 0.015, -0.005, 0.0, 0.01, -0.01];
        let scale = street_scale(Weighting::Bisquare, &residuals, &[0.0; 7], 1.0, 0);
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        assert!((scale / (squares / 7.0).sqrt() - 1.0).abs() < 1e-4);
        assert_eq!(
            street_scale(Weighting::Lar, &residuals[..4], &[0.0; 4], 1.0, 0),
            0.0
        );
    }
}
