//! What is expected of a configuration over the range of its joint, for figures and for people who design a leg.

use crate::Configuration;
use crate::build::Build;
use crate::diagnose::fittings::LAWS;
use crate::point::Expected;
use pipeline_mechanics::models::{ForceModel, published};
use pipeline_numerics::statistics::mean;
use serde::{Deserialize, Serialize};

/// Steps over the range of a joint.
const STEPS: u32 = 150;
/// Readings whose pressures differ by less belong to one curve, kPa.
const ONE_PRESSURE_KPA: f64 = 40.0;

/// Curves over the angle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Angles, rad.
    pub angles_rad: Vec<f64>,
    /// Geometry at each angle, with the stated fittings.
    pub expected: Vec<Expected>,
    /// eps* at each angle with the fittings as fitted under the first of [`LAWS`]; empty without a fit.
    pub fitted_contraction_rel: Vec<f64>,
    /// Torques, one set a pressure.
    pub torques: Vec<Torques>,
    /// The fitted length of one fitting, m, by each of [`LAWS`]; empty without a fit.
    pub fitted_m: Vec<f64>,
}

/// Torques at one gauge pressure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Torques {
    /// Mean of the readings' gauge pressures, kPa.
    pub pressure_kpa: f64,
    /// Torque by each of [`LAWS`] with the stated fittings, N.m.
    pub stated: Vec<Vec<Option<f64>>>,
    /// Torque by each of [`LAWS`] with the fitted fittings, N.m; empty without a fit.
    pub fitted: Vec<Vec<Option<f64>>>,
}

/// The laws of [`LAWS`], as models.
pub fn laws() -> Vec<&'static dyn ForceModel> {
    let all = published();
    let law = |id: &&str| all.iter().find(|m| m.id() == *id).copied();
    LAWS.iter().filter_map(law).collect()
}

/// The angles over the range of a joint, rad.
pub fn angles((low, high): (f64, f64), steps: u32) -> Vec<f64> {
    let at = |k: u32| {
        let share = f64::from(k) / f64::from(steps);
        (1.0 - share) * low + share * high
    };
    (0..=steps).map(at).collect()
}

/// The curves of a configuration; `fitted_m` are the lengths of a fitting that fits found, one for each of [`LAWS`], or none.
pub fn curve(build: &Build, configuration: &Configuration, fitted_m: Vec<f64>) -> Curve {
    let leg = build.leg();
    let found = angles(leg.joint.range, STEPS).into_iter();
    let (angles_rad, expected): (Vec<f64>, Vec<Expected>) = found
        .filter_map(|angle| {
            let geometry = leg.geometry(angle).ok()?;
            Some((angle, Expected::new(build, &geometry)))
        })
        .unzip();
    let with = |fitting_m: &f64| {
        let mut other = build.clone();
        other.setup.fitting_m = *fitting_m;
        other
    };
    let fitted: Vec<Build> = fitted_m.iter().map(with).collect();
    let length = |b: &Build, e: &Expected| b.setup.actuator_length(e.path_length_m);
    let torque = |b: &Build, law: &dyn ForceModel, pressure_kpa: f64| -> Vec<Option<f64>> {
        let at = |e: &Expected| {
            let state = b.setup.state(length(b, e), pressure_kpa);
            Some(e.arm_m * law.predict(&state).force_n()?)
        };
        expected.iter().map(at).collect()
    };
    let laws = laws();
    let torques = pressures(configuration)
        .into_iter()
        .map(|pressure_kpa| {
            let stated = laws.iter().map(|law| torque(build, *law, pressure_kpa));
            let fitted = fitted.iter().zip(&laws);
            Torques {
                pressure_kpa,
                stated: stated.collect(),
                fitted: fitted
                    .map(|(b, law)| torque(b, *law, pressure_kpa))
                    .collect(),
            }
        })
        .collect();
    let relative = |b: &Build| {
        let at = |e: &Expected| b.setup.state(length(b, e), 0.0).contraction_rel();
        expected.iter().map(at).collect()
    };
    Curve {
        fitted_contraction_rel: fitted.first().map_or_else(Vec::new, relative),
        torques,
        fitted_m,
        angles_rad,
        expected,
    }
}

/// The pressures at which a configuration was measured: means of the readings that lie close together.
pub fn pressures(configuration: &Configuration) -> Vec<f64> {
    let points = configuration.tests.iter().flat_map(|t| &t.points);
    let mut all: Vec<f64> = points.map(|p| p.pressure_kpa).collect();
    all.retain(|p| p.is_finite());
    all.sort_by(f64::total_cmp);
    let groups = all.chunk_by(|a, b| b - a < ONE_PRESSURE_KPA);
    groups.map(mean).collect()
}
