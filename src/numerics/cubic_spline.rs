//! The interpolating cubic spline, twice continuously differentiable, with the end conditions that biomechanical models use.
//!
//! On the interval `k` of width h, with t from 0 to 1 and s = 1 - t, the curve is
//! s y_k + t y_{k+1} - h^2/6 s t ((1 + s) m_k + (1 + t) m_{k+1}), where m are the second derivatives at the knots. Continuity of the first
//! derivative makes them the solution of a tridiagonal system (de Boor, *A Practical Guide to Splines*, 1978, chapter IV); the first and the
//! last follow from the end condition. It does not extrapolate.

use super::interpolate::{KnotError, check_knots, interval};
use super::real::Real;

/// What the curve does at its two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// No curvature.
    Natural,
    /// The two outermost intervals carry one cubic (de Boor, chapter IV; MATLAB's `spline`). Four knots or more.
    NotAKnot,
    /// The third derivative is that of the cubic through the four outermost knots (Forsythe, Malcolm and Moler, *Computer Methods for
    /// Mathematical Computations*, 1977, section 4.4; OpenSim's `SimmSpline`). Four knots or more.
    Forsythe,
}

/// A cubic spline through knots.
#[derive(Clone, Debug, PartialEq)]
pub struct CubicSpline {
    x: Vec<f64>,
    y: Vec<f64>,
    curvature: Vec<f64>,
}

impl CubicSpline {
    /// The curve through knots with strictly increasing `x`.
    ///
    /// # Errors
    /// If the knots do not make a curve: not as many `y` as `x`, fewer than the end condition needs, out of order, not finite.
    pub fn new(x: &[f64], y: &[f64], ends: Ends) -> Result<Self, KnotError> {
        let needed = if ends == Ends::Natural { 2 } else { 4 };
        check_knots(x, y, needed)?;
        Ok(Self {
            x: x.to_vec(),
            y: y.to_vec(),
            curvature: curvature(x, y, ends),
        })
    }

    /// First and last abscissa.
    pub fn range(&self) -> (f64, f64) {
        (self.x[0], self.x[self.x.len() - 1])
    }

    /// The ordinate at `at`, with its derivatives; `None` outside the knots.
    pub fn value<R: Real>(&self, at: R) -> Option<R> {
        let k = interval(&self.x, at.value())?;
        let h = self.x[k + 1] - self.x[k];
        let (m, n) = (self.curvature[k], self.curvature[k + 1]);
        let t = (at.value() - self.x[k]) / h;
        let s = 1.0 - t;
        let bend = h * h / 6.0 * s * t * ((1.0 + s) * m + (1.0 + t) * n);
        let slope = (self.y[k + 1] - self.y[k]) / h
            - h / 6.0 * ((3.0 * s * s - 1.0) * m - (3.0 * t * t - 1.0) * n);
        Some(at.chain(s * self.y[k] + t * self.y[k + 1] - bend, slope))
    }
}

/// The second derivative at one end as `near` times that of the next knot, plus `far` times that of the one after it, plus `rest`.
struct End {
    near: f64,
    far: f64,
    rest: f64,
}

/// The end condition at the first of the knots; for the last, callers reverse them.
fn end(x: &[f64], y: &[f64], ends: Ends) -> End {
    let of = |near, far, rest| End { near, far, rest };
    match ends {
        Ends::Natural => of(0.0, 0.0, 0.0),
        Ends::NotAKnot => {
            let ratio = (x[1] - x[0]) / (x[2] - x[1]);
            of(1.0 + ratio, -ratio, 0.0)
        }
        Ends::Forsythe => {
            let first = |i: usize| (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
            let second = |i: usize| (first(i + 1) - first(i)) / (x[i + 2] - x[i]);
            let third = (second(1) - second(0)) / (x[3] - x[0]);
            of(1.0, 0.0, -6.0 * (x[1] - x[0]) * third)
        }
    }
}

/// Second derivatives at the knots: Thomas's elimination over the inner ones.
fn curvature(x: &[f64], y: &[f64], ends: Ends) -> Vec<f64> {
    let last = x.len() - 1;
    let mut m = vec![0.0; last + 1];
    if last < 2 {
        return m;
    }
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let (mut below, mut diagonal, mut above, mut right) =
        (h.clone(), vec![0.0; last], h[1..].to_vec(), vec![0.0; last]);
    above.insert(0, 0.0);
    for k in 1..last {
        diagonal[k] = 2.0 * (h[k - 1] + h[k]);
        right[k] = 6.0 * ((y[k + 1] - y[k]) / h[k] - (y[k] - y[k - 1]) / h[k - 1]);
        below[k] = h[k - 1];
    }
    let reversed = |v: &[f64]| v.iter().rev().copied().collect::<Vec<f64>>();
    let (left, other) = (end(x, y, ends), end(&reversed(x), &reversed(y), ends));
    diagonal[1] += h[0] * left.near;
    above[1] += h[0] * left.far;
    right[1] -= h[0] * left.rest;
    diagonal[last - 1] += h[last - 1] * other.near;
    below[last - 1] += h[last - 1] * other.far;
    right[last - 1] -= h[last - 1] * other.rest;
    for k in 2..last {
        let factor = below[k] / diagonal[k - 1];
        diagonal[k] -= factor * above[k - 1];
        right[k] -= factor * right[k - 1];
    }
    for k in (1..last).rev() {
        let known = if k + 1 < last {
            above[k] * m[k + 1]
        } else {
            0.0
        };
        m[k] = (right[k] - known) / diagonal[k];
    }
    m[0] = left.near * m[1] + left.far * m[2] + left.rest;
    m[last] = other.near * m[last - 1] + other.far * m[last - 2] + other.rest;
    m
}

#[cfg(test)]
mod tests {
    use super::super::real::Dual;
    use super::*;

    const X: [f64; 6] = [0.0, 1.0, 1.5, 3.0, 4.0, 6.0];

    /// Not-a-knot and Forsythe's ends reproduce a cubic, natural ends a straight line.
    #[test]
    fn polynomials_of_the_right_degree_are_reproduced() {
        let cubic = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x - 0.3 * x * x * x;
        let slope = |x: f64| -2.0 + x - 0.9 * x * x;
        let y = X.map(cubic);
        for ends in [Ends::NotAKnot, Ends::Forsythe] {
            let spline = CubicSpline::new(&X, &y, ends).unwrap();
            for k in 0..=60 {
                let x = f64::from(k) / 10.0;
                let found = spline.value(Dual::<1>::variable(x, 0)).unwrap();
                assert!((found.value - cubic(x)).abs() < 1e-12);
                assert!((found.gradient[0] - slope(x)).abs() < 1e-12);
            }
        }
        let line = CubicSpline::new(&X, &X.map(|x| 3.0 * x - 1.0), Ends::Natural).unwrap();
        assert!((line.value(2.2).unwrap() - 5.6).abs() < 1e-14);
    }

    /// Values of `scipy.interpolate.CubicSpline(X, sin X, bc_type=...)`, SciPy 1.17.1.
    #[test]
    fn the_ends_are_those_of_scipy() {
        let y = X.map(libm::sin);
        let cases = [
            (Ends::Natural, 0.4, 0.3855888393801288),
            (Ends::Natural, 2.2, 0.7966087231218305),
            (Ends::Natural, 5.5, -0.5841392576761616),
            (Ends::NotAKnot, 0.4, 0.39092776563084786),
            (Ends::NotAKnot, 2.2, 0.7850960907351044),
            (Ends::NotAKnot, 5.5, -0.8953923370089734),
        ];
        for (ends, at, expected) in cases {
            let found = CubicSpline::new(&X, &y, ends).unwrap().value(at).unwrap();
            assert!((found - expected).abs() < 1e-14, "{ends:?} {at}: {found}");
        }
    }

    #[test]
    fn nothing_outside_the_knots_and_no_curve_through_too_few() {
        let natural = CubicSpline::new(&X, &X, Ends::Natural).unwrap();
        assert_eq!(natural.value(-0.1), None);
        assert_eq!(natural.value(6.1), None);
        assert_eq!(natural.range(), (0.0, 6.0));
        assert!(CubicSpline::new(&X[..3], &X[..3], Ends::NotAKnot).is_err());
        assert!(CubicSpline::new(&X[..2], &X[..2], Ends::Natural).is_ok());
    }
}
