//! The loop on torque: what a rigid leg lacks, as the second problem of the one engine ([`pipeline_inference`]); that of force is the first
//! ([`pipeline_diagnose`]).
//!
//! One joint at a time: the sessions of one diameter whose actuators run along one route over one knee, because route, fittings and brackets are theirs.
//! The law of force is the published one and is not refitted: a knee has too few pressures and lengths to determine it. What its coefficients are off by
//! is a random effect of the joint.
//!
//! | file | idea |
//! |---|---|
//! | [`terms`] | the effects, with unit, bounds and source |
//! | [`operator`] | torque, length and arm with effects, force in balance at every angle, with derivatives |
//! | [`data`] | the readings of a joint, with everything that is known of each |
//! | [`sides`] | which torques may be of slack actuators |
//! | [`library`] | the terms that may be added: forms of effects, and smooth functions of columns |
//! | [`problem`] | the joint as the engine sees it: groups, nuisance components, readings of torque, length and arm |
//! | [`settings`] | what is plausible of a joint |
//! | [`recording`] | mistakes of recording: torques of the other sign, tests that the others make too improbable |
//! | [`mistakes`] | the usual mistakes of a test, each taken back |
//! | `group` | everything of one joint, ready to be searched |
//! | `joint` | one joint: the readings that are searched, the search, what is asked of it |
//! | `unassessed` | the findings of a joint of which nothing is said yet |
//! | [`unseen`] | the same search without each actuator; errors, predictive intervals, the budget of the expected error |
//! | [`limits`] | what could have been seen, and what is indistinguishable |
//! | [`fittings`] | the length of the end fittings, plain least squares as in the paper: a query of the engine |
//! | [`answer`] | the [`pipeline_findings`], as values |
//! | [`by_test`] | errors of every test: rigid, fitted, held out, and with sizes from the largest configuration alone |
//! | [`measurers`] | beside what was reached by hand |
//! | [`curves`] | torque over the angle before and after, for figures |
//!
//! With one actuator or two, effects have estimates like any other; what is said of unseen actuators needs two.

pub mod answer;
pub mod by_test;
pub mod curves;
pub mod data;
pub mod fittings;
mod group;
mod joint;
pub mod library;
pub mod limits;
pub mod measurers;
pub mod mistakes;
pub mod operator;
pub mod problem;
pub mod recording;
pub mod settings;
pub mod sides;
pub mod terms;
mod unassessed;
pub mod unseen;

pub use group::Group;

use crate::Configuration;
use crate::build::Build;
use by_test::TestErrors;
use curves::BeforeAfter;
use measurers::ByHand;
use pipeline_config::{DiagnoseOptions, FitOptions};
use pipeline_diagnose::base::Base;
use pipeline_findings::{CampaignFindings, Residuals};
use pipeline_mechanics::models::published;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What was found of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointDiagnosis {
    /// The findings.
    pub findings: CampaignFindings,
    /// One entry a torque of the search.
    #[serde(default)]
    pub residuals: Residuals,
    /// Errors by test.
    pub tests: Vec<TestErrors>,
    /// What the measurers reached by hand, where they had the actuator.
    pub by_hand: Vec<ByHand>,
    /// Torques over the angle, before and after.
    pub curves: Vec<BeforeAfter>,
}

/// The findings of every joint of a campaign.
pub fn diagnose(
    campaign: &str,
    simulated: bool,
    found: &[(Build, Configuration)],
    options: &DiagnoseOptions,
) -> Vec<JointDiagnosis> {
    let mut joints: Vec<Vec<&(Build, Configuration)>> = Vec::new();
    for member in found {
        let same = |(b, c): &(Build, Configuration)| {
            b.knee == member.0.knee
                && b.route == member.0.route
                && c.diameter_mm == member.1.diameter_mm
        };
        match joints.iter_mut().find(|j| same(j[0])) {
            Some(joint) => joint.push(member),
            None => joints.push(vec![member]),
        }
    }
    let laws: Vec<Option<Base>> = joints.iter().map(|j| law(j[0].1.diameter_mm)).collect();
    let groups = joints.into_iter().zip(&laws);
    let groups: Vec<Group> = groups
        .filter_map(|(j, law)| Some(Group::new(j, law.as_ref()?)))
        .collect();
    groups
        .par_iter()
        .map(|group| joint::one(campaign, simulated, group, options))
        .collect()
}

/// The law of force of a diameter: that of the force paper, or where it has none that of the knee paper.
fn law(diameter_mm: u32) -> Option<Base> {
    let known = |id: &str| {
        let all = published();
        let law = all.iter().find(|m| m.id() == id);
        law.is_some_and(|m| m.diameters().contains(&diameter_mm))
    };
    if known("new_published") {
        return Some(Base::new(diameter_mm, false, 1, &FitOptions::default()));
    }
    known("knee_paper")
        .then(|| Base::published("knee_paper", false))
        .flatten()
}
