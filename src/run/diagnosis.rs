//! The stage `diagnose` of one group: its key, and what it leaves behind.

use crate::engine::{self, Engine};
use crate::groups;
use crate::step::{Stage, Step};
use pipeline_base::digest::Digest;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::{Frame, Values};
use pipeline_base::json;
use pipeline_base::row::Row;
use pipeline_config::{Config, DiagnoseOptions, flatten};
use pipeline_diagnose as diagnose;
use pipeline_diagnose::Diagnosis;
use pipeline_findings::{CampaignFindings, Residuals};
use pipeline_fit::Group;
use pipeline_formats::discover::Discovery;
use std::collections::{BTreeMap, BTreeSet};

/// The stage.
pub const DIAGNOSE: Stage = Stage {
    name: "diagnose",
    version: diagnose::VERSION,
    code: engine::DIAGNOSE,
};

/// The answer, or null where a campaign has too few readings.
const FINDINGS: &str = "findings.json";
/// One row a reading: the residuals.
const RESIDUALS: &str = "residuals.parquet";
/// One row a reading: the columns that were tested.
const TESTED: &str = "tested.parquet";

/// Whether a group is asked at all: a pool of many specimens is not, because its parts say as much in a fraction of the time.
pub fn is_asked(group: &Group, discovery: &Discovery, options: &DiagnoseOptions) -> bool {
    let own = discovery.sessions.iter().map(|l| &l.session);
    let own = own.filter(|s| groups::belongs(group, s));
    let specimens: BTreeSet<(&str, &str)> = own
        .map(|s| (s.campaign.as_str(), s.specimen.id.as_str()))
        .collect();
    group.members.len() == 1 || specimens.len() <= options.pooled_specimens
}

/// Brings the diagnosis of one group up to date; `inputs` are its rows.
///
/// # Errors
/// System errors of the store, damaged entries.
pub fn step(
    engine: &Engine,
    group: &Group,
    unit: &str,
    inputs: BTreeMap<String, Digest>,
    rows: impl FnOnce() -> Result<Vec<Row>>,
    config: &Config,
) -> Result<Step> {
    let mut options = flatten("fit", &config.fit)?;
    options.extend(flatten("diagnose", &config.diagnose)?);
    engine.step(DIAGNOSE, unit, options, inputs, || {
        let diagnosis = diagnose::diagnose(group, &rows()?, &config.fit, &config.diagnose);
        let findings = diagnosis.as_ref().map(|d| &d.findings);
        let findings = serde_json::to_vec(&findings).map_err(Error::internal)?;
        let mut outputs = Outputs::from([(FINDINGS.to_owned(), findings)]);
        if let Some(diagnosis) = &diagnosis {
            let residuals = &diagnosis.residuals;
            outputs.insert(
                RESIDUALS.to_owned(),
                residuals_frame(residuals).to_parquet()?,
            );
            outputs.insert(TESTED.to_owned(), tested_frame(residuals).to_parquet()?);
        }
        Ok(outputs)
    })
}

/// What was found; none where a campaign has too few readings.
///
/// # Errors
/// A damaged entry.
pub fn findings(engine: &Engine, step: &Step) -> Result<Option<CampaignFindings>> {
    json::from_slice(&engine.read(step, FINDINGS)?)
}

/// What was found, with the residuals.
///
/// # Errors
/// A damaged entry.
pub fn diagnosis(engine: &Engine, step: &Step) -> Result<Option<Diagnosis>> {
    let Some(findings) = findings(engine, step)? else {
        return Ok(None);
    };
    let frame = |name| Frame::from_parquet(&engine.read(step, name)?);
    Ok(Some(Diagnosis {
        findings,
        residuals: residuals(frame(RESIDUALS)?, frame(TESTED)?),
    }))
}

fn numbers(list: &[f64]) -> Values {
    Values::Number(list.to_vec())
}

fn residuals_frame(residuals: &Residuals) -> Frame {
    let texts = |list: &[String]| Values::Text(list.iter().cloned().map(Some).collect());
    Frame::default()
        .with("session", texts(&residuals.session))
        .with("specimen", texts(&residuals.specimen))
        .with("before", numbers(&residuals.before))
        .with("after", numbers(&residuals.after))
        .with("conditional", numbers(&residuals.conditional))
        .with("predicted", numbers(&residuals.predicted))
}

fn tested_frame(residuals: &Residuals) -> Frame {
    let columns = residuals.columns.iter();
    columns.fold(Frame::default(), |frame, (name, values)| {
        frame.with(name, numbers(values))
    })
}

fn residuals(frame: Frame, tested: Frame) -> Residuals {
    let mut residuals = Residuals::default();
    for (name, values) in frame.columns {
        match (name.as_str(), values) {
            ("session", Values::Text(x)) => residuals.session = x.into_iter().flatten().collect(),
            ("specimen", Values::Text(x)) => residuals.specimen = x.into_iter().flatten().collect(),
            ("before", Values::Number(x)) => residuals.before = x,
            ("after", Values::Number(x)) => residuals.after = x,
            ("conditional", Values::Number(x)) => residuals.conditional = x,
            ("predicted", Values::Number(x)) => residuals.predicted = x,
            _ => {}
        }
    }
    let columns = tested.columns.into_iter();
    let numbers = columns.filter_map(|(name, values)| match values {
        Values::Number(x) => Some((name, x)),
        _ => None,
    });
    residuals.columns = numbers.collect();
    residuals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_come_back_from_their_table() {
        let before = Residuals {
            session: vec!["s".into(), "t".into()],
            specimen: vec!["a".into(), "b".into()],
            before: vec![1.0, -2.0],
            after: vec![0.5, -0.25],
            conditional: vec![0.1, 0.0],
            predicted: vec![10.0, 20.0],
            columns: vec![
                ("session".into(), vec![0.0, 1.0]),
                ("x".into(), vec![3.0, 4.0]),
            ],
        };
        let back = |frame: Frame| Frame::from_parquet(&frame.to_parquet().unwrap()).unwrap();
        let after = residuals(back(residuals_frame(&before)), back(tested_frame(&before)));
        assert_eq!(after, before);
    }
}
