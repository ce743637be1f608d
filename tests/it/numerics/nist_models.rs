//! The models of the 27 NIST StRD nonlinear problems, each written once for every kind of number.
//!
//! Equations as printed in the header of each problem's file (NIST/ITL, public domain); `b[0]` is their `b1`.

use std::f64::consts::PI;

use pipeline::numerics::real::Real;

pub fn bennett5<R: Real>(b: &[R; 3], x: &[f64]) -> R {
    b[0] * (-((b[1] + x[0]).ln() / b[2])).exp()
}

/// BoxBOD and Misra1a.
pub fn saturating_exponential<R: Real>(b: &[R; 2], x: &[f64]) -> R {
    b[0] * (-(-(b[1] * x[0])).exp() + 1.0)
}

/// Chwirut1 and Chwirut2.
pub fn chwirut<R: Real>(b: &[R; 3], x: &[f64]) -> R {
    (-(b[0] * x[0])).exp() / (b[1] + b[2] * x[0])
}

pub fn dan_wood<R: Real>(b: &[R; 2], x: &[f64]) -> R {
    b[0] * (b[1] * libm::log(x[0])).exp()
}

pub fn eckerle4<R: Real>(b: &[R; 3], x: &[f64]) -> R {
    let z = (-b[2] + x[0]) / b[1];
    b[0] / b[1] * (z * z * -0.5).exp()
}

pub fn enso<R: Real>(b: &[R; 9], x: &[f64]) -> R {
    let turn = 2.0 * PI * x[0];
    let annual = b[1] * libm::cos(turn / 12.0) + b[2] * libm::sin(turn / 12.0);
    let wave = |period: R, c: R, s: R| {
        let angle = R::constant(turn) / period;
        c * angle.cos() + s * angle.sin()
    };
    b[0] + annual + wave(b[3], b[4], b[5]) + wave(b[6], b[7], b[8])
}

/// Gauss1, Gauss2 and Gauss3.
pub fn gauss<R: Real>(b: &[R; 8], x: &[f64]) -> R {
    let peak = |height: R, centre: R, width: R| {
        let z = (-centre + x[0]) / width;
        height * (-(z * z)).exp()
    };
    b[0] * (-(b[1] * x[0])).exp() + peak(b[2], b[3], b[4]) + peak(b[5], b[6], b[7])
}

/// Hahn1 and Thurber.
pub fn cubic_over_cubic<R: Real>(b: &[R; 7], x: &[f64]) -> R {
    let x = x[0];
    let above = ((b[3] * x + b[2]) * x + b[1]) * x + b[0];
    let below = ((b[6] * x + b[5]) * x + b[4]) * x + 1.0;
    above / below
}

pub fn kirby2<R: Real>(b: &[R; 5], x: &[f64]) -> R {
    let x = x[0];
    ((b[2] * x + b[1]) * x + b[0]) / ((b[4] * x + b[3]) * x + 1.0)
}

/// Lanczos1, Lanczos2 and Lanczos3.
pub fn lanczos<R: Real>(b: &[R; 6], x: &[f64]) -> R {
    let decay = |height: R, rate: R| height * (-(rate * x[0])).exp();
    decay(b[0], b[1]) + decay(b[2], b[3]) + decay(b[4], b[5])
}

pub fn mgh09<R: Real>(b: &[R; 4], x: &[f64]) -> R {
    let x = x[0];
    b[0] * (b[1] * x + x * x) / (b[2] * x + x * x + b[3])
}

pub fn mgh10<R: Real>(b: &[R; 3], x: &[f64]) -> R {
    b[0] * (b[1] / (b[2] + x[0])).exp()
}

pub fn mgh17<R: Real>(b: &[R; 5], x: &[f64]) -> R {
    b[0] + b[1] * (-(b[3] * x[0])).exp() + b[2] * (-(b[4] * x[0])).exp()
}

pub fn misra1b<R: Real>(b: &[R; 2], x: &[f64]) -> R {
    b[0] * (-(b[1] * (x[0] / 2.0) + 1.0).powf(-2.0) + 1.0)
}

pub fn misra1c<R: Real>(b: &[R; 2], x: &[f64]) -> R {
    b[0] * (-(b[1] * (2.0 * x[0]) + 1.0).powf(-0.5) + 1.0)
}

pub fn misra1d<R: Real>(b: &[R; 2], x: &[f64]) -> R {
    b[0] * b[1] * x[0] / (b[1] * x[0] + 1.0)
}

/// Of the logarithm of the response.
pub fn nelson<R: Real>(b: &[R; 3], x: &[f64]) -> R {
    b[0] - b[1] * x[0] * (-(b[2] * x[1])).exp()
}

pub fn rat42<R: Real>(b: &[R; 3], x: &[f64]) -> R {
    b[0] / ((b[1] - b[2] * x[0]).exp() + 1.0)
}

pub fn rat43<R: Real>(b: &[R; 4], x: &[f64]) -> R {
    b[0] * (-(((b[1] - b[2] * x[0]).exp() + 1.0).ln() / b[3])).exp()
}

pub fn roszman1<R: Real>(b: &[R; 4], x: &[f64]) -> R {
    b[0] - b[1] * x[0] - (b[2] / (-b[3] + x[0])).atan() / PI
}
