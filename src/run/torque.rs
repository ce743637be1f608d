//! The stage `torque`: one unit a campaign, and one for what needs no session.

use crate::base::error::{Error, Result};
use crate::base::frame::{Frame, Values};
use crate::base::json;
use crate::base::session::Kind;
use crate::cache::Digest;
use crate::cache::store::Outputs;
use crate::config::{Config, flatten};
use crate::formats::discover::Discovery;
use crate::run::engine::{self, Engine, Stage, Step};
use crate::run::sessions::{ROWS, SessionResult};
use crate::stages::torque::point::Point;
use crate::stages::torque::reference::{Reference, reference};
use crate::stages::torque::{self, CampaignTorque, Configuration, Measured, Test};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

const TORQUE: Stage = Stage {
    name: "torque",
    version: torque::VERSION,
    code: engine::TORQUE,
};

const TORQUE_JSON: &str = "torque.json";
/// One row a reading, with every model's torque.
pub const POINTS: &str = "torque.parquet";
const REFERENCE_JSON: &str = "reference.json";
/// The unit that needs no session.
const SHIPPED: &str = "shipped knees";

/// The steps of the stage.
pub struct TorqueResult {
    /// Campaign ids with their steps, by id.
    pub campaigns: Vec<(String, Step)>,
    /// What needs no session; none where nobody measured torque.
    pub reference: Option<Step>,
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
    let knee = |s: &crate::base::session::Session| s.kind == Kind::KneeTorque;
    let found = discovery.sessions.iter().map(|l| &l.session);
    let campaigns: BTreeSet<&str> = found
        .filter(|s| knee(s))
        .map(|s| s.campaign.as_str())
        .collect();
    let one = |campaign: &&str| {
        let members = discovery.sessions.iter().zip(sessions);
        let members: Vec<(&crate::base::session::Session, &SessionResult)> = members
            .map(|(located, result)| (&located.session, result))
            .filter(|(s, _)| knee(s) && s.campaign == **campaign)
            .collect();
        let step = campaign_step(engine, campaign, &members, config)?;
        Ok(((*campaign).to_owned(), step))
    };
    let campaigns: Vec<(String, Step)> = campaigns
        .iter()
        .collect::<Vec<_>>()
        .par_iter()
        .map(|c| one(c))
        .collect::<Result<_>>()?;
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

fn campaign_step(
    engine: &Engine,
    campaign: &str,
    members: &[(&crate::base::session::Session, &SessionResult)],
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
        let found = torque::torque(campaign, &measured, &config.torque, confidence);
        Ok(Outputs::from([
            (TORQUE_JSON.to_owned(), to_json(&found)?),
            (POINTS.to_owned(), points_frame(&found).to_parquet()?),
        ]))
    })
}

fn to_json(value: &impl serde::Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec(value).map_err(Error::internal)
}

/// The readings of a campaign as a tidy table, units in the column names.
pub fn points_frame(found: &CampaignTorque) -> Frame {
    type Reading<'a> = (&'a Configuration, &'a Test, &'a Point);
    let all: Vec<Reading> = found
        .configurations
        .iter()
        .flat_map(|c| c.tests.iter().map(move |t| (c, t)))
        .flat_map(|(c, t)| t.points.iter().map(move |p| (c, t, p)))
        .collect();
    let texts =
        |f: &dyn Fn(&Reading) -> String| Values::Text(all.iter().map(|x| Some(f(x))).collect());
    let numbers = |f: &dyn Fn(&Reading) -> Option<f64>| {
        Values::Number(all.iter().map(|x| f(x).unwrap_or(f64::NAN)).collect())
    };
    let expected =
        |f: fn(&torque::point::Expected) -> f64| numbers(&move |x| x.2.expected.as_ref().map(f));
    let mut frame = Frame::default()
        .with("session", texts(&|x| x.1.session.clone()))
        .with("campaign", texts(&|_| found.campaign.clone()))
        .with("configuration", texts(&|x| x.0.id.clone()))
        .with("specimen", texts(&|x| x.0.specimen.clone()))
        .with("knee", texts(&|x| x.0.knee.clone()))
        .with("muscle", texts(&|x| x.0.muscle.clone()))
        .with("log", texts(&|x| x.2.log.clone()))
        .with(
            "row",
            Values::Integer(all.iter().map(|x| Some(x.2.row)).collect()),
        )
        .with(
            "excluded",
            Values::Integer(
                all.iter()
                    .map(|x| Some(i64::from(x.1.excluded.is_some())))
                    .collect(),
            ),
        )
        .with("angle_rad", numbers(&|x| Some(x.2.angle_rad)))
        .with("pressure_kpa", numbers(&|x| Some(x.2.pressure_kpa)))
        .with("torque_nm", numbers(&|x| Some(x.2.torque_nm)))
        .with("muscle_length_m", numbers(&|x| x.2.by_hand.length_m))
        .with("moment_arm_m", numbers(&|x| x.2.by_hand.arm_m))
        .with("contraction_rel", numbers(&|x| x.2.by_hand.contraction_rel))
        .with("expected_path_length_m", expected(|e| e.path_length_m))
        .with("expected_length_m", expected(|e| e.length_m))
        .with("expected_contraction_rel", expected(|e| e.contraction_rel))
        .with("expected_arm_m", expected(|e| e.arm_m))
        .with("projected_arm_m", expected(|e| e.projected_arm_m));
    for (k, model) in found.models.iter().enumerate() {
        let predicted = numbers(&|x| x.2.predicted[k].torque_nm);
        let back = numbers(&|x| x.2.back_calculated[k]);
        frame = frame
            .with(&format!("torque_nm by {}", model.id), predicted)
            .with(&format!("torque_nm by hand and {}", model.id), back);
    }
    frame
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
