//! The stage `diagnose` of one group: its key, and what it leaves behind.

use crate::base::error::{Error, Result};
use crate::base::frame::{Frame, Values};
use crate::base::json;
use crate::base::row::Row;
use crate::cache::Digest;
use crate::cache::store::Outputs;
use crate::config::{Config, flatten};
use crate::run::engine::{self, Engine};
use crate::run::step::{Stage, Step};
use crate::stages::diagnose::findings::{CampaignFindings, Residuals};
use crate::stages::diagnose::{self, Diagnosis};
use crate::stages::fit::Group;
use std::collections::BTreeMap;

/// The stage.
pub const DIAGNOSE: Stage = Stage {
    name: "diagnose",
    version: diagnose::VERSION,
    code: engine::DIAGNOSE,
};

/// The answer, or null where a campaign has too few readings.
const FINDINGS: &str = "findings.json";
/// One row a reading: residuals, and the columns of the questions.
const RESIDUALS: &str = "residuals.parquet";
const ASKED: &str = "asked ";

/// Whether a group is asked at all: readings of several campaigns differ by more than an effect.
pub fn is_asked(group: &Group) -> bool {
    group.members.len() == 1
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
            let frame = residuals_frame(&diagnosis.residuals);
            outputs.insert(RESIDUALS.to_owned(), frame.to_parquet()?);
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
    let frame = Frame::from_parquet(&engine.read(step, RESIDUALS)?)?;
    Ok(Some(Diagnosis {
        findings,
        residuals: residuals(frame),
    }))
}

fn residuals_frame(residuals: &Residuals) -> Frame {
    let texts = |list: &[String]| Values::Text(list.iter().cloned().map(Some).collect());
    let numbers = |list: &[f64]| Values::Number(list.to_vec());
    let mut frame = Frame::default()
        .with("session", texts(&residuals.session))
        .with("specimen", texts(&residuals.specimen))
        .with("before_n", numbers(&residuals.before))
        .with("after_n", numbers(&residuals.after))
        .with("predicted_n", numbers(&residuals.predicted));
    for (name, values) in &residuals.columns {
        frame = frame.with(&format!("{ASKED}{name}"), numbers(values));
    }
    frame
}

fn residuals(frame: Frame) -> Residuals {
    let mut residuals = Residuals::default();
    for (name, values) in frame.columns {
        match (name.as_str(), values) {
            ("session", Values::Text(x)) => residuals.session = x.into_iter().flatten().collect(),
            ("specimen", Values::Text(x)) => residuals.specimen = x.into_iter().flatten().collect(),
            ("before_n", Values::Number(x)) => residuals.before = x,
            ("after_n", Values::Number(x)) => residuals.after = x,
            ("predicted_n", Values::Number(x)) => residuals.predicted = x,
            (name, Values::Number(x)) => {
                let asked = name.strip_prefix(ASKED).unwrap_or(name);
                residuals.columns.push((asked.to_owned(), x));
            }
            _ => {}
        }
    }
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
            predicted: vec![10.0, 20.0],
            columns: vec![
                ("session".into(), vec![0.0, 1.0]),
                ("x".into(), vec![3.0, 4.0]),
            ],
        };
        let bytes = residuals_frame(&before).to_parquet().unwrap();
        assert_eq!(residuals(Frame::from_parquet(&bytes).unwrap()), before);
    }
}
