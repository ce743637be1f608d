//! Numbers that an equation can be evaluated with: plain `f64`, and dual numbers that carry exact derivatives.
//!
//! Every force equation is written once, generic over [`Real`]. Evaluated with `f64` it gives the force; with [`Dual`] it gives
//! the force and its gradient with respect to up to `N` seeded variables, exact to rounding (forward-mode differentiation;
//! Griewank and Walther, *Evaluating Derivatives*, 2008, chapter 3). Transcendental functions come from `libm` and never from the
//! platform, so that Linux, macOS and Windows agree to the last bit.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number in the sense of the equations: a field with the handful of functions that force models need.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// A number whose derivatives are all zero.
    fn constant(value: f64) -> Self;
    /// The value without its derivatives.
    fn value(self) -> f64;
    /// Whether all of its derivatives are zero.
    fn is_constant(self) -> bool;
    /// `g(self)`, where the caller supplies `g` and `g'` at the value: the chain rule.
    fn chain(self, value: f64, slope: f64) -> Self;

    /// e to the power of the number.
    fn exp(self) -> Self {
        let e = libm::exp(self.value());
        self.chain(e, e)
    }
    /// Natural logarithm; NaN below zero.
    fn ln(self) -> Self {
        self.chain(libm::log(self.value()), 1.0 / self.value())
    }
    /// Arc tangent in radians.
    fn atan(self) -> Self {
        let x = self.value();
        self.chain(libm::atan(x), 1.0 / (1.0 + x * x))
    }
    /// Tangent of an angle in radians.
    fn tan(self) -> Self {
        let t = libm::tan(self.value());
        self.chain(t, 1.0 + t * t)
    }
    /// Sine of an angle in radians.
    fn sin(self) -> Self {
        self.chain(libm::sin(self.value()), libm::cos(self.value()))
    }
    /// Cosine of an angle in radians.
    fn cos(self) -> Self {
        self.chain(libm::cos(self.value()), -libm::sin(self.value()))
    }
    /// Square root; the derivative is infinite at zero.
    fn sqrt(self) -> Self {
        let s = self.value().sqrt();
        self.chain(s, 0.5 / s)
    }
    /// Power with a constant exponent.
    fn powf(self, exponent: f64) -> Self {
        let x = self.value();
        self.chain(
            libm::pow(x, exponent),
            exponent * libm::pow(x, exponent - 1.0),
        )
    }
    /// The number where it is positive, else zero (with zero derivatives): an actuator does not push.
    fn positive_part(self) -> Self {
        if self.value() > 0.0 {
            self
        } else {
            Self::constant(0.0)
        }
    }
}

impl Real for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn is_constant(self) -> bool {
        true
    }
    fn chain(self, value: f64, _slope: f64) -> Self {
        value
    }
}

/// A value with its gradient with respect to `N` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives with respect to the `N` seeded variables.
    pub gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable number `index`: its derivative with respect to itself is one.
    ///
    /// # Panics
    /// If `index >= N`.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut gradient = [0.0; N];
        gradient[index] = 1.0;
        Self { value, gradient }
    }

    #[inline]
    fn map2(self, other: Self, value: f64, left: f64, right: f64) -> Self {
        let mut gradient = [0.0; N];
        for (k, slot) in gradient.iter_mut().enumerate() {
            *slot = left * self.gradient[k] + right * other.gradient[k];
        }
        Self { value, gradient }
    }
}

impl<const N: usize> Real for Dual<N> {
    fn constant(value: f64) -> Self {
        Self {
            value,
            gradient: [0.0; N],
        }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn is_constant(self) -> bool {
        self.gradient.iter().all(|d| *d == 0.0)
    }
    #[inline]
    fn chain(mut self, value: f64, slope: f64) -> Self {
        // A plain loop: `array::map` is not unrolled, and this is the innermost loop of every fit.
        for d in &mut self.gradient {
            *d *= slope;
        }
        self.value = value;
        self
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        self.map2(o, self.value + o.value, 1.0, 1.0)
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self.map2(o, self.value - o.value, 1.0, -1.0)
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        self.map2(o, self.value * o.value, o.value, self.value)
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let quotient = self.value / o.value;
        self.map2(o, quotient, 1.0 / o.value, -quotient / o.value)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}
impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, c: f64) -> Self {
        self.chain(self.value + c, 1.0)
    }
}
impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, c: f64) -> Self {
        self.chain(self.value - c, 1.0)
    }
}
impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, c: f64) -> Self {
        self.chain(self.value * c, c)
    }
}
impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, c: f64) -> Self {
        self.chain(self.value / c, 1.0 / c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(x, y) = atan(x y) exp(-x) / sqrt(y) has a gradient that can be written down by hand.
    #[test]
    fn gradient_of_a_composite_function_is_the_analytic_one() {
        let (x0, y0) = (0.7, 1.9);
        let x = Dual::<2>::variable(x0, 0);
        let y = Dual::<2>::variable(y0, 1);
        let f = (x * y).atan() * (-x).exp() / y.sqrt();
        let (a, e, s) = (libm::atan(x0 * y0), libm::exp(-x0), y0.sqrt());
        let slope = 1.0 / (1.0 + (x0 * y0) * (x0 * y0));
        let dx = (y0 * slope - a) * e / s;
        let dy = x0 * slope * e / s - 0.5 * a * e / (s * y0);
        assert!((f.value - a * e / s).abs() < 1e-15);
        assert!((f.gradient[0] - dx).abs() < 1e-15);
        assert!((f.gradient[1] - dy).abs() < 1e-15);
    }

    #[test]
    fn functions_agree_with_central_differences() {
        let functions: [fn(Dual<1>) -> Dual<1>; 8] = [
            Real::exp,
            Real::ln,
            Real::atan,
            Real::tan,
            Real::sin,
            Real::cos,
            Real::sqrt,
            |x| x.powf(2.5),
        ];
        for f in functions {
            let h = 1e-6;
            let up = f(Dual::<1>::constant(0.6 + h)).value;
            let down = f(Dual::<1>::constant(0.6 - h)).value;
            let exact = f(Dual::<1>::variable(0.6, 0)).gradient[0];
            assert!((exact - (up - down) / (2.0 * h)).abs() < 1e-9);
        }
    }
}
