//! Axial stress in the wall of an actuator that closes itself at both ends (the paper's Eqs. 13 and 14).
//!
//! Erratum. The paper calls d the mean diameter. The force P pi d^2/4 on the closed end and the ring pi ((d + 2t)^2 - d^2)/4 that carries it
//! are those of Eq. 13 only with d the *inner* diameter. With the mean diameter in Eq. 13 the stress of a 10 mm actuator with a wall of 1.5 mm
//! comes out 17% too high. In Eq. 14 the two differ by terms of the order t/d, which it leaves out anyway.

use pipeline_numerics::real::Real;

/// sigma_z of a thick wall (Eq. 13), in the unit of the pressure: gauge pressure, inner diameter and wall thickness (the latter two in one unit).
pub fn thick_wall<R: Real>(pressure: R, inner_diameter: R, wall: R) -> R {
    let outer = inner_diameter + wall * 2.0;
    let ring = outer * outer - inner_diameter * inner_diameter;
    pressure * inner_diameter * inner_diameter / ring
}

/// sigma_z of a thin wall (Eq. 14), the limit of Eq. 13 for t much smaller than d; same units.
pub fn thin_wall<R: Real>(pressure: R, diameter: R, wall: R) -> R {
    pressure * diameter / (wall * 4.0)
}
