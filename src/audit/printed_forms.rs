//! Equations exactly as the papers print them, mistakes included, so that the mistakes can be shown by evaluating them.
//!
//! The corrected forms are in [`pipeline_mechanics::models`]. Where Eqs. 8, 11 and 12 of the knee paper print `P` before an exponential, the relative
//! pressure P* is taken, in the papers' favour.

use libm::{exp, tan};

/// The first six numbers.
pub fn six(x: &[f64]) -> [f64; 6] {
    [x[0], x[1], x[2], x[3], x[4], x[5]]
}

/// Force paper, Eq. 1, without hysteresis: `p0 + g F + A tan(w (eps/eps_620 - k F) - q)`, kPa, of p0, A, w, q, k, g, F, eps, eps_620.
pub fn force_paper_eq1(x: &[f64]) -> f64 {
    let [p0, a, w, q, k, g] = six(x);
    let (force, contraction_rel) = (x[6], x[7] / x[8]);
    p0 + g * force + a * tan(w * (contraction_rel - k * force) - q)
}

/// Knee paper, Eq. 8: `b0 + exp(-b1 eps*) + b2 + P* exp(-b3 eps*^2) + b4 + b5 P*` of b0 to b5, eps*, P*.
pub fn knee_paper_eq8(x: &[f64]) -> f64 {
    let [b0, b1, b2, b3, b4, b5] = six(x);
    let (strain, pressure) = (x[6], x[7]);
    b0 + exp(-b1 * strain) + b2 + pressure * exp(-b3 * strain * strain) + b4 + b5 * pressure
}

/// Knee paper, Eq. 11: `b0 + exp(-b1 eps* + b2) + P* exp(-b3 eps*^2) + b4 + b5 P*` of b0 to b5, eps*, P*.
pub fn knee_paper_eq11(x: &[f64]) -> f64 {
    let [b0, b1, b2, b3, b4, b5] = six(x);
    let (strain, pressure) = (x[6], x[7]);
    b0 + exp(-b1 * strain + b2) + pressure * exp(-b3 * strain * strain) + b4 + b5 * pressure
}

/// Knee paper, Eq. 12: `b0 + exp(-b1 eps* + b2) + P* exp(-b3 eps* + b4 + b5 P*)` of b0 to b5, eps*, P*.
pub fn knee_paper_eq12(x: &[f64]) -> f64 {
    let [b0, b1, b2, b3, b4, b5] = six(x);
    let (strain, pressure) = (x[6], x[7]);
    b0 + exp(-b1 * strain + b2) + pressure * exp(-b3 * strain + b4 + b5 * pressure)
}
