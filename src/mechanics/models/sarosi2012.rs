//! Sarosi's static force function with six coefficients.
//!
//! F = (a1 p + a2) exp(a3 k) + a4 p k + a5 p + a6, with p in bar and k the contraction in percent of the resting length: absolute,
//! not relative to the specimen's free contraction (Sarosi 2012; also Sarosi et al. 2017).
//!
//! Decisions. The function becomes negative beyond the free length; an actuator does not push, so the force is zero there. For
//! 20 mm there are two sets, fitted to actuators of 200 and 400 mm; the set of the nearer resting length is taken, the longer one
//! at 300 mm. The coefficients know nothing else of the length.

use super::gate::Reference;
use super::{Citation, Coefficient, ForceModel, Prediction, Quantity, Reason, State, values};
use pipeline_numerics::real::Real;

/// The force in N before its negative part is cut off: `pressure_bar` in bar, `contraction_percent` in percent.
pub fn force_signed<R: Real>(a: [R; 6], pressure_bar: R, contraction_percent: R) -> R {
    let [a1, a2, a3, a4, a5, a6] = a;
    let decay = (a1 * pressure_bar + a2) * (a3 * contraction_percent).exp();
    decay + a4 * pressure_bar * contraction_percent + a5 * pressure_bar + a6
}

const fn set(symbols: [&'static str; 6], a: [f64; 6]) -> [Coefficient; 6] {
    [
        Coefficient::new(symbols[0], a[0], "N/bar"),
        Coefficient::new(symbols[1], a[1], "N"),
        Coefficient::new(symbols[2], a[2], "1/%"),
        Coefficient::new(symbols[3], a[3], "N/(bar %)"),
        Coefficient::new(symbols[4], a[4], "N/bar"),
        Coefficient::new(symbols[5], a[5], "N"),
    ]
}

/// 10 mm.
pub static PUBLISHED_10: [Coefficient; 6] = set(
    ["a1", "a2", "a3", "a4", "a5", "a6"],
    [
        -9.2194029,
        203.7012413,
        -0.34221042,
        -3.2255991,
        109.2038216,
        -208.372034,
    ],
);

/// 20 mm: the set of the 200 mm actuator, then the set of the 400 mm actuator.
pub static PUBLISHED_20: [[Coefficient; 6]; 2] = [
    set(
        [
            "a1 (200 mm)",
            "a2 (200 mm)",
            "a3 (200 mm)",
            "a4 (200 mm)",
            "a5 (200 mm)",
            "a6 (200 mm)",
        ],
        [
            -4.00180705,
            292.4620246,
            -0.32930845,
            -9.33564098,
            294.0538256,
            -280.498151,
        ],
    ),
    set(
        [
            "a1 (400 mm)",
            "a2 (400 mm)",
            "a3 (400 mm)",
            "a4 (400 mm)",
            "a5 (400 mm)",
            "a6 (400 mm)",
        ],
        [
            -4.35573, 281.22370, -0.32866, -9.27035, 302.20107, -263.69185,
        ],
    ),
];

/// Resting length from which the 400 mm set is the nearer one, m.
const NEARER_400_M: f64 = 0.3;

/// Sarosi's force model.
pub struct Sarosi2012;

impl ForceModel for Sarosi2012 {
    fn id(&self) -> &'static str {
        "sarosi2012"
    }
    fn title(&self) -> &'static str {
        "Sarosi 2012 (six coefficients)"
    }
    fn source(&self) -> Citation {
        Citation {
            short: "Sarosi 2012",
            full: "New approximation algorithm for the force of fluidic muscles; compared in Sarosi \
                et al. 2017",
            equations: "six-coefficient force function",
        }
    }
    fn diameters(&self) -> &'static [u32] {
        &[10, 20]
    }
    fn domain(&self) -> &'static str {
        "contraction 0 to 0.25, up to 620 kPa; 20 mm fitted at 200 and 400 mm, the nearer \
            set is taken, extrapolated outside 200-400 mm"
    }
    fn coefficients(&self, diameter_mm: u32) -> &'static [Coefficient] {
        match diameter_mm {
            10 => &PUBLISHED_10,
            20 => PUBLISHED_20.as_flattened(),
            _ => &[],
        }
    }
    fn references(&self) -> Vec<Reference> {
        let check = |diameter_mm, points: &[(f64, f64, f64)]| Reference {
            diameter_mm,
            against: "check values, computed apart from this program",
            points: points
                .iter()
                .map(|(rest, eps, force)| {
                    (
                        State::relative(diameter_mm, *rest, 0.2, eps / 0.2, 620.0),
                        *force,
                    )
                })
                .collect(),
            claimed: None,
            allowed: 1e-4,
        };
        let twenty = [
            (0.2, 0.0, 1810.29),
            (0.2, 0.1, 973.77),
            (0.4, 0.0, 1864.17),
            (0.4, 0.1, 1044.70),
        ];
        vec![
            check(10, &[(0.25, 0.0, 615.23), (0.25, 0.1, 273.49)]),
            check(20, &twenty),
        ]
    }
    fn evaluate(&self, diameter_mm: u32, state: &State) -> Prediction {
        let (rest, eps) = (state.rest_length_m, state.contraction());
        let a = match diameter_mm {
            10 => &PUBLISHED_10,
            _ if rest < NEARER_400_M => &PUBLISHED_20[0],
            _ => &PUBLISHED_20[1],
        };
        let p = state.pressure_kpa;
        let force_n = force_signed(values(a), p / 100.0, 100.0 * eps).positive_part();
        let lengths = Reason::outside(Quantity::RestLength, rest, (0.2, 0.4), 0.0005)
            .filter(|_| diameter_mm == 20);
        let why = lengths.or(Reason::above_supply(p)).or(Reason::outside(
            Quantity::Contraction,
            eps,
            (0.0, 0.25),
            0.01,
        )
        .filter(|_| force_n > 0.0));
        Prediction::new(force_n, why)
    }
}
