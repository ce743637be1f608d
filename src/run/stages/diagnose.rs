//! `diagnose`: what the model lacks on the rows of a group.

use super::normalize::{ROWS_OF_EACH, rows};
use super::parts::*;
use crate::engine::Engine;
use crate::made::UnitMade;
use crate::units::Unit;
use pipeline_base::frame::{Frame, Values};
use pipeline_config::Config;
use pipeline_diagnose as diagnose;
use pipeline_diagnose::Diagnosis;
use pipeline_diagnose::mixed_law::MixedLaw;
use pipeline_findings::{CampaignFindings, Residuals};
use pipeline_formats::discover::Discovery;
use std::collections::BTreeSet;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: diagnose::VERSION,
        code: code::DIAGNOSE,
    },
    rules: &[Rule {
        scope: Scope::Group,
        takes: is_searched,
        inputs: &[Input::Group, ROWS_OF_EACH],
        options: &["fit", "diagnose"],
        run,
    }],
};

/// As users name it.
pub const NAME: &str = "diagnose";

/// The answer, or null where a campaign has too few readings.
pub const FINDINGS: Artifact<Option<CampaignFindings>> = Artifact::json(NAME, "findings.json");
/// One row a reading: the residuals.
const RESIDUALS: Artifact<Frame> = Artifact::table(NAME, "residuals.parquet");
/// One row a reading: the columns that were tested.
const TESTED: Artifact<Frame> = Artifact::table(NAME, "tested.parquet");
/// What is left as the effects come in one after the other.
const STEPS: Artifact<Vec<(String, Vec<f64>)>> = Artifact::json(NAME, "steps.json");

/// The law as the mixed model has it; none where a campaign is not assessed.
pub const MIXED_LAW: Artifact<Option<MixedLaw>> = Artifact::json(NAME, "mixed_law.json");

/// A pool of many specimens is not searched, because its parts say as much in a fraction of the time.
fn is_searched(unit: &Unit, discovery: &Discovery, config: &Config) -> bool {
    let sessions = unit.sessions.iter();
    let sessions = sessions.map(|k| &discovery.sessions[*k].session);
    let specimens: BTreeSet<(&str, &str)> = sessions
        .map(|s| (s.campaign.as_str(), s.specimen.id.as_str()))
        .collect();
    let campaigns = unit.group.as_ref().map_or(0, |group| group.members.len());
    campaigns == 1 || specimens.len() <= config.diagnose.pooled_specimens
}

fn run(given: &Given) -> Result<Outputs> {
    let (group, config) = (given.group()?, given.config());
    let diagnosis = diagnose::diagnose(group, &rows(given)?, &config.fit, &config.diagnose);
    let Some(Diagnosis {
        findings,
        residuals,
        mixed_law,
    }) = diagnosis
    else {
        return FINDINGS.alone(&None);
    };
    let mut outputs = FINDINGS.alone(&Some(findings))?;
    MIXED_LAW.put(&mixed_law, &mut outputs)?;
    RESIDUALS.put(&residuals_frame(&residuals), &mut outputs)?;
    TESTED.put(&tested_frame(&residuals), &mut outputs)?;
    STEPS.put(&residuals.steps, &mut outputs)?;
    Ok(outputs)
}

/// What was found in a group, with the residuals; none where it was not searched or has too few readings.
///
/// # Errors
/// A damaged entry.
pub fn diagnosis(engine: &Engine, group: &UnitMade) -> Result<Option<Diagnosis>> {
    if group.step(NAME).is_none() {
        return Ok(None);
    }
    let Some(findings) = group.read(engine, &FINDINGS)? else {
        return Ok(None);
    };
    let (found, tested) = (
        group.read(engine, &RESIDUALS)?,
        group.read(engine, &TESTED)?,
    );
    Ok(Some(Diagnosis {
        findings,
        residuals: Residuals {
            steps: group.read(engine, &STEPS)?,
            ..residuals(found, tested)
        },
        mixed_law: group.read(engine, &MIXED_LAW)?,
    }))
}

/// What this run has found in a group; none where an earlier one has.
///
/// # Errors
fn numbers(list: &[f64]) -> Values {
    Values::Number(list.to_vec())
}

fn residuals_frame(residuals: &Residuals) -> Frame {
    let texts = |list: &[String]| Values::Text(list.iter().cloned().map(Some).collect());
    let rows = residuals.row.iter().map(|r| Some(*r)).collect();
    Frame::default()
        .with("session", texts(&residuals.session))
        .with("log", texts(&residuals.log))
        .with("row", Values::Integer(rows))
        .with("specimen", texts(&residuals.specimen))
        .with("before", numbers(&residuals.before))
        .with("after", numbers(&residuals.after))
        .with("conditional", numbers(&residuals.conditional))
        .with("unseen_before", numbers(&residuals.unseen_before))
        .with("unseen", numbers(&residuals.unseen))
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
            ("log", Values::Text(x)) => residuals.log = x.into_iter().flatten().collect(),
            ("row", Values::Integer(x)) => residuals.row = x.into_iter().flatten().collect(),
            ("specimen", Values::Text(x)) => residuals.specimen = x.into_iter().flatten().collect(),
            ("before", Values::Number(x)) => residuals.before = x,
            ("after", Values::Number(x)) => residuals.after = x,
            ("conditional", Values::Number(x)) => residuals.conditional = x,
            ("unseen_before", Values::Number(x)) => residuals.unseen_before = x,
            ("unseen", Values::Number(x)) => residuals.unseen = x,
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
            unseen_before: vec![1.5, -2.5],
            unseen: vec![0.75, -0.5],
            predicted: vec![10.0, 20.0],
            columns: vec![
                ("session".into(), vec![0.0, 1.0]),
                ("x".into(), vec![3.0, 4.0]),
            ],
            log: vec!["1.csv".into(), "2.csv".into()],
            row: vec![7, 9],
            steps: Vec::new(),
        };
        let back = |frame: Frame| Frame::from_parquet(&frame.to_parquet().unwrap()).unwrap();
        let after = residuals(back(residuals_frame(&before)), back(tested_frame(&before)));
        assert_eq!(after, before);
    }
}
