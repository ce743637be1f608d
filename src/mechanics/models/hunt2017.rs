//! Hunt's model of the 10 mm actuator: the pressure as a function of force and contraction, solved for the force.
//!
//! P = p0 + A tan(w (eps/(eps_max - k F) - q)) + g F + h S, with P in kPa, F in N, S = +1 shortening, -1 lengthening, 0 isometric
//! (Hunt, Graber-Tilton and Quinn 2017, with the corrected coefficients of the knee paper's Eq. 4). `eps_max` is the specimen's own
//! eps_620.
//!
//! Erratum: Eq. 1 of the force paper prints eps/eps_max - k F inside the tangent; that diverges at eps* = 1. Eq. 4 of the knee
//! paper is right, with q inside the bracket that w multiplies.
//!
//! For 0 < eps the right side rises with F from P(0) to infinity at F_pole = (eps_max - eps/x_pole)/k, where
//! x_pole = q + pi/(2 w) = 1.2361: there is one root, F = 0 where P(0) >= P. At eps = 0 the equation is linear in F. A stretched
//! actuator (eps < 0) is not described: the tangent would fall with F.
//!
//! The root is found in `f64` by Newton's method kept inside a bisection; one further Newton step in the caller's number type makes
//! its derivatives exact, by the implicit function theorem: dF = (dP - sum of dP/dx_i dx_i)/(dP/dF).

use std::f64::consts::FRAC_PI_2;

use super::gate::Reference;
use super::{
    Citation, Coefficient, Direction, ForceModel, Prediction, Quantity, Reason, State, values,
};
use pipeline_numerics::real::{Dual, Real};

/// The coefficients in the order p0, A, w, q, k, g, h.
pub static PUBLISHED_10: [Coefficient; 7] = [
    Coefficient::new("p0", 254.3, "kPa"),
    Coefficient::new("A", 192.0, "kPa"),
    Coefficient::new("w", 2.0265, "1"),
    Coefficient::new("q", 0.4609, "1"),
    Coefficient::new("k", 0.331e-3, "1/N"),
    Coefficient::new("g", 1.229, "kPa/N"),
    Coefficient::new("h", 15.6, "kPa"),
];

/// Largest force in the data that the model was fitted to, N (24 lbf).
pub const FITTED_UP_TO_N: f64 = 107.0;

/// The gauge pressure in kPa that holds the force `force` (N) at the contraction `eps`; `c` is p0, A, w, q, k, g, h and `s` the
/// hysteresis factor. Meaningful below the pole.
pub fn pressure<R: Real>(c: [R; 7], force: R, eps: R, eps_max: R, s: f64) -> R {
    let [p0, a, w, q, k, g, h] = c;
    let strain = eps / (eps_max - k * force);
    p0 + a * (w * (strain - q)).tan() + g * force + h * s
}

/// The force in N at a gauge pressure in kPa, zero where the actuator is slack. Domain: `eps >= 0`, `eps_max > 0`.
pub fn force<R: Real>(c: [R; 7], pressure_kpa: R, eps: R, eps_max: R, s: f64) -> R {
    let value = c.map(Real::value);
    let root = root(value, pressure_kpa.value(), eps.value(), eps_max.value(), s);
    if root <= 0.0 {
        return R::constant(0.0);
    }
    let (_, slope) = gap(value, 0.0, root, eps.value(), eps_max.value(), s);
    let start = R::constant(root);
    start - (pressure(c, start, eps, eps_max, s) - pressure_kpa) / slope
}

/// The same, not cut off where the actuator would push, and with its slope at no contraction for one that is stretched: for fits, in which lengths
/// and coefficients move.
pub fn force_signed<R: Real>(c: [R; 7], pressure_kpa: R, eps: R, eps_max: R) -> R {
    let eps_in = if eps.value() < 0.0 {
        R::constant(0.0)
    } else {
        eps
    };
    let value = c.map(Real::value);
    let (target, e, e_max) = (pressure_kpa.value(), eps_in.value(), eps_max.value());
    let root = signed_root(value, target, e, e_max);
    let (_, slope) = gap(value, 0.0, root, e, e_max, 0.0);
    let start = R::constant(root);
    let force = start - (pressure(c, start, eps_in, eps_max, 0.0) - pressure_kpa) / slope;
    let [_, a, w, q, k, g, _] = c;
    let tangent = (w * q).tan();
    let by_strain = a * w * (tangent * tangent + 1.0) / (g * (eps_max - k * force));
    force - by_strain * (eps - eps_in)
}

/// P(F) - `target` and dP/dF.
fn gap(c: [f64; 7], target: f64, force: f64, eps: f64, eps_max: f64, s: f64) -> (f64, f64) {
    let constant = Dual::<1>::constant;
    let force = Dual::<1>::variable(force, 0);
    // Written out: `array::map` is not unrolled, and a diagnosis with this model as its base spends its time here.
    let [p0, a, w, q, k, g, h] = c;
    let c = [
        constant(p0),
        constant(a),
        constant(w),
        constant(q),
        constant(k),
        constant(g),
        constant(h),
    ];
    let p = pressure(c, force, constant(eps), constant(eps_max), s);
    (p.value - target, p.gradient[0])
}

/// The force at which the tangent goes to infinity, N; not positive where the actuator is slack at any pressure.
fn pole(c: [f64; 7], eps: f64, eps_max: f64) -> f64 {
    let [_, _, w, q, k, ..] = c;
    (eps_max - eps / (q + FRAC_PI_2 / w)) / k
}

/// The one root in [0, F_pole), or 0.
fn root(c: [f64; 7], target: f64, eps: f64, eps_max: f64, s: f64) -> f64 {
    let (at_zero, _) = gap(c, target, 0.0, eps, eps_max, s);
    if pole(c, eps, eps_max) <= 0.0 || at_zero >= 0.0 {
        return 0.0;
    }
    root_above(0.0, c, target, eps, eps_max, s)
}

/// The one root of either sign between the poles of the tangent, where the pressure rises with the force from minus to plus infinity. Both poles may be at
/// forces that push.
fn signed_root(c: [f64; 7], target: f64, eps: f64, eps_max: f64) -> f64 {
    let [_, _, w, q, k, ..] = c;
    // The strain is then the same at any force.
    if k == 0.0 {
        return linear_root(c, target, eps, eps_max, 0.0);
    }
    let pole = pole(c, eps, eps_max);
    let lowest_strain = q - FRAC_PI_2 / w;
    let low = if lowest_strain > 0.0 {
        (eps_max - eps / lowest_strain) / k
    } else {
        let is_above =
            |force: f64| force >= pole || gap(c, target, force, eps, eps_max, 0.0).0 > 0.0;
        let (mut low, mut step) = (pole.min(0.0), 100.0);
        while is_above(low) && step < 1e12 {
            low -= step;
            step *= 2.0;
        }
        low
    };
    root_above(low, c, target, eps, eps_max, 0.0)
}

/// The root where the pressure is linear in the force.
fn linear_root(c: [f64; 7], target: f64, eps: f64, eps_max: f64, s: f64) -> f64 {
    let (at_zero, slope) = gap(c, target, 0.0, eps, eps_max, s);
    -at_zero / slope
}

/// The one root between a force that is below it and the pole.
fn root_above(from: f64, c: [f64; 7], target: f64, eps: f64, eps_max: f64, s: f64) -> f64 {
    if eps == 0.0 {
        return linear_root(c, target, eps, eps_max, s);
    }
    let pole = pole(c, eps, eps_max);
    let (mut low, mut high, mut force) = (from, pole, 0.5 * (from + pole));
    let mut before_last = pole - from;
    let mut last = pole - from;
    for _ in 0..200 {
        let (gap, slope) = gap(c, target, force, eps, eps_max, s);
        if gap > 0.0 {
            high = force;
        } else {
            low = force;
        }
        let newton = force - gap / slope;
        // Newton's step must stay inside and shrink fast enough, else the bracket is halved.
        let good = newton > low && newton < high && 2.0 * (newton - force).abs() < before_last;
        let next = if good { newton } else { 0.5 * (low + high) };
        before_last = last;
        last = (next - force).abs();
        force = next;
        if last <= 1e-14 * (pole - from) {
            break;
        }
    }
    force
}

/// Hunt's force model.
pub struct Hunt2017;

impl ForceModel for Hunt2017 {
    fn id(&self) -> &'static str {
        "hunt2017"
    }
    fn title(&self) -> &'static str {
        "Hunt 2017 (implicit)"
    }
    fn source(&self) -> Citation {
        Citation {
            short: "Hunt et al. 2017",
            full: "Modeling Length Effects of Braided Pneumatic Actuators, ASME IDETC 2017; \
                coefficients as corrected in the knee paper",
            equations: "knee paper Eq. 4; force paper Eq. 1, corrected",
        }
    }
    fn diameters(&self) -> &'static [u32] {
        &[10]
    }
    fn domain(&self) -> &'static str {
        "10 mm, contraction 0 and more, up to 620 kPa, fitted up to 107 N; extrapolated \
            above, nothing for a stretched actuator"
    }
    fn coefficients(&self, diameter_mm: u32) -> &'static [Coefficient] {
        match diameter_mm {
            10 => &PUBLISHED_10,
            _ => &[],
        }
    }
    fn references(&self) -> Vec<Reference> {
        let at = |direction, kpa, rel, force| {
            let state = State::relative(10, 0.3, 0.168, rel, kpa);
            (State { direction, ..state }, force)
        };
        vec![Reference {
            diameter_mm: 10,
            against: "check values of the corrected equation, solved apart from this program",
            points: vec![
                at(Direction::Isometric, 620.0, 0.5, 181.016),
                at(Direction::Shortening, 620.0, 0.5, 175.052),
                at(Direction::Lengthening, 620.0, 0.5, 186.735),
                at(Direction::Isometric, 300.0, 0.25, 88.918),
                at(Direction::Isometric, 620.0, 1.0, 0.0),
            ],
            claimed: None,
            allowed: 1e-4,
        }]
    }
    fn evaluate(&self, _diameter_mm: u32, state: &State) -> Prediction {
        let Some(eps_max) = state.free_contraction() else {
            return Prediction::outside(Reason::FreeContractionUnknown);
        };
        let eps = state.contraction();
        if let Some(why) = Reason::outside(Quantity::Contraction, eps, (0.0, 1.0), 0.0) {
            return Prediction::outside(why);
        }
        let (p, s) = (state.pressure_kpa, state.direction.sign());
        let force_n = force(values(&PUBLISHED_10), p, eps, eps_max, s);
        let why = Reason::outside(Quantity::Force, force_n, (0.0, FITTED_UP_TO_N), 0.0)
            .or(Reason::above_supply(p));
        Prediction::new(force_n.max(0.0), why)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EPS_MAX: f64 = 0.166;

    fn c() -> [f64; 7] {
        values(&PUBLISHED_10)
    }

    #[test]
    fn where_the_actuator_pulls_the_law_of_fits_is_the_published_one() {
        for (kpa, eps) in [(620.0, 0.0), (620.0, 0.05), (300.0, 0.03), (450.0, 0.1)] {
            let pulls = force(c(), kpa, eps, EPS_MAX, 0.0);
            assert!(pulls > 1.0);
            let signed = force_signed(c(), kpa, eps, EPS_MAX);
            assert!((signed - pulls).abs() < 1e-9 * pulls, "{kpa} {eps}");
        }
    }

    #[test]
    fn where_it_would_push_the_law_of_fits_is_the_negative_root() {
        let signed = force_signed(c(), 100.0, 0.12, EPS_MAX);
        assert!(signed < -50.0, "{signed}");
        let back = pressure(c(), signed, 0.12, EPS_MAX, 0.0);
        assert!((back - 100.0).abs() < 1e-9, "{back}");
    }

    #[test]
    fn the_law_of_fits_is_a_root_wherever_a_fit_may_go() {
        // Corners of the bounds of a fit, and the published k, which is beyond them.
        let mut roots = 0;
        for (w, q) in [
            (0.2, -0.5),
            (0.2, 1.5),
            (2.0265, 0.4609),
            (3.0, -0.5),
            (3.0, 1.5),
        ] {
            for (a, g) in [(1.0, 0.2), (192.0, 1.229), (2000.0, 10.0)] {
                for k in [0.0, 1e-9, 1e-5, 0.331e-3] {
                    for (kpa, eps) in [(620.0, 0.02), (100.0, 0.19), (620.0, 0.23), (0.0, 0.3)] {
                        let c = [254.3, a, w, q, k, g, 0.0];
                        let found = force_signed(c, kpa, eps, EPS_MAX);
                        assert!(found.is_finite(), "{c:?} {kpa} {eps}: {found}");
                        let back = pressure(c, found, eps, EPS_MAX, 0.0);
                        // Where the tangent is steep a digit of the force is many of the pressure.
                        let (_, slope) = gap(c, kpa, found, eps, EPS_MAX, 0.0);
                        let off = ((back - kpa) / slope).abs();
                        assert!(
                            off < 1e-6 * (1.0 + found.abs()),
                            "{c:?} {kpa} {eps}: {found} {off}"
                        );
                        assert!(slope > 0.0, "{c:?} {kpa} {eps}: {slope}");
                        roots += 1;
                    }
                }
            }
        }
        assert_eq!(roots, 240);
    }

    #[test]
    fn derivatives_of_the_law_of_fits_are_those_by_differences_on_either_side_of_no_contraction() {
        const N: usize = 10;
        for (kpa, eps) in [(300.0, 0.05), (100.0, 0.12), (300.0, -0.004)] {
            let all: Vec<f64> = c().into_iter().chain([kpa, eps, EPS_MAX]).collect();
            let at = |x: &[f64]| {
                let c = std::array::from_fn(|k| x[k]);
                force_signed(c, x[7], x[8], x[9])
            };
            let duals: Vec<Dual<N>> = (0..N).map(|k| Dual::variable(all[k], k)).collect();
            let coefficients = std::array::from_fn(|k| duals[k]);
            let exact = force_signed(coefficients, duals[7], duals[8], duals[9]);
            for k in (0..N).filter(|k| *k != 6) {
                let step = 1e-6 * all[k].abs();
                let moved = |by: f64| {
                    let mut x = all.clone();
                    x[k] += by;
                    at(&x)
                };
                let slope = (moved(step) - moved(-step)) / (2.0 * step);
                let allowed = 1e-5 * slope.abs() + 1e-9 / step;
                assert!(
                    (exact.gradient[k] - slope).abs() <= allowed,
                    "{kpa} {eps} {k}: {} {slope}",
                    exact.gradient[k]
                );
            }
        }
    }
}
