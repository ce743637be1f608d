//! The stages of one group of rows: fit, compare and diagnose.

use crate::diagnosis;
use crate::engine::{self, Engine};
use crate::sessions::{ROWS, SessionResult};
use crate::step::{Stage, Step};
use pipeline_base::digest::Digest;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::{Frame, Values};
use pipeline_base::json::from_slice;
use pipeline_base::row::{self, Row};
use pipeline_base::session::{Kind, Session};
use pipeline_compare as compare;
use pipeline_compare::{GroupComparison, Predictions};
use pipeline_config::{Config, FitOptions, flatten};
use pipeline_diagnose::Diagnosis;
use pipeline_fit as fit;
use pipeline_fit::{Group, GroupFit};
use pipeline_formats::discover::Discovery;
use std::collections::BTreeMap;

const FIT: Stage = Stage {
    name: "fit",
    version: fit::VERSION,
    code: engine::FIT,
};
const COMPARE: Stage = Stage {
    name: "compare",
    version: compare::VERSION,
    code: engine::COMPARE,
};

const FIT_JSON: &str = "fit.json";
const COMPARISON_JSON: &str = "comparison.json";
/// Rows with the prediction of every model.
pub const PREDICTIONS: &str = "predictions.parquet";
const PREDICTED: &str = "force_n by ";

/// The steps of one group.
pub struct GroupResult {
    /// Which rows.
    pub group: Group,
    /// Fit.
    pub fit: Step,
    /// Compare.
    pub compare: Step,
    /// Diagnose; none for a pool of many specimens.
    pub diagnose: Option<Step>,
}

/// The groups among the isometric sessions found.
pub fn of(discovery: &Discovery, options: &FitOptions) -> Vec<Group> {
    let isometric = discovery
        .sessions
        .iter()
        .filter(|l| l.session.kind == Kind::Isometric);
    let members: Vec<(String, u32, bool)> = isometric
        .map(|l| {
            let s = &l.session;
            (
                s.campaign.clone(),
                s.specimen.diameter_mm as u32,
                s.is_simulated(),
            )
        })
        .collect();
    fit::groups(&members, options.pool)
}

/// Brings one group up to date.
///
/// # Errors
/// System errors of the store, damaged entries.
pub fn process(
    engine: &Engine,
    group: &Group,
    discovery: &Discovery,
    sessions: &[SessionResult],
    config: &Config,
) -> Result<GroupResult> {
    let members = members(group, discovery, sessions);
    let unit = unit(group);
    let is_asked = diagnosis::is_asked(group, discovery, &config.diagnose);
    let mut inputs = BTreeMap::from([("group".to_owned(), Digest::of(&json(group)?))]);
    for member in &members {
        match member.normalize.entry().and_then(|e| e.outputs.get(ROWS)) {
            Some(object) => inputs.insert(member.id.clone(), object.digest.clone()),
            None => {
                return all_wait(
                    engine,
                    group,
                    is_asked,
                    &format!("normalize of {}", member.id),
                );
            }
        };
    }
    let fit = engine.step(
        FIT,
        &unit,
        flatten("fit", &config.fit)?,
        inputs.clone(),
        || {
            let fit = fit::fit_group(group, &rows(engine, &members)?, &config.fit);
            Ok(Outputs::from([(FIT_JSON.to_owned(), json(&fit)?)]))
        },
    )?;
    let compare = compare_step(engine, &unit, &fit, inputs.clone(), &members, config)?;
    let diagnose = is_asked.then(|| {
        let rows = || rows(engine, &members);
        diagnosis::step(engine, group, &unit, inputs, rows, config)
    });
    Ok(GroupResult {
        group: group.clone(),
        fit: fit.settled(),
        compare: compare.settled(),
        diagnose: diagnose.transpose()?.map(Step::settled),
    })
}

/// A group as its units are named.
pub fn unit(group: &Group) -> String {
    format!("{} {} mm", group.campaign, group.diameter_mm)
}

/// A dry run in which a session of the group is still to be read.
fn all_wait(engine: &Engine, group: &Group, is_asked: bool, on: &str) -> Result<GroupResult> {
    let unit = unit(group);
    let diagnose = is_asked.then_some(diagnosis::DIAGNOSE);
    Ok(GroupResult {
        group: group.clone(),
        fit: engine.waits(FIT, &unit, on)?,
        compare: engine.waits(COMPARE, &unit, "fit")?,
        diagnose: diagnose.map(|s| engine.waits(s, &unit, on)).transpose()?,
    })
}

fn compare_step(
    engine: &Engine,
    unit: &str,
    fit: &Step,
    mut inputs: BTreeMap<String, Digest>,
    members: &[&SessionResult],
    config: &Config,
) -> Result<Step> {
    let Some(object) = fit.entry().and_then(|e| e.outputs.get(FIT_JSON)) else {
        return engine.waits(COMPARE, unit, "fit");
    };
    inputs.insert(FIT_JSON.to_owned(), object.digest.clone());
    let mut options = flatten("fit", &config.fit)?;
    options.extend(flatten("compare", &config.compare)?);
    engine.step(COMPARE, unit, options, inputs, || {
        let fitted: GroupFit = from_slice(&engine.read(fit, FIT_JSON)?)?;
        let rows = rows(engine, members)?;
        let (comparison, predictions) =
            compare::compare(&fitted, &rows, &config.compare, &config.fit);
        Ok(Outputs::from([
            (COMPARISON_JSON.to_owned(), json(&comparison)?),
            (
                PREDICTIONS.to_owned(),
                predictions_frame(&predictions).to_parquet()?,
            ),
        ]))
    })
}

fn json(value: &impl serde::Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec(value).map_err(Error::internal)
}

/// Whether the rows of a session belong to a group.
pub fn belongs(group: &Group, session: &Session) -> bool {
    session.kind == Kind::Isometric
        && group.members.contains(&session.campaign)
        && session.specimen.diameter_mm as u32 == group.diameter_mm
}

/// The sessions of a group, by id.
fn members<'a>(
    group: &Group,
    discovery: &Discovery,
    sessions: &'a [SessionResult],
) -> Vec<&'a SessionResult> {
    discovery
        .sessions
        .iter()
        .zip(sessions)
        .filter(|(located, _)| belongs(group, &located.session))
        .map(|(_, result)| result)
        .collect()
}

fn rows(engine: &Engine, members: &[&SessionResult]) -> Result<Vec<Row>> {
    let mut all = Vec::new();
    for member in members {
        all.extend(member.rows(engine)?);
    }
    Ok(all)
}

fn predictions_frame(predictions: &Predictions) -> Frame {
    let mut frame = row::to_frame(&predictions.rows);
    for (model, forces) in &predictions.by_model {
        frame = frame.with(
            &format!("{PREDICTED}{model}"),
            Values::Number(forces.clone()),
        );
    }
    frame
}

impl GroupResult {
    /// The group as its units are named.
    pub fn unit(&self) -> String {
        unit(&self.group)
    }

    /// Its steps with the names of their stages, in order.
    pub fn steps(&self) -> impl Iterator<Item = (&'static str, &Step)> {
        let diagnose = self.diagnose.iter().map(|step| ("diagnose", step));
        [("fit", &self.fit), ("compare", &self.compare)]
            .into_iter()
            .chain(diagnose)
    }

    /// The fit.
    ///
    /// # Errors
    /// A damaged entry.
    pub fn fitted(&self, engine: &Engine) -> Result<GroupFit> {
        from_slice(&engine.read(&self.fit, FIT_JSON)?)
    }

    /// The comparison.
    ///
    /// # Errors
    /// A damaged entry.
    pub fn compared(&self, engine: &Engine) -> Result<GroupComparison> {
        from_slice(&engine.read(&self.compare, COMPARISON_JSON)?)
    }

    /// The diagnosis; none for a group of several campaigns, or of too few readings.
    ///
    /// # Errors
    /// A damaged entry.
    pub fn diagnosed(&self, engine: &Engine) -> Result<Option<Diagnosis>> {
        match &self.diagnose {
            Some(step) => diagnosis::diagnosis(engine, step),
            None => Ok(None),
        }
    }

    /// The predictions of every model on the group's rows.
    ///
    /// # Errors
    /// A damaged entry.
    pub fn predictions(&self, engine: &Engine) -> Result<Predictions> {
        let frame = Frame::from_parquet(&engine.read(&self.compare, PREDICTIONS)?)?;
        let mut rows = row::from_frame(&frame)?;
        let mut by_model = BTreeMap::new();
        for (name, values) in &frame.columns {
            if let (Some(model), Values::Number(forces)) = (name.strip_prefix(PREDICTED), values) {
                by_model.insert(model.to_owned(), forces.clone());
                for row in &mut rows {
                    row.extras.remove(name);
                }
            }
        }
        Ok(Predictions { rows, by_model })
    }
}
