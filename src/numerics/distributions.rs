//! The distributions that tests and intervals need: normal, Student's t, chi-square and F.
//!
//! Built on `libm` and on [`super::special`]; relative accuracy about 1e-12, also in the tails. Arguments outside the domain
//! (degrees of freedom not positive, probabilities not between 0 and 1) give NaN. Degrees of freedom need not be whole.
//! Checked against tables made with SciPy, `tests/scripts/distributions.py`.
//!
//! Source of the relations: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 1964, section 26.

use std::f64::consts::{PI, SQRT_2};

use super::special::{incomplete_beta, upper_incomplete_gamma};

/// Two-sided 50% point of the normal distribution: the median of the size of a standard normal number.
pub const NORMAL_50: f64 = 0.674_489_750_196_082;

/// Relative error at which a quantile is final.
const QUANTILE_TOLERANCE: f64 = 1e-15;
const MAX_QUANTILE_STEPS: usize = 400;

/// Probability that a standard normal variable is at most `x`.
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x / SQRT_2)
}

/// The value that a standard normal variable exceeds with probability `1 - p`; infinite at 0 and 1.
pub fn normal_quantile(p: f64) -> f64 {
    if p > 0.5 {
        return -lower_tail_quantile(1.0 - p, normal_cdf, normal_density);
    }
    lower_tail_quantile(p, normal_cdf, normal_density)
}

fn normal_density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x) / (2.0 * PI).sqrt()
}

/// Probability that Student's t with `freedom` degrees of freedom is at most `t`.
pub fn student_t_cdf(t: f64, freedom: f64) -> f64 {
    if t.is_nan() || freedom.is_nan() || freedom <= 0.0 {
        return f64::NAN;
    }
    let tail = 0.5 * student_t_two_sided(t, freedom);
    if t > 0.0 { 1.0 - tail } else { tail }
}

/// Probability that Student's t is further from zero than `t`: the p-value of a two-sided test.
pub fn student_t_two_sided(t: f64, freedom: f64) -> f64 {
    if t.is_infinite() {
        return if freedom > 0.0 { 0.0 } else { f64::NAN };
    }
    // Divided through by the larger of the two, so that neither overflows.
    let square = t * t / freedom;
    let (x, y) = if square.is_infinite() {
        (freedom / t / t, 1.0)
    } else {
        (1.0 / (1.0 + square), square / (1.0 + square))
    };
    incomplete_beta(0.5 * freedom, 0.5, x, y)
}

/// The value that Student's t exceeds with probability `1 - p`; infinite at 0 and 1.
pub fn student_t_quantile(p: f64, freedom: f64) -> f64 {
    if freedom.is_nan() || freedom <= 0.0 {
        return f64::NAN;
    }
    let log_front = libm::lgamma(0.5 * (freedom + 1.0)) - libm::lgamma(0.5 * freedom);
    let front = libm::exp(log_front) / (PI * freedom).sqrt();
    let density = |t: f64| front * libm::exp(-0.5 * (freedom + 1.0) * libm::log1p(t * t / freedom));
    let cdf = |t: f64| student_t_cdf(t, freedom);
    if p > 0.5 {
        return -lower_tail_quantile(1.0 - p, cdf, density);
    }
    lower_tail_quantile(p, cdf, density)
}

/// Probability that chi-square with `freedom` degrees of freedom exceeds `x`.
pub fn chi_square_upper_tail(x: f64, freedom: f64) -> f64 {
    upper_incomplete_gamma(0.5 * freedom, 0.5 * x.max(0.0))
}

/// Probability that F with `numerator` and `denominator` degrees of freedom exceeds `f`.
pub fn f_upper_tail(f: f64, numerator: f64, denominator: f64) -> f64 {
    if f <= 0.0 && numerator > 0.0 && denominator > 0.0 {
        return 1.0;
    }
    let ratio = numerator * f / denominator;
    let y = if ratio.is_infinite() {
        1.0
    } else {
        ratio / (1.0 + ratio)
    };
    incomplete_beta(0.5 * denominator, 0.5 * numerator, 1.0 / (1.0 + ratio), y)
}

/// The `x <= 0` where the distribution function of a symmetric variable reaches `p <= 1/2`.
///
/// Newton's method inside an interval that is halved where Newton would leave it; unique, because the function rises.
fn lower_tail_quantile(p: f64, cdf: impl Fn(f64) -> f64, density: impl Fn(f64) -> f64) -> f64 {
    if !(0.0..=0.5).contains(&p) {
        return f64::NAN;
    }
    if p == 0.0 || p == 0.5 {
        return if p == 0.0 { f64::NEG_INFINITY } else { 0.0 };
    }
    let mut lower = -1.0;
    while cdf(lower) > p {
        lower *= 2.0;
    }
    let mut upper = if lower == -1.0 { 0.0 } else { 0.5 * lower };
    let mut x = 0.5 * (lower + upper);
    for _ in 0..MAX_QUANTILE_STEPS {
        let excess = cdf(x) - p;
        if excess > 0.0 {
            upper = x;
        } else {
            lower = x;
        }
        let mut next = x - excess / density(x);
        if !(lower < next && next < upper) {
            next = 0.5 * (lower + upper);
        }
        let done = (next - x).abs() <= QUANTILE_TOLERANCE * next.abs();
        x = next;
        if done {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_the_domain_is_nan() {
        let wrong = [
            normal_quantile(-0.1),
            normal_quantile(1.1),
            student_t_quantile(0.5, 0.0),
            student_t_cdf(1.0, -1.0),
            chi_square_upper_tail(1.0, 0.0),
            f_upper_tail(1.0, 0.0, 1.0),
            f_upper_tail(f64::NAN, 1.0, 1.0),
            normal_cdf(f64::NAN),
        ];
        assert!(wrong.iter().all(|v| v.is_nan()), "{wrong:?}");
    }

    #[test]
    fn ends_and_centres_are_exact() {
        assert_eq!(normal_quantile(0.5), 0.0);
        assert_eq!(student_t_quantile(1.0, 3.0), f64::INFINITY);
        assert_eq!(student_t_cdf(0.0, 3.0), 0.5);
        assert_eq!(student_t_cdf(f64::NEG_INFINITY, 3.0), 0.0);
        assert_eq!(chi_square_upper_tail(-1.0, 2.0), 1.0);
        assert_eq!(f_upper_tail(f64::INFINITY, 2.0, 3.0), 0.0);
    }

    #[test]
    fn quantiles_invert_the_distribution_functions() {
        for p in [1e-12, 1e-4, 0.1, 0.4999, 0.7, 0.975] {
            assert!((normal_cdf(normal_quantile(p)) / p - 1.0).abs() < 1e-13);
            for freedom in [0.7, 1.0, 2.5, 30.0, 1e6] {
                let t = student_t_quantile(p, freedom);
                assert!(
                    (student_t_cdf(t, freedom) / p - 1.0).abs() < 1e-11,
                    "{p} {freedom}"
                );
            }
        }
    }
}
