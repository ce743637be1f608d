//! The figures of one group of rows, a unit of the stage `report`: what changes in one campaign draws its own figures and no others.

use crate::engine::Engine;
use crate::made::UnitMade;
use crate::stages::compare::{COMPARISON, PREDICTIONS};
use crate::stages::diagnose::diagnosis;
use crate::stages::fit::FIT;
use crate::stages::report::{STAGE, read, reads};
use crate::step::Step;
use pipeline_base::error::{Error, Result};
use pipeline_compare::Predictions;
use pipeline_config::Config;
use pipeline_report::left_out::LeftOut;
use pipeline_report::stage as report;
use pipeline_report::stage::{GroupFigures, GroupInput};
use std::collections::BTreeMap;

/// The options that figures read.
const OPTIONS: &[&str] = &["report.png_dpi", "report.figure_widths", "fit"];

/// Brings the figures of one group up to date.
///
/// # Errors
/// System errors, damaged entries.
pub fn process(engine: &Engine, group: &UnitMade, config: &Config) -> Result<Step> {
    let name = &group.unit.name;
    let unit = format!("figures of {name}");
    let mut inputs = BTreeMap::new();
    for (stage, output) in reads(group) {
        let Some(digest) = output else {
            return engine.waits(STAGE.stage, &unit, &format!("{stage} of {name}"));
        };
        inputs.insert(format!("{name} {stage}"), digest.clone());
    }
    let part = config.part(OPTIONS)?;
    let step = engine.step(STAGE.stage, &unit, part.keyed, inputs, || {
        let input = input(engine, group, read(engine, group, &PREDICTIONS)?)?;
        report::group_figures(&input, &part.config)
    })?;
    Ok(step.settled())
}

/// What the report says of a group, with these predictions.
///
/// # Errors
/// A damaged entry.
pub fn input(engine: &Engine, group: &UnitMade, predictions: Predictions) -> Result<GroupInput> {
    Ok(GroupInput {
        fit: read(engine, group, &FIT)?,
        comparison: read(engine, group, &COMPARISON)?,
        predictions,
        diagnosis: diagnosis(engine, group)?,
    })
}

/// The figures that could not be built.
///
/// # Errors
/// A damaged entry.
pub fn left_out(engine: &Engine, step: &Step) -> Result<Vec<LeftOut>> {
    serde_json::from_slice(&engine.read(step, report::LEFT_OUT)?).map_err(Error::internal)
}

/// The figures as drawn.
///
/// # Errors
/// A damaged entry.
pub fn drawn(engine: &Engine, step: &Step) -> Result<GroupFigures> {
    serde_json::from_slice(&engine.read(step, report::DRAWN)?).map_err(Error::internal)
}
