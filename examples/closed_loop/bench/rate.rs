//! Shares with their bounds, and medians.

/// 95% quantile of a normal distribution, both sides.
const Z: f64 = 1.959_963_985;

/// So many of so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rate {
    /// Hits.
    pub hits: usize,
    /// Of.
    pub of: usize,
}

impl Rate {
    /// Counts what is true.
    pub fn of(flags: impl IntoIterator<Item = bool>) -> Self {
        let mut rate = Self::default();
        for flag in flags {
            rate.hits += usize::from(flag);
            rate.of += 1;
        }
        rate
    }

    /// The share.
    pub fn share(&self) -> f64 {
        self.hits as f64 / self.of as f64
    }

    /// Bounds of the share, 95% (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209).
    pub fn bounds(&self) -> (f64, f64) {
        let (n, p) = (self.of as f64, self.share());
        let middle = p + Z * Z / (2.0 * n);
        let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + Z * Z / n;
        (
            ((middle - half) / scale).max(0.0),
            ((middle + half) / scale).min(1.0),
        )
    }
}

impl std::fmt::Display for Rate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.of == 0 {
            return write!(f, "-");
        }
        let (low, high) = self.bounds();
        write!(
            f,
            "{} of {}: {:.0}% ({:.0} to {:.0}%)",
            self.hits,
            self.of,
            100.0 * self.share(),
            100.0 * low,
            100.0 * high
        )
    }
}

/// The quantile of a list; none of nothing.
pub fn quantile(values: impl IntoIterator<Item = f64>, probability: f64) -> Option<f64> {
    let values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
    let known = !values.is_empty();
    known.then(|| pipeline::numerics::statistics::quantile(&values, probability))
}

/// The median of a list; none of nothing.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_wilson_s() {
        // 15 of 200, by hand.
        let (low, high) = Rate { hits: 15, of: 200 }.bounds();
        assert!(
            (low - 0.04595).abs() < 5e-5 && (high - 0.12003).abs() < 5e-5,
            "{low} {high}"
        );
        assert_eq!(Rate { hits: 0, of: 10 }.bounds().0, 0.0);
        assert_eq!(Rate { hits: 10, of: 10 }.bounds().1, 1.0);
        assert_eq!(Rate::default().to_string(), "-");
    }
}
