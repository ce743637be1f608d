//! The answers for four fixed joints as one number, so that a test can say when what is published of the loop on torque is out of date.

use super::findings_digest::of_findings;
use super::joint::KINDS;
use super::trial::search;
use pipeline::findings::CampaignFindings;
use pipeline::stages::torque::diagnose::terms::{SIZES, place};
use rayon::prelude::*;

/// First of the seeds; nobody else has them.
const FIRST_SEED: u64 = 61_400;

/// The digest of the findings: one joint of every kind, with nothing, an offset of the length, friction beside a compliance, and an insertion that is
/// elsewhere than drawn.
pub fn answers() -> String {
    let sizes: [&[(usize, f64)]; 4] = [
        &[
            (place::INSERTION_SHIFT, 8.0),
            (place::INSERTION_SHIFT + 1, -6.0),
        ],
        &[(place::LENGTH, 15.0)],
        &[(place::AXIAL, 60.0), (place::FRICTION, 0.4)],
        &[],
    ];
    let joints = KINDS.par_iter().zip(sizes.par_iter()).enumerate();
    let findings: Vec<CampaignFindings> = joints
        .map(|(k, (kind, list))| {
            let mut sizes = [0.0; SIZES];
            list.iter().for_each(|(place, size)| sizes[*place] = *size);
            search(*kind, &sizes, FIRST_SEED + k as u64)
        })
        .collect();
    of_findings(&findings)
}

/// The line of the documentation that states it.
pub fn line(answers: &str) -> String {
    format!("Answers to the four fixed joints: `{answers}`.")
}
