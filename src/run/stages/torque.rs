//! `torque`: the torque of a campaign about its knees, and what needs no session.

use super::normalize::ROWS;
use super::parts::*;
use pipeline_torque as torque;
use pipeline_torque::reference::Reference;
use pipeline_torque::{CampaignTorque, Measured};

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: torque::VERSION,
        code: code::TORQUE,
    },
    rules: &[
        Rule {
            scope: Scope::TorqueCampaign,
            takes: every,
            inputs: &[ROWS.each("rows"), Input::Descriptions],
            options: &["torque", "fit.confidence", "diagnose"],
            run,
        },
        Rule {
            scope: Scope::ShippedKnees,
            takes: every,
            inputs: &[],
            options: &[],
            run: reference,
        },
    ],
};

/// As users name it.
pub const NAME: &str = "torque";

/// What was found of a campaign.
pub const TORQUE: Artifact<CampaignTorque> = Artifact::json(NAME, "torque.json");
/// What needs no session.
pub const REFERENCE: Artifact<Reference> = Artifact::json(NAME, "reference.json");

fn run(given: &Given) -> Result<Outputs> {
    let sessions = given.descriptions()?.into_iter().cloned();
    let measured = sessions.zip(given.each(&ROWS)?);
    let measured: Vec<Measured> = measured
        .map(|(session, rows)| Measured { session, rows })
        .collect();
    let config = given.config();
    TORQUE.alone(&torque::torque(
        given.name(),
        &measured,
        &config.torque,
        &config.diagnose,
        config.fit.confidence,
    ))
}

fn reference(_: &Given) -> Result<Outputs> {
    REFERENCE.alone(&torque::reference::reference())
}
