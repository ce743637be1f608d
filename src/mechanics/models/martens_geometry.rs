//! The geometry that Martens and Boblan's equations need, and the readings of it that were tried against the authors' maps.
//!
//! The published text gives the coefficients of the modulus but leaves the geometry to be taken from nominal sizes, and the unit of
//! delta open. Each reading stands here with its measured miss; `scripts/fit_martens_geometry.py` found the fitted ones.

use pipeline_numerics::real::Real;

/// Nominal braid angle of the Festo muscles against their axis, rad (28.6 deg).
pub const NOMINAL_ANGLE_RAD: f64 = 28.6_f64.to_radians();

/// An actuator at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<R> {
    /// Resting length L0, m.
    pub rest_length_m: R,
    /// Diameter D0, m.
    pub diameter_m: R,
    /// Wall thickness H0, m.
    pub wall_m: R,
    /// Braid angle theta0 against the axis, rad.
    pub braid_angle: R,
}

impl<R: Real> Geometry<R> {
    /// L_f = L0/cos theta0, m: the length at which the actuator has no more diameter.
    pub fn thread_length(&self) -> R {
        self.rest_length_m / self.braid_angle.cos()
    }
}

/// One reading of the published geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedGeometry {
    /// Nominal diameter of the actuator, mm.
    pub diameter_mm: u32,
    /// How the paper was read and what was fitted.
    pub reading: &'static str,
    /// The geometry.
    pub geometry: Geometry<f64>,
    /// Largest miss of the authors' own map, fraction of the map's largest force.
    pub miss: f64,
}

const fn reading(
    diameter_mm: u32,
    reading: &'static str,
    [rest, diameter, wall, braid_angle]: [f64; 4],
    miss: f64,
) -> NamedGeometry {
    NamedGeometry {
        diameter_mm,
        reading,
        geometry: Geometry {
            rest_length_m: rest,
            diameter_m: diameter,
            wall_m: wall,
            braid_angle,
        },
        miss,
    }
}

const DEGREES_10: f64 = 28.5_f64.to_radians();
const DEGREES_20: f64 = 28.527_f64.to_radians();
const RADIANS_10: f64 = NOMINAL_ANGLE_RAD - 0.1;
const RADIANS_20: f64 = NOMINAL_ANGLE_RAD - 0.073;

const DEGREES_NOMINAL: &str = "delta in degrees, nominal L0 and D0, H0 2 mm";
const DEGREES_FITTED: &str = "delta in degrees, L0, D0 and H0 fitted";
const RADIANS_NOMINAL: &str = "delta in radians, nominal L0 and D0, H0 1.8 mm";
const RADIANS_FITTED: &str = "delta in radians, L0, D0 and H0 fitted";

/// The readings, the one used for predictions last for each diameter.
pub static GEOMETRIES: [NamedGeometry; 8] = [
    reading(
        10,
        DEGREES_NOMINAL,
        [0.250, 0.010, 0.002, DEGREES_10],
        0.4557,
    ),
    reading(
        10,
        DEGREES_FITTED,
        [0.25182, 0.01424, 0.00367, DEGREES_10],
        0.0176,
    ),
    reading(
        10,
        RADIANS_NOMINAL,
        [0.250, 0.010, 0.0018, RADIANS_10],
        0.0741,
    ),
    reading(
        10,
        RADIANS_FITTED,
        [0.25150, 0.01064, 0.00195, RADIANS_10],
        0.0145,
    ),
    reading(
        20,
        DEGREES_NOMINAL,
        [0.300, 0.020, 0.002, DEGREES_20],
        0.3336,
    ),
    reading(
        20,
        DEGREES_FITTED,
        [0.29995, 0.02457, 0.00287, DEGREES_20],
        0.0347,
    ),
    reading(
        20,
        RADIANS_NOMINAL,
        [0.300, 0.020, 0.0018, RADIANS_20],
        0.0237,
    ),
    reading(
        20,
        RADIANS_FITTED,
        [0.29936, 0.01982, 0.00181, RADIANS_20],
        0.0207,
    ),
];
