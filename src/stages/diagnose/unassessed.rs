//! The findings of a campaign of which nothing is said yet.

use crate::base::Base;
use crate::data::Data;
use pipeline_findings::{CampaignFindings, Design, Errors, HeldOutBy, Verdict};
use pipeline_fit::Group;
use std::collections::BTreeSet;

/// The findings of a campaign of which nothing is said yet.
pub(crate) fn unassessed(
    group: &Group,
    base: &Base,
    data: &Data,
    outside: usize,
    kept_out: &BTreeSet<&str>,
) -> CampaignFindings {
    let held = |s: &&usize| kept_out.contains(data.sessions[**s].as_str());
    let held = data.session.iter().filter(held).count();
    CampaignFindings {
        campaign: group.campaign.clone(),
        part: None,
        diameter_mm: group.diameter_mm,
        simulated: group.simulated,
        kind: "isometric".to_owned(),
        base_model: base.id.clone(),
        base_refitted: base.coefficients.iter().any(|c| c.free),
        unit: "N".to_owned(),
        design: Design {
            readings: data.len() - held,
            readings_outside_domain: outside,
            sessions: data.sessions.len() - kept_out.len(),
            specimens: data.specimens.len(),
            readings_held_out: held,
            held_out_by: HeldOutBy::None,
            doubtful_only: false,
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
