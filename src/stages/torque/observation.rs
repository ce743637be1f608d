//! Measured torques as fits see them: with their leg, and a prediction that carries derivatives.

use crate::knee::{Published, Pull};
use crate::models::ForceModel;
use crate::numerics::real::Real;
use crate::stages::torque::build::Build;
use crate::stages::torque::{Configuration, Test};

/// A measured torque, with everything that its prediction needs but the length of the fittings.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The leg and the actuator in it.
    pub build: &'a Build,
    /// The configuration.
    pub configuration: &'a Configuration,
    /// The session.
    pub test: &'a Test,
    /// Knee angle, rad.
    pub angle_rad: f64,
    /// Measured torque, N.m.
    pub torque_nm: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// L_MT, m.
    pub path_length_m: f64,
    /// r, m.
    pub arm_m: f64,
}

impl Observation<'_> {
    /// The torque by a model with fittings of this length in m, N.m; `R` carries derivatives. NaN where the model has no answer.
    pub fn torque<R: Real>(&self, model: &dyn ForceModel, fitting: R) -> R {
        let setup = &self.build.setup;
        let pull = Published {
            model,
            setup,
            pressure_kpa: self.pressure_kpa,
        };
        let length = -(fitting * 2.0) + (self.path_length_m - setup.tendon_m);
        pull.force(length) * self.arm_m
    }
}

/// The observations of a configuration that are not left out, in the order of its tests.
pub fn observations<'a>(
    build: &'a Build,
    configuration: &'a Configuration,
) -> Vec<Observation<'a>> {
    let tests = configuration.tests.iter().filter(|t| !t.is_left_out());
    tests
        .flat_map(|test| test.points.iter().map(move |p| (test, p)))
        .filter_map(|(test, p)| {
            let e = p.expected.as_ref()?;
            Some(Observation {
                build,
                configuration,
                test,
                angle_rad: p.angle_rad,
                torque_nm: p.torque_nm,
                pressure_kpa: p.pressure_kpa,
                path_length_m: e.path_length_m,
                arm_m: e.arm_m,
            })
        })
        .filter(|o| o.torque_nm.is_finite() && o.pressure_kpa.is_finite())
        .collect()
}
