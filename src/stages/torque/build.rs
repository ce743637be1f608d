//! How the actuator of a session is built into a leg.

use pipeline_base::session::Session;
use pipeline_config::TorqueOptions;
use pipeline_mechanics::knee::{Knee, Leg, Setup, choice};

/// A leg with an actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Build {
    /// The knee.
    pub knee: Knee,
    /// Name of the route.
    pub route: String,
    /// The actuator with fittings and tendon.
    pub setup: Setup,
    /// What a reader must know of it.
    pub remarks: Vec<String>,
}

impl Build {
    /// The build of a torque session; fittings that the session does not state are those of the options.
    ///
    /// # Errors
    /// Why the session has no leg, in words: its description was not checked.
    pub fn of(session: &Session, options: &TorqueOptions) -> Result<Self, String> {
        let joint = session.joint.as_ref().ok_or("the session has no joint")?;
        let specimen = &session.specimen;
        let chosen = choice::choose(joint, specimen.diameter_mm, &session.id, "session.toml")
            .map_err(|mistakes| mistakes.iter().map(ToString::to_string).collect::<String>())?;
        let mut remarks = Vec::new();
        if !chosen.remark.is_empty() {
            remarks.push(chosen.remark.to_owned());
        }
        if joint.tendon_m.is_none() {
            remarks.push("the tendon was not recorded and is taken as none".to_owned());
        }
        Ok(Self {
            knee: chosen.knee,
            route: chosen.route,
            setup: Setup {
                diameter_mm: specimen.diameter_mm,
                rest_length_m: specimen.rest_length_m,
                contracted_length_m: specimen.contracted_length_m,
                fitting_m: joint.fitting_m.unwrap_or(1e-3 * options.fitting_mm),
                tendon_m: joint.tendon_m.unwrap_or(0.0),
            },
            remarks,
        })
    }

    /// The joint with the route.
    ///
    /// # Panics
    /// Never: the route was found when the build was made.
    pub fn leg(&self) -> Leg<'_> {
        self.knee
            .leg(&self.route)
            .expect("the route was looked up when the build was made")
    }
}
