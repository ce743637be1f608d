//! A Hill-type muscle: isometric force at full activation, with an elastic tendon in equilibrium with the fibres.
//!
//! The curves are those of Thelen, *Journal of Biomechanical Engineering* 125, 2003, pp. 70-77, with the parameters of OpenSim's Gait2392. The
//! knee paper names Millard et al., *Journal of Biomechanical Engineering* 135, 2013, but the exports decide: torque over moment arm of the three
//! vasti is Thelen's tendon force within 0.2% over the whole range. Fibres have a constant thickness, so that their pennation grows as they
//! shorten, sin(alpha) = h/l_M (both papers).

use super::Beyond;
use super::path::Leg;

/// Strain of the tendon at maximum isometric force (`FmaxTendonStrain` of Gait2392).
const TENDON_STRAIN: f64 = 0.033;
/// Passive strain of the fibres at maximum isometric force (`FmaxMuscleStrain`).
const FIBRE_STRAIN: f64 = 0.6;
/// Shape of the active curve (`KshapeActive`).
const ACTIVE_SHAPE: f64 = 0.5;
/// Shape of the passive curve (`KshapePassive`).
const PASSIVE_SHAPE: f64 = 4.0;
/// Force and shape of the tendon's toe (Thelen 2003, text below Eq. 5).
const TOE_FORCE: f64 = 0.33;
const TOE_SHAPE: f64 = 3.0;
/// Halvings of the interval in which the equilibrium is sought: from a metre to below a rounding error.
const HALVINGS: usize = 60;

/// Parameters of a muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscle {
    /// Maximum isometric force, N.
    pub f_max_n: f64,
    /// Optimal length of the fibres, m.
    pub optimal_fibre_m: f64,
    /// Slack length of the tendon, m.
    pub tendon_slack_m: f64,
    /// Pennation at the optimal length, rad.
    pub pennation_rad: f64,
}

/// A muscle in equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// Force of the tendon, N.
    pub tension_n: f64,
    /// Length of the fibres, m.
    pub fibre_m: f64,
    /// Length of the tendon, m.
    pub tendon_m: f64,
}

/// Force of the fully active fibres over maximum, at a length over optimal (Thelen 2003, Eq. 4): exp(-(l - 1)^2/gamma).
pub fn active(length: f64) -> f64 {
    libm::exp(-(length - 1.0) * (length - 1.0) / ACTIVE_SHAPE)
}

/// Force of the passive fibres over maximum, at a length over optimal (Thelen 2003, Eq. 3); none below 1.
pub fn passive(length: f64) -> f64 {
    let stretch = (length - 1.0).max(0.0) / FIBRE_STRAIN;
    libm::expm1(PASSIVE_SHAPE * stretch) / libm::expm1(PASSIVE_SHAPE)
}

/// Force of the tendon over maximum, at a strain (Thelen 2003, Eq. 5): an exponential toe, then a straight line; none when slack.
pub fn tendon(strain: f64) -> f64 {
    let e3 = libm::exp(3.0);
    let toe = 99.0 * TENDON_STRAIN * e3 / (166.0 * e3 - 67.0);
    if strain <= 0.0 {
        0.0
    } else if strain < toe {
        TOE_FORCE * libm::expm1(TOE_SHAPE * strain / toe) / libm::expm1(TOE_SHAPE)
    } else {
        TOE_FORCE + 0.67 / (TENDON_STRAIN - toe) * (strain - toe)
    }
}

impl Muscle {
    /// The equilibrium at a musculotendon length L_MT in m, fully active and isometric: the fibres' share along the tendon equals the tendon's
    /// force. A path that is shorter than the slack tendon leaves it without force.
    pub fn equilibrium(&self, path_length_m: f64) -> Equilibrium {
        let thickness = self.optimal_fibre_m * libm::sin(self.pennation_rad);
        let (mut low, mut high) = (0.0, (path_length_m - self.tendon_slack_m).max(0.0));
        let at = |along: f64| {
            let fibre_m = libm::hypot(along, thickness);
            let length = fibre_m / self.optimal_fibre_m;
            let pull = (active(length) + passive(length)) * along / fibre_m;
            (fibre_m, pull)
        };
        let strain = |along: f64| (path_length_m - along) / self.tendon_slack_m - 1.0;
        // The fibres' projection on the tendon: at 0 they pull at right angles, at the upper end the tendon is slack.
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if at(middle).1 < tendon(strain(middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Equilibrium {
            tension_n: self.f_max_n * tendon(strain(high)),
            fibre_m: at(high).0,
            tendon_m: path_length_m - high,
        }
    }
}

impl Leg<'_> {
    /// The torque of a fully active muscle along the route at an angle in rad, N.m, positive in extension.
    ///
    /// # Errors
    /// If the angle lies outside the joint's or the patella's range.
    pub fn muscle_torque(&self, muscle: &Muscle, angle: f64) -> Result<f64, Beyond> {
        let geometry = self.geometry(angle)?;
        Ok(geometry.arm_m * muscle.equilibrium(geometry.length_m).tension_n)
    }
}
