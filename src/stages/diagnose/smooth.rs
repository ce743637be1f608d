//! Smooth functions: Gaussian processes as sums of cosines.

use std::f64::consts::PI;

/// Standard deviations of the amplitudes of the first cosines of a Gaussian process of unit variance with a squared-exponential covariance:
/// roots of its spectral density. `length` is the correlation length as a share of the range of the cosines.
fn weights(count: usize, length: f64) -> Vec<f64> {
    let density = |k: usize| {
        let w = PI * k as f64 * length;
        // A cosine has half the mean square of a constant.
        let factor = if k == 0 { 1.0 } else { 2.0 };
        factor * length * (2.0 * PI).sqrt() * libm::exp(-0.5 * w * w)
    };
    (0..count).map(|k| density(k).sqrt()).collect()
}

/// Cosines over a range that reaches a correlation length further than the readings at either end, because their slope is 0 at its ends
/// (A. Solin and S. Sarkka, *Stat. Comput.* 30 (2020) 419).
pub fn cosines(count: usize, x: f64, length: f64) -> Vec<f64> {
    let range = 1.0 + 2.0 * length;
    let place = PI * (x + length) / range;
    let weights = weights(count, length / range);
    let terms = weights.iter().enumerate();
    terms
        .map(|(k, w)| w * libm::cos(k as f64 * place))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosines_have_the_covariance_of_the_process_they_stand_for() {
        let length = 100.0 / 620.0;
        for (a, b) in [(0.3, 0.3), (0.3, 0.4), (0.5, 0.9), (0.0, 0.1), (1.0, 1.0)] {
            let [at_a, at_b] = [a, b].map(|x| cosines(10, x, length));
            let covariance: f64 = at_a.iter().zip(&at_b).map(|(x, y)| x * y).sum();
            let distance: f64 = (a - b) / length;
            let expected = libm::exp(-0.5 * distance * distance);
            // At the ends the mirror image at two correlation lengths adds exp(-2).
            let from_mirror = |d: f64| libm::exp(-0.5 * (2.0 + d / length) * (2.0 + d / length));
            let mirrored = from_mirror(a + b) + from_mirror(2.0 - a - b);
            assert!(
                (covariance - expected - mirrored).abs() < 1e-3,
                "{a} {b}: {covariance} {expected}"
            );
        }
    }
}
