//! The stage `torque`: one unit a campaign, and one for what needs no session.

use crate::engine::{self, Engine};
use crate::sessions::{ROWS, SessionResult};
use crate::step::{Stage, Step};
use pipeline_base::digest::Digest;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_base::json;
use pipeline_base::session::{Kind, Session};
use pipeline_config::{Config, flatten};
use pipeline_findings::CampaignFindings;
use pipeline_formats::discover::Discovery;
use pipeline_torque as torque;
use pipeline_torque::reference::{Reference, reference};
use pipeline_torque::{CampaignTorque, Measured};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

const TORQUE: Stage = Stage {
    name: "torque",
    version: torque::VERSION,
    code: engine::TORQUE,
};

const TORQUE_JSON: &str = "torque.json";
const REFERENCE_JSON: &str = "reference.json";
/// The unit that needs no session.
pub const SHIPPED: &str = "shipped knees";

/// The steps of the stage.
pub struct TorqueResult {
    /// Campaign ids with their steps, by id.
    pub campaigns: Vec<(String, Step)>,
    /// What needs no session; none where nobody measured torque.
    pub reference: Option<Step>,
}

/// The campaigns in which torque was measured, by id.
pub fn campaigns(discovery: &Discovery) -> Vec<&str> {
    let found = discovery.sessions.iter().map(|l| &l.session);
    let knees = found.filter(|s| s.kind == Kind::KneeTorque);
    let campaigns: BTreeSet<&str> = knees.map(|s| s.campaign.as_str()).collect();
    campaigns.into_iter().collect()
}

/// Whether a session is one of torque in a campaign.
pub fn belongs(campaign: &str, session: &Session) -> bool {
    session.kind == Kind::KneeTorque && session.campaign == campaign
}

/// Brings the torque of all campaigns up to date.
///
/// # Errors
/// System errors of the store, damaged entries.
pub fn process(
    engine: &Engine,
    discovery: &Discovery,
    sessions: &[SessionResult],
    config: &Config,
) -> Result<TorqueResult> {
    let campaigns = campaigns(discovery);
    let one = |campaign: &&str| {
        let members = discovery.sessions.iter().zip(sessions);
        let members: Vec<(&Session, &SessionResult)> = members
            .map(|(located, result)| (&located.session, result))
            .filter(|(s, _)| belongs(campaign, s))
            .collect();
        let step = campaign_step(engine, campaign, &members, config)?;
        Ok(((*campaign).to_owned(), step))
    };
    let campaigns: Vec<(String, Step)> = campaigns.par_iter().map(one).collect::<Result<_>>()?;
    let reference = (!campaigns.is_empty()).then(|| {
        engine.step(TORQUE, SHIPPED, BTreeMap::new(), BTreeMap::new(), || {
            let bytes = to_json(&reference())?;
            Ok(Outputs::from([(REFERENCE_JSON.to_owned(), bytes)]))
        })
    });
    Ok(TorqueResult {
        campaigns,
        reference: reference.transpose()?,
    })
}

/// The findings of the campaigns that this run has computed, joint by joint.
///
/// # Errors
/// A damaged entry.
pub fn fresh_findings(engine: &Engine, result: &TorqueResult) -> Result<Vec<CampaignFindings>> {
    let mut all = Vec::new();
    for (_, step) in &result.campaigns {
        if let Step::Done(..) = step {
            let found: CampaignTorque = json::from_slice(&engine.read(step, TORQUE_JSON)?)?;
            all.extend(found.diagnoses.into_iter().map(|d| d.findings));
        }
    }
    Ok(all)
}

fn campaign_step(
    engine: &Engine,
    campaign: &str,
    members: &[(&Session, &SessionResult)],
    config: &Config,
) -> Result<Step> {
    let mut inputs = BTreeMap::new();
    for (session, result) in members {
        let Some(rows) = result.normalize.entry().and_then(|e| e.outputs.get(ROWS)) else {
            return engine.waits(TORQUE, campaign, &format!("normalize of {}", result.id));
        };
        inputs.insert(format!("{} rows", result.id), rows.digest.clone());
        let description = Digest::of(&to_json(session)?);
        inputs.insert(format!("{} session.toml", result.id), description);
    }
    let confidence = config.fit.confidence;
    let mut options = flatten("torque", &config.torque)?;
    options.insert("fit.confidence".to_owned(), confidence.to_string());
    options.extend(flatten("diagnose", &config.diagnose)?);
    engine.step(TORQUE, campaign, options, inputs, || {
        let measured: Vec<Measured> = members
            .iter()
            .map(|(session, result)| {
                Ok(Measured {
                    session: (*session).clone(),
                    rows: result.rows(engine)?,
                })
            })
            .collect::<Result<_>>()?;
        let found = torque::torque(
            campaign,
            &measured,
            &config.torque,
            &config.diagnose,
            confidence,
        );
        Ok(Outputs::from([(TORQUE_JSON.to_owned(), to_json(&found)?)]))
    })
}

fn to_json(value: &impl serde::Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec(value).map_err(Error::internal)
}

impl TorqueResult {
    /// What was found of each campaign, by id.
    ///
    /// # Errors
    /// A damaged entry.
    pub fn campaigns(&self, engine: &Engine) -> Result<Vec<CampaignTorque>> {
        let steps = self.campaigns.iter();
        steps
            .map(|(_, step)| json::from_slice(&engine.read(step, TORQUE_JSON)?))
            .collect()
    }

    /// What needs no session.
    ///
    /// # Errors
    /// A damaged entry.
    pub fn reference(&self, engine: &Engine) -> Result<Option<Reference>> {
        match &self.reference {
            Some(step) => json::from_slice(&engine.read(step, REFERENCE_JSON)?).map(Some),
            None => Ok(None),
        }
    }
}
