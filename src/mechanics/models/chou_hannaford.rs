//! Chou and Hannaford's ideal McKibben actuator: a braid without rubber, friction or ends.
//!
//! F = (pi D0^2 P/4)(3 cos^2 theta - 1), with D0 the diameter at a braid angle of 90 degrees and theta the present angle against
//! the axis (C.-P. Chou and B. Hannaford, *Measurement and Modeling of McKibben Pneumatic Artificial Muscles*, IEEE Trans. Robot.
//! Autom. 12 (1996) 90). The threads keep their length, so cos theta = (1 - eps) cos theta0 and D0 = D_rest/sin theta0.
//!
//! A floor for the comparison: nothing is fitted. Without rubber it contracts to about 0.37, more than twice what a Festo muscle
//! does. The braid angles are those of Martens and Boblan, see `ideal_braid.rs`; 40 mm is left out, for its angle is not known.

use std::f64::consts::PI;

use super::ideal_braid::{BRAID_10, BRAID_20, braid};
use super::{Citation, Coefficient, ForceModel, Prediction, Quantity, Reason, State, values};
use pipeline_numerics::real::Real;

/// The force in N before its negative part is cut off: `diameter` at rest in m, `braid_angle` at rest in rad, gauge pressure in
/// kPa. Domain: (1 - eps) cos theta0 <= 1.
pub fn force_signed<R: Real>(diameter: R, braid_angle: R, eps: R, pressure_kpa: R) -> R {
    let sine = braid_angle.sin();
    let cosine = (-eps + 1.0) * braid_angle.cos();
    let area = diameter * diameter / (sine * sine) * (PI / 4.0);
    area * pressure_kpa * 1000.0 * (cosine * cosine * 3.0 - 1.0)
}

/// Chou and Hannaford's force model.
pub struct ChouHannaford;

impl ForceModel for ChouHannaford {
    fn id(&self) -> &'static str {
        "chou_hannaford"
    }
    fn title(&self) -> &'static str {
        "Chou and Hannaford 1996 (ideal braid)"
    }
    fn source(&self) -> Citation {
        Citation {
            short: "Chou and Hannaford 1996",
            full: "Measurement and Modeling of McKibben Pneumatic Artificial Muscles, IEEE Trans. \
                Robot. Autom. 12, 90; braid angles of Martens and Boblan 2017",
            equations: "ideal braid",
        }
    }
    fn diameters(&self) -> &'static [u32] {
        &[10, 20]
    }
    fn domain(&self) -> &'static str {
        "any pressure and length at which the threads are not yet straight; nothing is fitted"
    }
    fn coefficients(&self, diameter_mm: u32) -> &'static [Coefficient] {
        braid(diameter_mm)
    }
    fn evaluate(&self, diameter_mm: u32, state: &State) -> Prediction {
        let [diameter, angle] = values(if diameter_mm == 10 {
            &BRAID_10
        } else {
            &BRAID_20
        });
        let eps = state.contraction();
        let straight = 1.0 - 1.0 / Real::cos(angle);
        if let Some(why) = Reason::outside(Quantity::Contraction, eps, (straight, 1.0), 0.0) {
            return Prediction::outside(why);
        }
        let force_n = force_signed(diameter, angle, eps, state.pressure_kpa).positive_part();
        Prediction::new(force_n, None)
    }
}
