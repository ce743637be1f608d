//! One scale for gains in likelihood with different numbers of amplitudes.

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
    fn tails_count_the_data_among_the_draws() {
        let draws: Vec<f64> = (1..=19).map(f64::from).collect();
        assert_eq!(upper_tail(&draws, 20.0), 0.05);
        assert_eq!(upper_tail(&draws, 19.0), 0.1);
        assert_eq!(critical(&draws, 0.05), 19.0);
        assert_eq!(critical(&[], 0.05), f64::INFINITY);
    }
}
