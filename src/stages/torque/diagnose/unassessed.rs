//! The findings of a joint of which nothing is said yet.

use super::data::{Data, Reading};
use super::group::Group;
use pipeline_findings::{CampaignFindings, Design, HeldOutBy, SmallestP};
use std::collections::BTreeSet;

/// The findings of a joint of which nothing is said yet, to be searched with so many draws.
pub(super) fn unassessed(
    campaign: &str,
    simulated: bool,
    group: &Group,
    data: &Data,
    draws: usize,
) -> CampaignFindings {
    let configuration = &group.members[0].1;
    let count = |of: &dyn Fn(&Reading) -> bool| data.readings.iter().filter(|r| of(r)).count();
    let distinct = |of: fn(&Reading) -> usize| -> usize {
        let fitted = data.readings.iter().filter(|r| group.fitted[r.test]);
        fitted.map(of).collect::<BTreeSet<usize>>().len()
    };
    let outside = group.unanswered.iter().zip(&group.fitted);
    let actuators = distinct(|r| r.actuator);
    let design = Design {
        readings: count(&|r| group.fitted[r.test]),
        readings_outside_domain: outside.filter(|(_, fitted)| **fitted).map(|(n, _)| n).sum(),
        sessions: distinct(|r| r.test),
        specimens: actuators,
        readings_held_out: count(&|r| group.held[r.test]),
        held_out_by: HeldOutBy::None,
        doubtful_only: group.doubtful,
        smallest_p: SmallestP::of(draws, actuators),
    };
    CampaignFindings {
        campaign: campaign.to_owned(),
        part: Some(configuration.joint()),
        diameter_mm: configuration.diameter_mm,
        simulated,
        kind: "knee-torque".to_owned(),
        base_model: group.law.id.clone(),
        base_refitted: false,
        unit: "N.m".to_owned(),
        ..CampaignFindings::unassessed(design)
    }
}
