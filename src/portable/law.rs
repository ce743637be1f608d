//! The law in the one form that every language has, with its derivatives.
//!
//! ```text
//! F  = F0(l_rest) max(0, S(u, v))
//! F0 = (f0 + b1 atan(b2 (l_rest - l_0))) (1 + k1 (l_rest - l_mid) + k2 l_mid (1 - l_mid/l_rest))
//! S  = s0 + s1 exp(-s2 u) + v (s3 exp(-(s4 u + s5 u^2)) + s6)
//! u  = (l_rest - l)/(l_rest - l_620), or (l_rest - l)/(l_rest eps_max) of a law that knows no l_620
//! v  = P'/P_ref,  P' = max(0, P - p1) - p2 (1 - exp(-P/p2))
//! ```
//! The new model (force paper, Eqs. 5 to 9) is s0 = -c0, s1 = c0, s2 = c1, s3 = 1, s5 = c2; Eqs. 9, 11 and 12 of the knee paper fill
//! in the others. k1 and k2 are the two forms of [`rest_length_scaling`], p1 and p2 those of [`bladder_threshold`]: 0 where the loop has
//! not found them.
//!
//! [`rest_length_scaling`]: pipeline_effects::rest_length_scaling
//! [`bladder_threshold`]: pipeline_effects::bladder_threshold

/// The coefficients, in m, kPa and N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// f0, N: a maximum force that does not depend on the resting length.
    pub constant_n: f64,
    /// b1, N.
    pub b1_n: f64,
    /// b2, 1/m.
    pub b2_per_m: f64,
    /// l_0, m: the length at which the end caps touch.
    pub cap_length_m: f64,
    /// k1, 1/m.
    pub length_linear_per_m: f64,
    /// k2, 1/m.
    pub length_saturating_per_m: f64,
    /// l_mid, m.
    pub middle_length_m: f64,
    /// eps_max; 0 where the law takes the muscle's own l_620.
    pub contraction_max: f64,
    /// P_ref, kPa.
    pub reference_kpa: f64,
    /// p1, kPa.
    pub threshold_sharp_kpa: f64,
    /// p2, kPa.
    pub threshold_gradual_kpa: f64,
    /// s0 to s6.
    pub surface: [f64; 7],
}

/// S and its derivatives by u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// S.
    pub value: f64,
    /// dS/du.
    pub by_contraction: f64,
    /// dS/dv.
    pub by_pressure: f64,
}

impl Law {
    /// The new model's surface (Eq. 8) from c0, c1, c2.
    pub fn new_surface([c0, c1, c2]: [f64; 3]) -> [f64; 7] {
        [-c0, c0, c1, 1.0, 0.0, c2, 0.0]
    }

    /// F0 in N at a resting length in m; negative below l_0.
    pub fn largest_n(&self, rest_length_m: f64) -> f64 {
        let arc = self.b2_per_m * (rest_length_m - self.cap_length_m);
        let middle = self.middle_length_m;
        let scale = 1.0
            + self.length_linear_per_m * (rest_length_m - middle)
            + self.length_saturating_per_m * middle * (1.0 - middle / rest_length_m);
        (self.constant_n + self.b1_n * libm::atan(arc)) * scale
    }

    /// l_rest - l at u = 1, m.
    pub fn stroke_m(&self, rest_length_m: f64, contracted_length_m: f64) -> f64 {
        if self.contraction_max > 0.0 {
            return rest_length_m * self.contraction_max;
        }
        rest_length_m - contracted_length_m
    }

    /// v and dv/dP, the latter in 1/kPa, at a gauge pressure in kPa.
    pub fn pressure(&self, pressure_kpa: f64) -> (f64, f64) {
        let (mut pressure, mut slope) = (pressure_kpa - self.threshold_sharp_kpa, 1.0);
        if pressure < 0.0 {
            (pressure, slope) = (0.0, 0.0);
        }
        let gradual = self.threshold_gradual_kpa;
        if gradual > 0.0 {
            let left = libm::exp(-pressure_kpa / gradual);
            pressure -= gradual * (1.0 - left);
            slope -= left;
        }
        (pressure / self.reference_kpa, slope / self.reference_kpa)
    }

    /// S at u and v.
    pub fn surface(&self, u: f64, v: f64) -> Surface {
        let [s0, s1, s2, s3, s4, s5, s6] = self.surface;
        let relaxing = s1 * libm::exp(-s2 * u);
        let pressing = s3 * libm::exp(-(s4 * u + s5 * u * u));
        Surface {
            value: s0 + relaxing + v * (pressing + s6),
            by_contraction: -s2 * relaxing - v * pressing * (s4 + 2.0 * s5 * u),
            by_pressure: pressing + s6,
        }
    }
}
