//! The earlier form of the new model, as the knee paper has it; kept as its own model.
//!
//! *Isometric Torque Values About Robotic Knee Using Braided Pneumatic Actuators* (the knee paper, draft):
//! - F_max10(l, P) = a1 P atan(a2 P (l - 0.0075)) (Eq. 6); at 620 kPa 301.6 N atan(20.5 (l - 0.0075)) (Eq. 7);
//! - 10 mm: F* = -1 + exp(-c1 eps*) + P* exp(-c2 eps*^2) (Eq. 9), P* = P/620 kPa, F = F* F_max10 (Eq. 10);
//! - 20 mm: F* = b0 + exp(-b1 eps* + b2) + P* exp(-b3 eps*^2 + b4) + b5 P* (Eqs. 8 and 11), F_max = 1500 N;
//! - 40 mm: the same with eps* instead of eps*^2 in the second exponential (Eq. 12), F_max = 6000 N.
//!
//! 20 and 40 mm were fitted to Festo's curves with eps_max = 0.25 and P_max = 600 kPa, so these, and not the specimen's own free
//! contraction, make eps* and P* there.
//!
//! Errata. In Eqs. 8, 11 and 12 as printed, b2 and b4 have slipped out of their exponents (and in Eq. 12 the P* term has slipped
//! in); only the form above gives F*(0, 1) = 1 (20 mm: 1.0098, 40 mm: 1.0263). The paper prints a1 = 0.4848 N/kPa with the
//! interval (0.4848, 0.488); 620 a1 is then 300.6 N, not the 301.6 N of Eq. 7, which belongs to the interval's middle, 0.4864.
//! Eq. 7 is what the paper multiplies with (Eq. 10), and what stands here.

use super::gate::Reference;
use super::{Citation, Coefficient, ForceModel, Prediction, Quantity, Reason, State, new, values};
use pipeline_numerics::real::Real;

/// F* of the 10 mm actuator (Eq. 9), before its negative part is cut off.
pub fn surface_10<R: Real>(c: [R; 2], contraction_rel: R, pressure_rel: R) -> R {
    let [c1, c2] = c;
    let relaxation = (-(c1 * contraction_rel)).exp() - 1.0;
    relaxation + pressure_rel * (-(c2 * contraction_rel * contraction_rel)).exp()
}

/// F* of the 20 mm actuator (Eqs. 8 and 11, corrected), before its negative part is cut off.
pub fn surface_20<R: Real>(b: [R; 6], contraction_rel: R, pressure_rel: R) -> R {
    six_terms(
        b,
        contraction_rel,
        contraction_rel * contraction_rel,
        pressure_rel,
    )
}

/// F* of the 40 mm actuator (Eq. 12, corrected), before its negative part is cut off.
pub fn surface_40<R: Real>(b: [R; 6], contraction_rel: R, pressure_rel: R) -> R {
    six_terms(b, contraction_rel, contraction_rel, pressure_rel)
}

/// b0 + exp(-b1 eps* + b2) + P* exp(-b3 x + b4) + b5 P*, with x = eps*^2 (20 mm) or eps* (40 mm).
fn six_terms<R: Real>(b: [R; 6], contraction_rel: R, x: R, pressure_rel: R) -> R {
    let [b0, b1, b2, b3, b4, b5] = b;
    let relaxation = b0 + (b2 - b1 * contraction_rel).exp();
    relaxation + pressure_rel * (b4 - b3 * x).exp() + b5 * pressure_rel
}

/// 10 mm: Eqs. 7 and 9 with their intervals, and a1, a2 of Eq. 6.
pub static PUBLISHED_10: [Coefficient; 7] = [
    Coefficient::new("F_inf 2/pi", 301.6, "N"),
    Coefficient::new("b2", 20.5, "1/m"),
    Coefficient::new("l_0", 0.0075, "m"),
    Coefficient::new("a1", 0.4848, "N/kPa").with_interval(0.4848, 0.488),
    Coefficient::new("a2", 0.03306, "1/(kPa m)").with_interval(0.0325, 0.03362),
    Coefficient::new("c1", 1.7, "1").with_interval(1.692, 1.708),
    Coefficient::new("c2", 0.2, "1").with_interval(0.1968, 0.2029),
];

/// 20 mm: Eq. 11 and its normalisation.
pub static PUBLISHED_20: [Coefficient; 9] = [
    Coefficient::new("F_max", 1500.0, "N"),
    Coefficient::new("eps_max", 0.25, "1"),
    Coefficient::new("P_max", 600.0, "kPa"),
    Coefficient::new("b0", -0.1881, "1"),
    Coefficient::new("b1", 7.965, "1"),
    Coefficient::new("b2", -1.677, "1"),
    Coefficient::new("b3", 2.036, "1"),
    Coefficient::new("b4", -0.1518, "1"),
    Coefficient::new("b5", 0.1518, "1"),
];

/// 40 mm: Eq. 12 and its normalisation.
pub static PUBLISHED_40: [Coefficient; 9] = [
    Coefficient::new("F_max", 6000.0, "N"),
    Coefficient::new("eps_max", 0.25, "1"),
    Coefficient::new("P_max", 600.0, "kPa"),
    Coefficient::new("b0", -0.06974, "1"),
    Coefficient::new("b1", 8.547, "1"),
    Coefficient::new("b2", -2.6287, "1"),
    Coefficient::new("b3", 0.2854, "1"),
    Coefficient::new("b4", 1.148, "1"),
    Coefficient::new("b5", -2.128, "1"),
];

/// A surface with six coefficients: [`surface_20`] or [`surface_40`].
type Surface = fn([f64; 6], f64, f64) -> f64;

/// The force model of the knee paper.
pub struct KneePaper;

impl ForceModel for KneePaper {
    fn id(&self) -> &'static str {
        "knee_paper"
    }
    fn title(&self) -> &'static str {
        "Earlier form (knee paper)"
    }
    fn source(&self) -> Citation {
        Citation {
            short: "Bolen et al. (knee paper)",
            full: "Isometric Torque Values About Robotic Knee Using Braided Pneumatic Actuators (draft)",
            equations: "Eqs. 6-12, corrected",
        }
    }
    fn diameters(&self) -> &'static [u32] {
        &[10, 20, 40]
    }
    fn domain(&self) -> &'static str {
        "10 mm: relative contraction 0 to 1, resting length 112-518 mm, up to 620 kPa; 20 \
            and 40 mm: Festo's curves, contraction 0 to 0.25, up to 600 kPa"
    }
    fn coefficients(&self, diameter_mm: u32) -> &'static [Coefficient] {
        match diameter_mm {
            10 => &PUBLISHED_10,
            20 => &PUBLISHED_20,
            40 => &PUBLISHED_40,
            _ => &[],
        }
    }
    fn references(&self) -> Vec<Reference> {
        let own = |diameter_mm, against, (rest, kpa, force)| Reference {
            diameter_mm,
            against,
            points: vec![(State::relative(diameter_mm, rest, 0.17, 0.0, kpa), force)],
            claimed: None,
            allowed: 0.03,
        };
        vec![
            own(
                10,
                "Eq. 6 at 620 kPa against Eq. 7, 182 mm",
                (0.182, 620.0, 390.2),
            ),
            own(20, "F*(0, 1) = 1: F_max of the text", (0.3, 600.0, 1500.0)),
            own(40, "F*(0, 1) = 1: F_max of the text", (0.3, 600.0, 6000.0)),
        ]
    }
    fn evaluate(&self, diameter_mm: u32, state: &State) -> Prediction {
        match diameter_mm {
            10 => ten(state),
            20 => from_festo_curves(&PUBLISHED_20, surface_20, state),
            _ => from_festo_curves(&PUBLISHED_40, surface_40, state),
        }
    }
}

/// Eq. 10 for 10 mm.
fn ten(state: &State) -> Prediction {
    let [b1, b2, offset, _, _, c1, c2] = values(&PUBLISHED_10);
    if state.free_contraction().is_none() {
        return Prediction::outside(Reason::FreeContractionUnknown);
    }
    let rest = state.rest_length_m;
    let fraction = surface_10([c1, c2], state.contraction_rel(), state.pressure_rel());
    let force_n = fraction.positive_part() * new::f620(b1, b2, offset, rest);
    let beyond = new::beyond_data(Some((0.112, 0.518)), force_n, state);
    match beyond {
        Some(why) if rest <= offset => Prediction::outside(why),
        why => Prediction::new(force_n, why),
    }
}

/// Eq. 10 for the diameters that were fitted to Festo's curves.
fn from_festo_curves(list: &[Coefficient; 9], surface: Surface, state: &State) -> Prediction {
    let [f_max, eps_max, p_max, b @ ..] = values(list);
    let contraction = state.contraction();
    let fraction = surface(b, contraction / eps_max, state.pressure_kpa / p_max).positive_part();
    let relaxed = fraction == 0.0 && contraction > eps_max;
    let why = beyond_pressure(state, p_max).or(Reason::outside(
        Quantity::Contraction,
        contraction,
        (0.0, eps_max),
        0.01,
    )
    .filter(|_| !relaxed));
    Prediction::new(fraction * f_max, why)
}

/// Whether the pressure lies above the rig's supply; the message names the pressure that the surface was fitted up to.
fn beyond_pressure(state: &State, p_max: f64) -> Option<Reason> {
    let range = (0.0, p_max);
    Reason::above_supply(state.pressure_kpa).and(Reason::outside(
        Quantity::GaugePressure,
        state.pressure_kpa,
        range,
        0.0,
    ))
}
