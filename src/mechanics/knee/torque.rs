//! Torque of an actuator about the knee: M = r F(eps*, P*, l_rest) (the paper's Eqs. 1, 5 and 10) with any registered force model.
//!
//! The actuator takes what fittings and tendon leave of the path, l_m = L_MT - 2 l_fit - l_tendon. Its contraction is
//! eps = (l_rest - l_m)/l_rest, and eps* = eps/eps_max, with eps_max that of the free actuator at 620 kPa.

use super::Beyond;
use super::path::Leg;
use crate::models::{Direction, ForceModel, Prediction, State};

/// An actuator as it is built into a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Nominal diameter, mm.
    pub diameter_mm: f64,
    /// Resting length l_rest between the clamps, m.
    pub rest_length_m: f64,
    /// Free length at 620 kPa, m; NaN where it is not known.
    pub contracted_length_m: f64,
    /// Length of one end fitting l_fit, m (0.0254 in the paper, 0.0352 after its fit).
    pub fitting_m: f64,
    /// Length of the tendon l_tendon, m; 0 without one.
    pub tendon_m: f64,
}

/// What an actuator does at an angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Torque {
    /// L_MT, m.
    pub path_length_m: f64,
    /// l_m, m.
    pub actuator_length_m: f64,
    /// eps*; NaN where the free length is not known.
    pub contraction_rel: f64,
    /// r, m, positive in extension.
    pub arm_m: f64,
    /// F, with the reason where the model extrapolates or has no answer.
    pub force: Prediction,
    /// M, N.m, positive in extension; `None` where the model has no answer.
    pub torque_nm: Option<f64>,
}

impl Setup {
    /// l_m for a path of length L_MT, both in m.
    pub fn actuator_length(&self, path_length_m: f64) -> f64 {
        path_length_m - 2.0 * self.fitting_m - self.tendon_m
    }

    /// The isometric state of the actuator at a length in m and a gauge pressure in kPa.
    pub fn state(&self, actuator_length_m: f64, pressure_kpa: f64) -> State {
        State {
            diameter_mm: self.diameter_mm,
            rest_length_m: self.rest_length_m,
            contracted_length_m: self.contracted_length_m,
            length_m: actuator_length_m,
            pressure_kpa,
            direction: Direction::Isometric,
        }
    }

    /// The torque, N.m, from a measured length of the actuator and a measured moment arm, both in m, at a gauge pressure in kPa: the paper's
    /// "back-calculated" torque (Figs. 10, 12). `None` where the model has no answer.
    pub fn back_calculated(
        &self,
        model: &dyn ForceModel,
        pressure_kpa: f64,
        actuator_length_m: f64,
        arm_m: f64,
    ) -> Option<f64> {
        let state = self.state(actuator_length_m, pressure_kpa);
        Some(arm_m * model.predict(&state).force_n()?)
    }
}

impl Leg<'_> {
    /// The torque at a gauge pressure in kPa and an angle in rad, everything but the actuator taken as rigid.
    ///
    /// # Errors
    /// If the angle lies outside the joint's or the patella's range.
    pub fn torque(
        &self,
        setup: &Setup,
        model: &dyn ForceModel,
        pressure_kpa: f64,
        angle: f64,
    ) -> Result<Torque, Beyond> {
        let geometry = self.geometry(angle)?;
        let actuator_length_m = setup.actuator_length(geometry.length_m);
        let state = setup.state(actuator_length_m, pressure_kpa);
        let force = model.predict(&state);
        Ok(Torque {
            path_length_m: geometry.length_m,
            actuator_length_m,
            contraction_rel: state.contraction_rel(),
            arm_m: geometry.arm_m,
            torque_nm: force.force_n().map(|f| geometry.arm_m * f),
            force,
        })
    }
}
