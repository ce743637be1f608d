//! The least value of a function on an interval.

/// Where a function is least between two bounds, and what it is there: a grid of so many steps, then golden sections about its best place.
pub(super) fn least((low, high): (f64, f64), steps: usize, of: impl Fn(f64) -> f64) -> (f64, f64) {
    let at = |k: usize| low + (high - low) * k as f64 / steps as f64;
    let values: Vec<f64> = (0..=steps).map(|k| of(at(k))).collect();
    let best = (0..=steps)
        .min_by(|a, b| values[*a].total_cmp(&values[*b]))
        .unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(steps)));
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - section * (b - a), a + section * (b - a));
    let (mut of_c, mut of_d) = (of(c), of(d));
    for _ in 0..16 {
        if of_c < of_d {
            (b, d, of_d) = (d, c, of_c);
            c = b - section * (b - a);
            of_c = of(c);
        } else {
            (a, c, of_c) = (c, d, of_d);
            d = a + section * (b - a);
            of_d = of(d);
        }
    }
    let inner = if of_c < of_d { (c, of_c) } else { (d, of_d) };
    if values[best] < inner.1 {
        (at(best), values[best])
    } else {
        inner
    }
}

#[cfg(test)]
mod tests {
    use super::least;

    #[test]
    fn least_finds_the_bottom() {
        let (x, value) = least((-10.0, 10.0), 16, |x| (x - 3.3) * (x - 3.3) + 1.0);
        assert!((x - 3.3).abs() < 0.02 && (value - 1.0).abs() < 1e-3);
    }
}
