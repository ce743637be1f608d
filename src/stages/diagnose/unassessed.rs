//! The findings of a campaign of which nothing is said yet.

use crate::base::Base;
use crate::data::Data;
use pipeline_findings::{CampaignFindings, Design, HeldOutBy, SmallestP};
use pipeline_fit::Group;
use std::collections::BTreeSet;

/// The findings of a campaign of which nothing is said yet, to be searched with so many draws.
pub(crate) fn unassessed(
    group: &Group,
    (base, draws): (&Base, usize),
    data: &Data,
    outside: usize,
    kept_out: &BTreeSet<&str>,
) -> CampaignFindings {
    let held = |s: &&usize| kept_out.contains(data.sessions[**s].as_str());
    let held = data.session.iter().filter(held).count();
    let design = Design {
        readings: data.len() - held,
        readings_outside_domain: outside,
        sessions: data.sessions.len() - kept_out.len(),
        specimens: data.specimens.len(),
        readings_held_out: held,
        held_out_by: HeldOutBy::None,
        doubtful_only: false,
        smallest_p: SmallestP::of(draws, data.specimens.len()),
    };
    CampaignFindings {
        campaign: group.campaign.clone(),
        part: None,
        diameter_mm: group.diameter_mm,
        simulated: group.simulated,
        kind: "isometric".to_owned(),
        base_model: base.id.clone(),
        base_refitted: base.coefficients.iter().any(|c| c.free),
        unit: "N".to_owned(),
        ..CampaignFindings::unassessed(design)
    }
}
