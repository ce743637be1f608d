//! One scale for gains in likelihood with different numbers of amplitudes.

use pipeline_numerics::distributions::normal_quantile;
use std::f64::consts::TAU;

/// The standard normal deviate of a chi-squared value (Wilson and Hilferty, PNAS 17 (1931) 684): a likelihood ratio of `k` amplitudes and one
/// of a single amplitude with the same deviate are equally improbable.
pub fn deviate(likelihood_ratio: f64, k: usize) -> f64 {
    let k = k as f64;
    let spread = 2.0 / (9.0 * k);
    (libm::cbrt(likelihood_ratio.max(0.0) / k) - 1.0 + spread) / spread.sqrt()
}

/// The likelihood ratio of `k` amplitudes that has a deviate.
pub fn likelihood_ratio(deviate: f64, k: usize) -> f64 {
    let k = k as f64;
    let spread = 2.0 / (9.0 * k);
    let root = (deviate * spread.sqrt() + 1.0 - spread).max(0.0);
    k * root * root * root
}

/// Probability of a maximum as large as `value` among draws, themselves and the data counted (Davison and Hinkley 1997, eq. 4.11).
pub fn upper_tail(draws: &[f64], value: f64) -> f64 {
    let above = draws.iter().filter(|d| **d >= value).count();
    (1 + above) as f64 / (1 + draws.len()) as f64
}

/// The value that a draw exceeds with a probability.
pub fn critical(draws: &[f64], level: f64) -> f64 {
    let mut sorted = draws.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = ((1.0 - level) * (sorted.len() + 1) as f64).ceil() as usize;
    sorted
        .get(rank.saturating_sub(1))
        .copied()
        .unwrap_or(f64::INFINITY)
}

/// Standard errors of the critical value from which a value is decided.
const FAR: f64 = 3.0;

/// Whether a value is so far from the critical one that more draws would not change the answer. The standard error of a quantile is that of
/// normal draws; maxima have a longer tail above than below, where the critical value is not.
pub fn is_decided(draws: &[f64], level: f64, value: f64) -> bool {
    let n = draws.len() as f64;
    if n < 1.0 / level {
        return false;
    }
    let mean = draws.iter().sum::<f64>() / n;
    let sd = (draws.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0)).sqrt();
    let quantile = normal_quantile(1.0 - level);
    let density = libm::exp(-0.5 * quantile * quantile) / TAU.sqrt();
    let error = sd * (level * (1.0 - level) / n).sqrt() / density;
    (value - critical(draws, level)).abs() > FAR * error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviates_turn_back_and_agree_with_tables() {
        for k in 1..5 {
            for lr in [0.5, 4.0, 30.0] {
                let back = likelihood_ratio(deviate(lr, k), k);
                assert!((back - lr).abs() < 1e-9 * lr);
            }
        }
        // Upper 5% points of chi-squared: 3.841, 5.991, 7.815.
        for (k, x) in [(1, 3.841), (2, 5.991), (3, 7.815)] {
            assert!((deviate(x, k) - 1.645).abs() < 0.04);
        }
    }

    #[test]
    fn a_value_is_decided_three_standard_errors_from_the_critical_one() {
        // Forty draws in steps of 0.1 about 2: standard deviation 1.169, critical value the 39th, 3.85; the density of a normal variable at its
        // 95% point is 0.1031, so that the standard error is 1.169 sqrt(0.05 x 0.95/40)/0.1031 = 0.391.
        let draws: Vec<f64> = (0..40).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
        assert_eq!(critical(&draws, 0.05), draws[38]);
        for (value, decided) in [
            (3.85 + 1.16, false),
            (3.85 + 1.18, true),
            (3.85 - 1.16, false),
            (3.85 - 1.18, true),
        ] {
            assert_eq!(is_decided(&draws, 0.05, value), decided, "{value}");
        }
        assert!(!is_decided(&draws[..19], 0.05, 100.0));
    }

    #[test]
    fn tails_count_the_data_among_the_draws() {
        let draws: Vec<f64> = (1..=19).map(f64::from).collect();
        assert_eq!(upper_tail(&draws, 20.0), 0.05);
        assert_eq!(upper_tail(&draws, 19.0), 0.1);
        assert_eq!(critical(&draws, 0.05), 19.0);
        assert_eq!(critical(&[], 0.05), f64::INFINITY);
    }
}
