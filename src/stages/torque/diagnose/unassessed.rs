//! The findings of a joint of which nothing is said yet.

use super::data::{Data, Reading};
use super::group::Group;
use pipeline_findings::{CampaignFindings, Design, Errors, HeldOutBy, Verdict};
use std::collections::BTreeSet;

/// The findings of a joint of which nothing is said yet.
pub(super) fn unassessed(
    campaign: &str,
    simulated: bool,
    group: &Group,
    data: &Data,
) -> CampaignFindings {
    let configuration = &group.members[0].1;
    let count = |of: &dyn Fn(&Reading) -> bool| data.readings.iter().filter(|r| of(r)).count();
    let distinct = |of: fn(&Reading) -> usize| -> usize {
        let fitted = data.readings.iter().filter(|r| group.fitted[r.test]);
        fitted.map(of).collect::<BTreeSet<usize>>().len()
    };
    let outside = group.unanswered.iter().zip(&group.fitted);
    CampaignFindings {
        campaign: campaign.to_owned(),
        part: Some(configuration.joint()),
        diameter_mm: configuration.diameter_mm,
        simulated,
        kind: "knee-torque".to_owned(),
        base_model: group.law.id.clone(),
        base_refitted: false,
        unit: "N.m".to_owned(),
        design: Design {
            readings: count(&|r| group.fitted[r.test]),
            readings_outside_domain: outside.filter(|(_, fitted)| **fitted).map(|(n, _)| n).sum(),
            sessions: distinct(|r| r.test),
            specimens: distinct(|r| r.actuator),
            readings_held_out: count(&|r| group.held[r.test]),
            held_out_by: HeldOutBy::None,
            doubtful_only: group.doubtful,
        },
        verdict: Verdict::NotAssessed,
        not_assessed: None,
        effects: Vec::new(),
        scatter: Vec::new(),
        misfit: None,
        unexplained: Vec::new(),
        recording_errors: Vec::new(),
        before: Errors::default(),
        after: Errors::default(),
        by_unit: Vec::new(),
        budget: Vec::new(),
        expected_rmse_heldout: None,
        inside_50: None,
        inside_95: None,
        pit: Vec::new(),
        noise: None,
        black_box_rmse_heldout: None,
        tested: Vec::new(),
        detection_limits: Vec::new(),
        not_measurable: Vec::new(),
        aliases: Vec::new(),
        next_measurement: Vec::new(),
        coefficients: Vec::new(),
        alternatives: Vec::new(),
    }
}
