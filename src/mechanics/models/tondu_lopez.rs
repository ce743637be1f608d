//! Tondu and Lopez's model: the ideal braid with contraction amplified, because the ends do not follow the cylinder.
//!
//! F = pi r0^2 P (a (1 - k eps)^2 - b), a = 3/tan^2 alpha0, b = 1/sin^2 alpha0, with r0 the radius and alpha0 the braid angle at
//! rest (B. Tondu and P. Lopez, *Modeling and Control of McKibben Artificial Muscle Robot Actuators*, IEEE Control Syst. Mag. 20
//! (2000) 15). With k = 1 it is Chou and Hannaford's equation.
//!
//! Decision. No k is published for these actuators. It is the purpose of k to place the largest contraction, so k is set by the
//! specimen's own eps_620: the force ends there, k = (1 - sqrt(b/a))/eps_620, about 2.2 for a 10 mm specimen with eps_620 = 0.168. Beyond it the force is zero; the
//! parabola's second branch has no meaning. The braid is that of `ideal_braid.rs`; 40 mm is left out, for its angle is not known.

use std::f64::consts::PI;

use super::ideal_braid::{BRAID_10, BRAID_20, braid};
use super::{Citation, Coefficient, ForceModel, Prediction, Quantity, Reason, State, values};
use pipeline_numerics::real::Real;

/// The factor k with which the force ends at `eps_620`; `braid_angle` at rest in rad.
pub fn amplification<R: Real>(braid_angle: R, eps_620: R) -> R {
    // sqrt(b/a) = 1/(sqrt(3) cos alpha0).
    let end = R::constant(1.0) / (braid_angle.cos() * R::constant(3.0).sqrt());
    (-end + 1.0) / eps_620
}

/// The force in N, zero beyond the contraction at which it ends: `diameter` at rest in m, `braid_angle` at rest in rad, gauge
/// pressure in kPa.
pub fn force<R: Real>(diameter: R, braid_angle: R, k: R, eps: R, pressure_kpa: R) -> R {
    let (sine, tangent) = (braid_angle.sin(), braid_angle.tan());
    let a = R::constant(3.0) / (tangent * tangent);
    let b = R::constant(1.0) / (sine * sine);
    let shortened = (-(k * eps) + 1.0).positive_part();
    let area = diameter * diameter * (PI / 4.0);
    (area * pressure_kpa * 1000.0 * (a * shortened * shortened - b)).positive_part()
}

/// Tondu and Lopez's force model.
pub struct TonduLopez;

impl ForceModel for TonduLopez {
    fn id(&self) -> &'static str {
        "tondu_lopez"
    }
    fn title(&self) -> &'static str {
        "Tondu and Lopez 2000 (k from the free contraction)"
    }
    fn source(&self) -> Citation {
        Citation {
            short: "Tondu and Lopez 2000",
            full: "Modeling and Control of McKibben Artificial Muscle Robot Actuators, IEEE Control \
                Syst. Mag. 20, 15; braid angles of Martens and Boblan 2017",
            equations: "static force with k",
        }
    }
    fn diameters(&self) -> &'static [u32] {
        &[10, 20]
    }
    fn domain(&self) -> &'static str {
        "contraction 0 and more, any pressure and length; k from the specimen's free contraction"
    }
    fn coefficients(&self, diameter_mm: u32) -> &'static [Coefficient] {
        braid(diameter_mm)
    }
    fn evaluate(&self, diameter_mm: u32, state: &State) -> Prediction {
        let Some(eps_620) = state.free_contraction() else {
            return Prediction::outside(Reason::FreeContractionUnknown);
        };
        let [diameter, angle] = values(if diameter_mm == 10 {
            &BRAID_10
        } else {
            &BRAID_20
        });
        let (eps, k) = (state.contraction(), amplification(angle, eps_620));
        let force_n = force(diameter, angle, k, eps, state.pressure_kpa);
        let why = Reason::outside(Quantity::Contraction, eps, (0.0, 1.0), 0.01);
        Prediction::new(force_n, why)
    }
}
