//! Where the law was fitted, and what stands in for it beyond.
//!
//! The box has four sides: the resting length, eps_620, u and the gauge pressure. Inside, the exported function is the law. Outside it is
//! made of the law at other places, so that it never exceeds the largest force of the box and ends at zero:
//!
//! | beyond | takes |
//! |---|---|
//! | u below the box (stretched) | u at the edge: the force stays as it is there |
//! | u above the box | the law, which falls, up to `end` where it is slack at the highest pressure; one that would rise again fades out from there |
//! | pressure above the box | the pressure at the edge |
//! | pressure below the box | the law, which falls; below 0 kPa it is 0 kPa |
//! | a longer muscle | F0 at the edge |
//! | a shorter muscle | the smaller one of F0 there and F0 at the edge, and nothing shorter than its end caps |
//!
//! A state is inside give or take [`EDGE`], for eps computed from lengths is on an edge give or take rounding only.

use crate::law::Law;

/// Width of an edge, in the unit of its quantity.
pub const EDGE: f64 = 1e-9;
/// S up to which a muscle is slack: what rounding leaves of nothing has no slope.
pub const SLACK: f64 = 1e-12;
/// Distance in u over which a force that is not zero at the end of the law fades out.
pub const FADE: f64 = 0.25;
/// Steps in u with which the end is looked for, and how far.
const STEP: f64 = 1e-3;
const FARTHEST_STEPS: u32 = 2000;

/// Smallest and largest value.
pub type Range = (f64, f64);

/// The readings to which a law was fitted, as a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// l_rest, m.
    pub rest_length_m: Range,
    /// eps_620.
    pub contraction_620: Range,
    /// u.
    pub contraction_rel: Range,
    /// Gauge pressure, kPa.
    pub pressure_kpa: Range,
}

/// The box with the end of the law in u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// The box.
    pub fitted: Fitted,
    /// The u beyond which the law is not used.
    pub end: f64,
}

/// Arguments of the function, in its order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_620, m.
    pub contracted_length_m: f64,
    /// l, m.
    pub length_m: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
}

/// What the function gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Force, N, tension positive. NaN for arguments that describe no muscle.
    pub force_n: f64,
    /// Its derivative by the length, N/m.
    pub by_length: f64,
    /// Its derivative by the pressure, N/kPa.
    pub by_pressure: f64,
    /// Whether the state is in the box.
    pub inside: bool,
}

impl Domain {
    /// The box with the end of a law.
    pub fn new(law: &Law, fitted: Fitted) -> Self {
        Self {
            fitted,
            end: end(law, &fitted),
        }
    }

    /// The force and its derivatives at a state.
    pub fn force(&self, law: &Law, at: &State) -> Answer {
        if !is_muscle(law, at) {
            return Answer {
                force_n: f64::NAN,
                by_length: f64::NAN,
                by_pressure: f64::NAN,
                inside: false,
            };
        }
        let stroke = law.stroke_m(at.rest_length_m, at.contracted_length_m);
        let u = (at.rest_length_m - at.length_m) / stroke;
        let (lowest, highest) = (self.fitted.contraction_rel.0, self.fitted.pressure_kpa.1);
        let (v, by_kpa) = law.pressure(at.pressure_kpa.max(0.0).min(highest));
        let surface = law.surface(u.max(lowest).min(self.end), v);
        let mut answer = Answer {
            force_n: 0.0,
            by_length: 0.0,
            by_pressure: 0.0,
            inside: self.has(at, u),
        };
        let fade = 1.0 - (u - self.end).max(0.0) / FADE;
        if surface.value <= SLACK || fade <= 0.0 {
            return answer;
        }
        let largest = self.largest_n(law, at.rest_length_m);
        answer.force_n = largest * surface.value * fade;
        if (-EDGE..=highest + EDGE).contains(&at.pressure_kpa) {
            answer.by_pressure = largest * fade * surface.by_pressure * by_kpa;
        }
        if u > self.end + EDGE {
            answer.by_length = largest * surface.value / (FADE * stroke);
        } else if u >= lowest - EDGE {
            answer.by_length = -largest * surface.by_contraction / stroke;
        }
        answer
    }

    /// F0 in N, continued beyond the box.
    pub fn largest_n(&self, law: &Law, rest_length_m: f64) -> f64 {
        let (shortest, longest) = self.fitted.rest_length_m;
        let length = rest_length_m.min(longest);
        let at_edge = law.largest_n(length.max(shortest));
        law.largest_n(length).min(at_edge).max(0.0)
    }

    fn has(&self, at: &State, u: f64) -> bool {
        let in_range = |x: f64, (low, high): Range| x >= low - EDGE && x <= high + EDGE;
        let free = (at.rest_length_m - at.contracted_length_m) / at.rest_length_m;
        in_range(at.rest_length_m, self.fitted.rest_length_m)
            && in_range(free, self.fitted.contraction_620)
            && in_range(u, self.fitted.contraction_rel)
            && in_range(at.pressure_kpa, self.fitted.pressure_kpa)
    }
}

/// Whether the arguments describe a muscle; what its length and pressure are does not matter, as long as they are finite.
fn is_muscle(law: &Law, at: &State) -> bool {
    let all = [
        at.rest_length_m,
        at.contracted_length_m,
        at.length_m,
        at.pressure_kpa,
    ];
    let stroke = law.stroke_m(at.rest_length_m, at.contracted_length_m);
    all.iter().all(|x| x.is_finite())
        && at.rest_length_m > 0.0
        && at.contracted_length_m > 0.0
        && stroke > 0.0
}

/// The u at which the law is slack at the highest pressure of the box, or before which it would no longer fall: S is a straight line in v, so that
/// what holds at no pressure and at the highest one holds between them.
fn end(law: &Law, fitted: &Fitted) -> f64 {
    let edge = fitted.contraction_rel.1;
    let (highest, _) = law.pressure(fitted.pressure_kpa.1);
    let mut end = edge;
    for k in 0..=FARTHEST_STEPS {
        let u = edge + STEP * f64::from(k);
        let (vented, filled) = (law.surface(u, 0.0), law.surface(u, highest));
        let falls = vented.by_contraction <= 0.0 && filled.by_contraction <= 0.0;
        if !falls || filled.by_pressure < 0.0 {
            break;
        }
        end = u;
        if filled.value <= 0.0 {
            break;
        }
    }
    end
}
