//! Curves through knots: piecewise linear, and the monotone piecewise cubic (for a twice differentiable one see
//! [`super::cubic_spline`]). Neither extrapolates.
//!
//! The monotone cubic has no extremum that the knots do not have, which makes it right for calibration and area curves where a
//! natural spline would ring. Slopes are the weighted harmonic means of Fritsch and Butland with the three-point formula at the
//! ends, those of SciPy's `PchipInterpolator`.
//!
//! Sources: Fritsch and Carlson, *SIAM Journal on Numerical Analysis* 17, 1980, pp. 238-246; Fritsch and Butland, *SIAM Journal
//! on Scientific and Statistical Computing* 5, 1984, pp. 300-304.

use std::fmt;

/// Why knots do not make a curve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KnotError {
    /// Fewer knots than the curve needs, or not as many abscissae as ordinates.
    Count {
        /// Number of knots that the curve needs.
        needed: usize,
        /// Number of abscissae.
        abscissae: usize,
        /// Number of ordinates.
        ordinates: usize,
    },
    /// The abscissa at this index is not greater than the one before it, or a coordinate is not finite.
    Order {
        /// Index of the knot.
        index: usize,
    },
}

impl fmt::Display for KnotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            KnotError::Count {
                needed,
                abscissae,
                ordinates,
            } => write!(
                f,
                "the curve needs {needed} knots or more, each with both coordinates; got {abscissae} abscissae and {ordinates} ordinates"
            ),
            KnotError::Order { index } => write!(
                f,
                "knot {index} is not finite or does not lie to the right of the one before it"
            ),
        }
    }
}

impl std::error::Error for KnotError {}

/// Checks that the knots are as many as needed, finite, and strictly increasing.
pub(super) fn check_knots(x: &[f64], y: &[f64], needed: usize) -> Result<(), KnotError> {
    if x.len() != y.len() || x.len() < needed {
        return Err(KnotError::Count {
            needed,
            abscissae: x.len(),
            ordinates: y.len(),
        });
    }
    let wrong = |&k: &usize| {
        let ordered = k == 0 || x[k - 1] < x[k];
        !(x[k].is_finite() && y[k].is_finite() && ordered)
    };
    match (0..x.len()).find(wrong) {
        Some(index) => Err(KnotError::Order { index }),
        None => Ok(()),
    }
}

/// The interval `[x[k], x[k+1]]` that contains `at`; `None` outside all of them.
pub(super) fn interval(x: &[f64], at: f64) -> Option<usize> {
    let inside = x[0] <= at && at <= x[x.len() - 1];
    inside.then(|| (x.partition_point(|&knot| knot <= at).max(1) - 1).min(x.len() - 2))
}

/// A piecewise linear curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Linear {
    /// The curve through knots with strictly increasing `x`.
    ///
    /// # Errors
    /// If the knots do not make a curve.
    pub fn new(x: &[f64], y: &[f64]) -> Result<Self, KnotError> {
        check_knots(x, y, 2)?;
        Ok(Self {
            x: x.to_vec(),
            y: y.to_vec(),
        })
    }

    /// The ordinate at `at`; `None` outside the knots.
    pub fn value(&self, at: f64) -> Option<f64> {
        let k = interval(&self.x, at)?;
        let t = (at - self.x[k]) / (self.x[k + 1] - self.x[k]);
        Some((1.0 - t) * self.y[k] + t * self.y[k + 1])
    }
}

/// A monotone piecewise cubic curve with a continuous first derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneCubic {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

impl MonotoneCubic {
    /// The curve through knots with strictly increasing `x`.
    ///
    /// # Errors
    /// If the knots do not make a curve.
    pub fn new(x: &[f64], y: &[f64]) -> Result<Self, KnotError> {
        check_knots(x, y, 2)?;
        Ok(Self {
            x: x.to_vec(),
            y: y.to_vec(),
            slopes: monotone_slopes(x, y),
        })
    }

    /// The ordinate at `at`; `None` outside the knots.
    pub fn value(&self, at: f64) -> Option<f64> {
        let k = interval(&self.x, at)?;
        let width = self.x[k + 1] - self.x[k];
        let t = (at - self.x[k]) / width;
        let s = 1.0 - t;
        let rise = (self.y[k + 1] - self.y[k]) * t * t * (1.0 + 2.0 * s);
        let bend = width * s * t * (s * self.slopes[k] - t * self.slopes[k + 1]);
        Some(self.y[k] + (rise + bend))
    }

    /// The first knot.
    pub fn first(&self) -> (f64, f64) {
        (self.x[0], self.y[0])
    }

    /// The last knot.
    pub fn last(&self) -> (f64, f64) {
        (self.x[self.x.len() - 1], self.y[self.y.len() - 1])
    }

    /// The slope of the curve at `at`; `None` outside the knots.
    pub fn slope(&self, at: f64) -> Option<f64> {
        let k = interval(&self.x, at)?;
        let width = self.x[k + 1] - self.x[k];
        let t = (at - self.x[k]) / width;
        let s = 1.0 - t;
        let secant = (self.y[k + 1] - self.y[k]) / width;
        let ends = s * (s - 2.0 * t) * self.slopes[k] + t * (t - 2.0 * s) * self.slopes[k + 1];
        Some(6.0 * s * t * secant + ends)
    }
}

/// Slopes at the knots that keep every interval monotone.
fn monotone_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let widths: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let rises = y.windows(2).map(|w| w[1] - w[0]);
    let secants: Vec<f64> = rises.zip(&widths).map(|(dy, h)| dy / h).collect();
    let last = secants.len() - 1;
    if last == 0 {
        return vec![secants[0]; 2];
    }
    let mut slopes = vec![end_slope(widths[0], widths[1], secants[0], secants[1])];
    for k in 0..last {
        slopes.push(inner_slope(&widths[k..=k + 1], &secants[k..=k + 1]));
    }
    let (near, far) = (last, last - 1);
    slopes.push(end_slope(
        widths[near],
        widths[far],
        secants[near],
        secants[far],
    ));
    slopes
}

/// The weighted harmonic mean of two secants; zero where they differ in sign.
fn inner_slope(widths: &[f64], secants: &[f64]) -> f64 {
    if secants[0] * secants[1] <= 0.0 {
        return 0.0;
    }
    let left = 2.0 * widths[1] + widths[0];
    let right = widths[1] + 2.0 * widths[0];
    (left + right) / (left / secants[0] + right / secants[1])
}

/// The three-point slope at an end, cut off where it would break monotonicity.
fn end_slope(near_width: f64, far_width: f64, near: f64, far: f64) -> f64 {
    let slope =
        ((2.0 * near_width + far_width) * near - near_width * far) / (near_width + far_width);
    if slope * near <= 0.0 {
        0.0
    } else if near * far < 0.0 && slope.abs() > 3.0 * near.abs() {
        3.0 * near
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 5] = [0.0, 1.0, 2.0, 4.0, 5.0];
    const Y: [f64; 5] = [0.0, 1.0, 1.5, 1.5, 4.0];

    #[test]
    fn both_curves_pass_the_knots_and_end_there() {
        let (linear, cubic) = (
            Linear::new(&X, &Y).unwrap(),
            MonotoneCubic::new(&X, &Y).unwrap(),
        );
        for (x, y) in X.iter().zip(Y) {
            assert_eq!(linear.value(*x), Some(y));
            assert_eq!(cubic.value(*x), Some(y));
        }
        for outside in [-1e-9, 5.0 + 1e-9, f64::NAN] {
            assert_eq!(linear.value(outside), None);
            assert_eq!(cubic.value(outside), None);
        }
        assert_eq!(linear.value(4.5), Some(2.75));
    }

    /// Values of `scipy.interpolate.PchipInterpolator(X, Y)`, SciPy 1.17.1.
    #[test]
    fn the_cubic_is_that_of_scipy() {
        let cubic = MonotoneCubic::new(&X, &Y).unwrap();
        let expected = [
            (0.25, 0.30078125000000006, 1.1510416666666667),
            (1.5, 1.3333333333333333, 0.5833333333333334),
            (3.0, 1.5, 0.0),
            (4.5, 2.333333333333333, 2.916666666666666),
            (5.0, 3.9999999999999996, 3.333333333333332),
        ];
        for (x, y, slope) in expected {
            assert!((cubic.value(x).unwrap() - y).abs() < 1e-15);
            assert!((cubic.slope(x).unwrap() - slope).abs() < 1e-14);
        }
    }

    #[test]
    fn the_cubic_rises_where_the_knots_rise() {
        let cubic = MonotoneCubic::new(&X, &Y).unwrap();
        let values: Vec<f64> = (0..=1000)
            .map(|k| cubic.value(f64::from(k) / 200.0).unwrap())
            .collect();
        assert!(values.windows(2).all(|w| w[0] <= w[1]));
    }

    #[test]
    fn knots_that_make_no_curve_are_refused() {
        assert!(matches!(
            Linear::new(&[0.0], &[0.0]),
            Err(KnotError::Count { .. })
        ));
        let repeated = MonotoneCubic::new(&[0.0, 1.0, 1.0], &[0.0; 3]);
        assert_eq!(repeated, Err(KnotError::Order { index: 2 }));
        let nan = Linear::new(&[0.0, 1.0], &[f64::NAN, 0.0]);
        assert_eq!(nan, Err(KnotError::Order { index: 0 }));
    }
}
