//! The figures of torque, one file each.

mod configuration;
mod design;
mod human;
mod joint;
mod leg;
mod maximum;
mod surfaces;

use super::{Composed, compose};
use crate::input::ReportInput;
use pipeline_torque::diagnose::JointDiagnosis;
use pipeline_torque::{CampaignTorque, Configuration};
use std::collections::BTreeSet;

/// The figures of one campaign: one a configuration, then one a joint.
pub fn of_campaign(campaign: &CampaignTorque) -> Vec<Option<Composed>> {
    let configuration = |c: &Configuration| {
        let name = configuration::name(campaign, c);
        compose(&name, || Some(configuration::figure(campaign, c)))
    };
    let joint = |j: &JointDiagnosis| {
        let name = joint::name(campaign, j);
        compose(&name, || joint::figure(campaign, j))
    };
    let configurations = campaign.configurations.iter().map(configuration);
    let joints = campaign.diagnoses.iter().map(joint);
    configurations.chain(joints).collect()
}

/// The legs that are used, each once.
pub fn legs(input: &ReportInput) -> Vec<Option<Composed>> {
    let mut seen = BTreeSet::new();
    let configurations = input.torque().iter().flat_map(|c| &c.configurations);
    configurations
        .filter(|c| seen.insert(leg::name(c)))
        .map(|c| compose(&leg::name(c), || Some(leg::figure(c))))
        .collect()
}

/// The figures that no campaign of torque has for itself: the laws of force, and the human muscles.
pub fn once(input: &ReportInput) -> Vec<Option<Composed>> {
    let Some(knee) = &input.knee else {
        return Vec::new();
    };
    let reference = &knee.reference;
    vec![
        compose(maximum::NAME, || Some(maximum::figure(input))),
        compose(surfaces::NAME, || Some(surfaces::figure(input))),
        compose(human::NAME, || Some(human::figure(reference))),
        compose(design::NAME, || Some(design::figure(reference))),
    ]
}

/// The knee angle's axis, degrees.
fn angle_axis() -> crate::plot::Axis {
    crate::plot::Axis::new("Knee angle θ (°)")
}

/// Points over an angle given in rad; what there is not parts the line.
fn over_angle<'a>(
    angles_rad: &'a [f64],
    values: impl IntoIterator<Item = f64> + 'a,
) -> Vec<(f64, f64)> {
    let angles = angles_rad.iter().map(|a| a.to_degrees());
    angles.zip(values).collect()
}
