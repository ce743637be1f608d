//! Losses of a residual: least squares and its robust relatives.
//!
//! With `u` the residual divided by a robust scale, a loss is `rho(u)`, its influence `psi(u) = rho'(u)` and its weight
//! `w(u) = psi(u)/u`. A fit with weights `w`, repeated until they settle, minimises the sum of `rho` (iteratively reweighted
//! least squares).
//!
//! Sources: Huber, *Robust Statistics*, 1981; Holland and Welsch, *Communications in Statistics* A6, 1977, pp. 813-827, table 1,
//! for the constants that give 95 % efficiency at the normal distribution; Beaton and Tukey, *Technometrics* 16, 1974.

use std::fmt;
use std::str::FromStr;

/// Huber's constant for 95 % efficiency (Holland and Welsch 1977).
pub const HUBER_TUNING: f64 = 1.345;
/// The bisquare's constant for 95 % efficiency (Holland and Welsch 1977).
pub const BISQUARE_TUNING: f64 = 4.685;
/// The Cauchy loss's constant for 95 % efficiency (Holland and Welsch 1977, given there as 2.385).
pub const CAUCHY_TUNING: f64 = 2.3849;
/// Residuals below this are treated as this by the LAR weight `1/|u|`, which has no bound: the square root of the machine epsilon.
pub const SMALLEST_LAR_RESIDUAL: f64 = 1.490_116_119_384_765_6e-8;

/// A loss, with its tuning constant `k` in units of the robust scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// `u^2/2`.
    LeastSquares,
    /// Quadratic up to `k`, linear beyond.
    Huber {
        /// Where the loss turns linear.
        k: f64,
    },
    /// Least absolute residuals, `|u|`.
    Lar,
    /// Tukey's biweight: constant beyond `k`, so that gross outliers have no influence at all.
    Bisquare {
        /// Where the influence ends.
        k: f64,
    },
    /// `k^2/2 ln(1 + (u/k)^2)`.
    Cauchy {
        /// Where the influence is greatest.
        k: f64,
    },
}

impl Loss {
    /// Every loss at its default tuning, in the order of the documentation.
    pub const ALL: [Loss; 5] = [
        Loss::LeastSquares,
        Loss::Huber { k: HUBER_TUNING },
        Loss::Lar,
        Loss::Bisquare { k: BISQUARE_TUNING },
        Loss::Cauchy { k: CAUCHY_TUNING },
    ];

    /// The name that stands in configurations.
    pub fn name(self) -> &'static str {
        match self {
            Loss::LeastSquares => "least_squares",
            Loss::Huber { .. } => "huber",
            Loss::Lar => "lar",
            Loss::Bisquare { .. } => "bisquare",
            Loss::Cauchy { .. } => "cauchy",
        }
    }

    /// The loss of a scaled residual.
    pub fn rho(self, u: f64) -> f64 {
        match self {
            Loss::LeastSquares => 0.5 * u * u,
            Loss::Huber { k } if u.abs() <= k => 0.5 * u * u,
            Loss::Huber { k } => k * (u.abs() - 0.5 * k),
            Loss::Lar => u.abs(),
            Loss::Bisquare { k } => {
                let inside = (1.0 - (u / k) * (u / k)).max(0.0);
                k * k / 6.0 * (1.0 - inside * inside * inside)
            }
            Loss::Cauchy { k } => 0.5 * k * k * libm::log1p((u / k) * (u / k)),
        }
    }

    /// The weight `psi(u)/u`, between 0 and 1 but for LAR, where it is `1/|u|` cut off at [`SMALLEST_LAR_RESIDUAL`].
    pub fn weight(self, u: f64) -> f64 {
        match self {
            Loss::LeastSquares => 1.0,
            Loss::Huber { k } => {
                if u.abs() <= k {
                    1.0
                } else {
                    k / u.abs()
                }
            }
            Loss::Lar => 1.0 / u.abs().max(SMALLEST_LAR_RESIDUAL),
            Loss::Bisquare { k } => {
                let inside = (1.0 - (u / k) * (u / k)).max(0.0);
                inside * inside
            }
            Loss::Cauchy { k } => 1.0 / (1.0 + (u / k) * (u / k)),
        }
    }

    /// The influence `rho'(u) = u w(u)`.
    pub fn psi(self, u: f64) -> f64 {
        u * self.weight(u)
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The name of a loss was not one of those known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownLoss(
    /// The name as it was given.
    pub String,
);

impl fmt::Display for UnknownLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = Loss::ALL.map(Loss::name).join(", ");
        write!(f, "unknown loss `{}`; known are {known}", self.0)
    }
}

impl std::error::Error for UnknownLoss {}

impl FromStr for Loss {
    type Err = UnknownLoss;

    /// The loss of that name at its default tuning.
    fn from_str(name: &str) -> Result<Self, UnknownLoss> {
        Loss::ALL
            .into_iter()
            .find(|loss| loss.name() == name)
            .ok_or_else(|| UnknownLoss(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn influence_is_the_slope_of_the_loss() {
        let h = 1e-6;
        for loss in Loss::ALL {
            for u in [-6.0, -2.0, -0.4, 0.3, 1.2, 3.0, 9.0] {
                let slope = (loss.rho(u + h) - loss.rho(u - h)) / (2.0 * h);
                assert!((slope - loss.psi(u)).abs() < 1e-8, "{loss} at {u}");
            }
            assert_eq!(loss.rho(0.0), 0.0);
        }
    }

    #[test]
    fn names_are_read_back_and_others_refused() {
        for loss in Loss::ALL {
            assert_eq!(loss.to_string().parse(), Ok(loss));
        }
        let refused = "tukey".parse::<Loss>().unwrap_err().to_string();
        assert!(refused.contains("bisquare"));
    }
}
