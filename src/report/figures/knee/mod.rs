//! The figures of torque, one file each.

mod configuration;
mod design;
mod human;
mod joint;
mod leg;
mod maximum;
mod surfaces;

use super::Named;
use crate::report::input::ReportInput;
use crate::stages::torque::CampaignTorque;
use std::collections::BTreeSet;

/// The figures of one campaign: one a configuration, then one a joint.
pub fn of_campaign(campaign: &CampaignTorque) -> Vec<Named> {
    let configurations = campaign.configurations.iter();
    let configurations = configurations.map(|c| configuration::figure(campaign, c));
    let joints = campaign.diagnoses.iter();
    configurations
        .chain(joints.map(|j| joint::figure(campaign, j)))
        .collect()
}

/// The legs that are used, each once.
pub fn legs(input: &ReportInput) -> Vec<Named> {
    let mut seen = BTreeSet::new();
    let configurations = input.torque().flat_map(|c| &c.configurations);
    configurations
        .filter(|c| seen.insert(leg::name(c)))
        .map(leg::figure)
        .collect()
}

/// The figures that no campaign of torque has for itself: the laws of force, and the human muscles.
pub fn once(input: &ReportInput) -> Vec<Named> {
    let Some(knee) = &input.knee else {
        return Vec::new();
    };
    vec![
        maximum::figure(input),
        surfaces::figure(input),
        human::figure(&knee.reference),
        design::figure(&knee.reference),
    ]
}

/// The knee angle's axis, degrees.
fn angle_axis() -> crate::report::plot::Axis {
    crate::report::plot::Axis::new("Knee angle θ (°)")
}

/// Points over an angle given in rad; what there is not parts the line.
fn over_angle<'a>(
    angles_rad: &'a [f64],
    values: impl IntoIterator<Item = f64> + 'a,
) -> Vec<(f64, f64)> {
    let angles = angles_rad.iter().map(|a| a.to_degrees());
    angles.zip(values).collect()
}
