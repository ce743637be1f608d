//! Regularised incomplete beta and gamma functions, accurate for arguments of any size.
//!
//! Both are a power series or a continued fraction times a prefactor. The prefactor is where large arguments lose digits (it is
//! a difference of huge logarithms of gamma functions), so it is written with Stirling's error term and deviances instead, after
//! Loader, *Fast and Accurate Computation of Binomial Probabilities*, 2000. Fractions by Lentz's method: Press et al.,
//! *Numerical Recipes*, 3rd ed. 2007, sections 6.2 and 6.4.

use std::f64::consts::PI;

const MAX_TERMS: usize = 100_000;
/// Stands for a zero denominator in Lentz's method.
const TINY: f64 = 1e-300;

/// Stirling's error `ln Gamma(a) - [(a - 1/2) ln a - a + ln sqrt(2 pi)]` for `a > 0`.
fn stirling_error(a: f64) -> f64 {
    if a < 15.0 {
        let stirling = (a - 0.5) * libm::log(a) - a + 0.5 * libm::log(2.0 * PI);
        return libm::lgamma(a) - stirling;
    }
    let z = 1.0 / (a * a);
    let tail = 1.0 / 1260.0 - z * (1.0 / 1680.0 - z * (1.0 / 1188.0 - z * 691.0 / 360_360.0));
    (1.0 / 12.0 - z * (1.0 / 360.0 - z * tail)) / a
}

/// `ln(ratio) - (ratio - 1)` given `excess = ratio - 1` too: without cancellation where the ratio is near 1 or near 0.
fn deviance(ratio: f64, excess: f64) -> f64 {
    let x = excess;
    if x.abs() > 0.1 {
        return libm::log(ratio) - x;
    }
    // Artanh series: ln(1+x) = 2 (s + s^3/3 + ...) with s = x/(2+x), and 2 s - x = -x s.
    let s = x / (2.0 + x);
    let (mut power, mut sum) = (s * s * s, 0.0);
    for k in (3..).step_by(2) {
        let term = power / f64::from(k);
        sum += term;
        if term.abs() <= 1e-18 * sum.abs() {
            break;
        }
        power *= s * s;
    }
    2.0 * sum - x * s
}

/// The regularised incomplete beta function `I_x(a, b)` for `a, b > 0`, given `x` and `y = 1 - x`, both between 0 and 1.
///
/// The caller gives both, because whichever is small is known better than as the difference from one. NaN outside the domain.
pub fn incomplete_beta(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let domain = a > 0.0 && b > 0.0 && (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
    if !domain {
        return f64::NAN;
    }
    if x == 0.0 || y == 0.0 {
        return if x == 0.0 { 0.0 } else { 1.0 };
    }
    let front = beta_prefactor(a, b, x, y);
    if x * (a + b + 2.0) < a + 1.0 {
        front * beta_fraction(a, b, x) / a
    } else {
        1.0 - front * beta_fraction(b, a, y) / b
    }
}

/// `x^a y^b / B(a, b)`.
fn beta_prefactor(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let (excess, total) = (b * x - a * y, a + b);
    let deviances =
        a * deviance(x * (total / a), excess / a) + b * deviance(y * (total / b), -excess / b);
    let stirling = stirling_error(a + b) - stirling_error(a) - stirling_error(b);
    (a / (2.0 * PI) * (b / (a + b))).sqrt() * libm::exp(stirling + deviances)
}

/// The continued fraction of the incomplete beta function (Numerical Recipes, equation 6.4.5).
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let mut fraction = Lentz::new(1.0, 1.0 - (a + b) * x / (a + 1.0));
    for m in 1..MAX_TERMS {
        let m = m as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        fraction.advance(even, 1.0);
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        if fraction.advance(odd, 1.0) {
            break;
        }
    }
    fraction.value
}

/// The upper regularised incomplete gamma function `Q(a, x)` for `a > 0`, `x >= 0`; NaN outside.
pub fn upper_incomplete_gamma(a: f64, x: f64) -> f64 {
    if !(a > 0.0 && x >= 0.0) {
        return f64::NAN;
    }
    if x == 0.0 || x.is_infinite() {
        return if x == 0.0 { 1.0 } else { 0.0 };
    }
    let exponent = a * deviance(x / a, (x - a) / a) - stirling_error(a);
    let front = (a / (2.0 * PI)).sqrt() * libm::exp(exponent);
    if x < a + 1.0 {
        1.0 - front * gamma_series(a, x) / a
    } else {
        front * gamma_fraction(a, x)
    }
}

/// `sum_k x^k / ((a+1)...(a+k))` (Numerical Recipes, equation 6.2.5).
fn gamma_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..MAX_TERMS {
        term *= x / (a + k as f64);
        sum += term;
        if term < f64::EPSILON * sum {
            break;
        }
    }
    sum
}

/// The continued fraction of the upper incomplete gamma function (Numerical Recipes, equation 6.2.7).
fn gamma_fraction(a: f64, x: f64) -> f64 {
    let mut fraction = Lentz::new(1.0 / TINY, x + 1.0 - a);
    for k in 1..MAX_TERMS {
        let k = k as f64;
        if fraction.advance(-k * (k - a), x + 2.0 * k + 1.0 - a) {
            break;
        }
    }
    fraction.value
}

/// The state of Lentz's method for a continued fraction.
struct Lentz {
    c: f64,
    d: f64,
    value: f64,
}

impl Lentz {
    fn new(c: f64, first: f64) -> Self {
        let d = 1.0 / away_from_zero(first);
        Self { c, d, value: d }
    }

    /// Takes in one more `numerator / (denominator + ...)`; true once that no longer matters.
    fn advance(&mut self, numerator: f64, denominator: f64) -> bool {
        self.d = 1.0 / away_from_zero(denominator + numerator * self.d);
        self.c = away_from_zero(denominator + numerator / self.c);
        let change = self.c * self.d;
        self.value *= change;
        (change - 1.0).abs() <= f64::EPSILON
    }
}

fn away_from_zero(x: f64) -> f64 {
    if x.abs() < TINY { TINY } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_are_met() {
        for x in [0.01, 0.3, 0.5, 0.97] {
            // I_x(1, b) = 1 - (1-x)^b; I_x(1/2, 1/2) = 2/pi asin(sqrt x); Q(1, x) = exp(-x).
            let power = 1.0 - libm::pow(1.0 - x, 3.5);
            assert!((incomplete_beta(1.0, 3.5, x, 1.0 - x) - power).abs() < 1e-14);
            let arc = 2.0 / PI * libm::asin(x.sqrt());
            assert!((incomplete_beta(0.5, 0.5, x, 1.0 - x) - arc).abs() < 1e-14);
            assert!((upper_incomplete_gamma(1.0, x) - libm::exp(-x)).abs() < 1e-14);
        }
    }

    #[test]
    fn outside_the_domain_is_nan_and_the_ends_are_exact() {
        assert!(incomplete_beta(0.0, 1.0, 0.5, 0.5).is_nan());
        assert!(upper_incomplete_gamma(1.0, -1.0).is_nan());
        assert_eq!(incomplete_beta(2.0, 3.0, 0.0, 1.0), 0.0);
        assert_eq!(incomplete_beta(2.0, 3.0, 1.0, 0.0), 1.0);
    }
}
