//! The torque of a muscle in a leg that somebody describes, over the range of the knee, beside a human muscle: whether this muscle at this place
//! meets it, and where not.

use crate::answer::Predictor;
use crate::muscle::{Contraction, MOST_STRETCHED};
use pipeline_base::error::Result;
use pipeline_mechanics::knee::human::{self, meets};
use pipeline_mechanics::knee::{Knee, Leg, Setup, choice};
use serde::Serialize;

/// Contractions beyond which there is no state of a muscle to ask for: stretched beyond what its braid bears, or pushed together.
const CONTRACTIONS: (f64, f64) = (-MOST_STRETCHED, 1.0);

/// Where the muscle is built in.
#[derive(Clone, Copy)]
pub struct Built<'a> {
    /// Joint and route.
    pub leg: Leg<'a>,
    /// l_fit, m.
    pub fitting_m: f64,
    /// l_tendon, m.
    pub tendon_m: f64,
}

/// A human muscle to be met.
#[derive(Clone)]
pub struct Target {
    /// Its name, one of [`human::NAMES`].
    pub name: String,
    knee: Knee,
    heads: &'static [&'static str],
}

/// The torque at one angle. Angles in degrees, as people give them; flexion is negative.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtAngle {
    /// Knee angle, degrees.
    pub angle_deg: f64,
    /// l_m, m.
    pub length_m: f64,
    /// eps*; none where eps_620 is unknown.
    pub contraction_rel: Option<f64>,
    /// r, m, with the sign of the torque.
    pub arm_m: f64,
    /// F, N; none where the law gives nothing.
    pub force_n: Option<f64>,
    /// M, N.m.
    pub torque_nm: Option<f64>,
    /// Its interval for a muscle that was not measured, N.m, where there is one: weaker end, stronger end.
    pub interval_nm: Option<(f64, f64)>,
    /// Torque of the human muscle, N.m; none beyond the range of its knee.
    pub human_nm: Option<f64>,
    /// Whether the muscle meets it; none where one of them is not known.
    pub meets: Option<bool>,
    /// What a user has to know: what lies outside of what was measured or is allowed.
    pub warnings: Vec<String>,
    /// That the force is far from what the rig reads, because effects were taken off as the rig's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inferred: Option<String>,
}

impl Target {
    /// The human muscle of this name; none for a name that is unknown.
    pub fn named(name: &str) -> Option<Self> {
        Some(Self {
            heads: human::heads(name)?,
            knee: choice::named("gait2392")?,
            name: name.to_owned(),
        })
    }

    /// The human muscle that a route stands for: vasti where the path pulls the knee straight in the middle of its range, else bifemsh.
    pub fn usual(leg: &Leg) -> Option<Self> {
        let (low, high) = leg.joint.range;
        let extends = leg.arm(0.5 * (low + high)).is_ok_and(|arm| arm > 0.0);
        Self::named(if extends { "vasti" } else { "bifemsh" })
    }

    fn torque(&self, angle: f64) -> Option<f64> {
        human::torque(&self.knee, self.heads, angle)
    }
}

/// The torque at a gauge pressure in kPa over the range of the joint, every `step_deg` degrees from its most flexed angle on.
///
/// # Errors
/// An eps_620 that the law needs and nobody gave; a pressure that is none.
pub fn over_the_range(
    predictor: &Predictor,
    built: &Built,
    target: Option<&Target>,
    pressure_kpa: f64,
    step_deg: f64,
) -> Result<Vec<AtAngle>> {
    let (low, high) = built.leg.joint.range;
    // Ends are given in whole or half degrees; what conversion adds to them is no angle.
    let degrees = |angle: f64| (1e6 * angle.to_degrees()).round() / 1e6;
    let (low, high) = (degrees(low), degrees(high));
    // On whole steps inside the range, and at its ends.
    let first = (low / step_deg).ceil();
    let last = (high / step_deg).floor();
    let steps = (0..=(last - first).max(0.0) as usize).map(|k| (first + k as f64) * step_deg);
    let inside = steps.filter(|a| (low..=high).contains(a));
    let mut angles: Vec<f64> = [low].into_iter().chain(inside).chain([high]).collect();
    angles.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let at = |degrees: &f64| at_angle(predictor, built, target, pressure_kpa, *degrees);
    let found: Vec<Option<AtAngle>> = angles.iter().map(at).collect::<Result<_>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// None where the leg has no geometry.
fn at_angle(
    predictor: &Predictor,
    built: &Built,
    target: Option<&Target>,
    pressure_kpa: f64,
    angle_deg: f64,
) -> Result<Option<AtAngle>> {
    // The ends of the range, which rounding may put outside.
    let (low, high) = built.leg.joint.range;
    let angle = angle_deg.to_radians().clamp(low, high);
    let Ok(geometry) = built.leg.geometry(angle) else {
        return Ok(None);
    };
    let muscle = &predictor.muscle;
    let setup = Setup {
        diameter_mm: f64::from(muscle.diameter_mm),
        rest_length_m: muscle.rest_length_m,
        contracted_length_m: f64::NAN,
        fitting_m: built.fitting_m,
        tendon_m: built.tendon_m,
    };
    let length_m = setup.actuator_length(geometry.length_m);
    let arm_m = geometry.arm_m;
    let human_nm = target.and_then(|t| t.torque(angle));
    let length = Contraction::Length(length_m);
    let contraction = (muscle.rest_length_m - length_m) / muscle.rest_length_m;
    let mut found = AtAngle {
        angle_deg,
        length_m,
        contraction_rel: length.relative(muscle.rest_length_m, muscle.contraction_620),
        arm_m,
        force_n: None,
        torque_nm: None,
        interval_nm: None,
        human_nm,
        meets: None,
        warnings: Vec::new(),
        inferred: None,
    };
    if let Some(why) = impossible(contraction) {
        found.warnings.push(why);
        return Ok(Some(found));
    }
    let answer = predictor.at(length, pressure_kpa)?;
    found.force_n = answer.force_n;
    // A slack flexor has no torque, not minus none.
    let torque = |force: f64| arm_m * force + 0.0;
    found.torque_nm = answer.force_n.map(torque);
    found.interval_nm = answer.interval.map(|i| (torque(i.low_n), torque(i.high_n)));
    found.meets = found.torque_nm.zip(human_nm).map(|(t, h)| meets(t, h));
    found.warnings = answer.warnings;
    found.inferred = answer.inferred;
    Ok(Some(found))
}

/// Why a muscle cannot have a contraction, if it cannot.
pub(crate) fn impossible(contraction: f64) -> Option<String> {
    let (stretched, pushed) = CONTRACTIONS;
    if contraction < stretched {
        return Some(format!(
            "the path stretches the muscle by {:.0}%, and a braid bears no more than {:.0}%: no force; a longer muscle, or shorter fittings or tendon",
            -100.0 * contraction,
            -100.0 * stretched
        ));
    }
    (contraction >= pushed).then(|| "the path leaves the muscle no length".to_owned())
}

/// The stretches of angle in which the muscle meets the human one, degrees.
pub fn met(found: &[AtAngle]) -> Vec<(f64, f64)> {
    let known: Vec<&AtAngle> = found.iter().filter(|a| a.human_nm.is_some()).collect();
    let angles: Vec<f64> = known.iter().map(|a| a.angle_deg).collect();
    let humans: Vec<f64> = known.iter().filter_map(|a| a.human_nm).collect();
    let torques: Vec<Option<f64>> = known.iter().map(|a| a.torque_nm).collect();
    human::met(&angles, &humans, &torques)
}

/// The same where nothing warns of the prediction: an angle at which it is extrapolated counts as not known.
pub fn met_within_data(found: &[AtAngle]) -> Vec<(f64, f64)> {
    let mut within = found.to_vec();
    for at in within.iter_mut().filter(|a| !a.warnings.is_empty()) {
        at.torque_nm = None;
    }
    met(&within)
}

/// Where the muscle falls furthest short of the human one: the angle in degrees, and what is missing in N.m; none where it never does.
pub fn shortest(found: &[AtAngle]) -> Option<(f64, f64)> {
    let missing = |a: &AtAngle| {
        let human = a.human_nm?;
        Some((a.angle_deg, human.abs() - a.torque_nm? * human.signum()))
    };
    let all = found.iter().filter_map(missing);
    all.filter(|(_, missing)| *missing > 0.0)
        .max_by(|a, b| a.1.total_cmp(&b.1))
}
