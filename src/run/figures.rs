//! The figures of one group of rows, a unit of the stage `report`: what changes in one campaign draws its own figures and no others.

use crate::engine::Engine;
use crate::groups::GroupResult;
use crate::reports::REPORT;
use crate::step::Step;
use pipeline_base::error::{Error, Result};
use pipeline_compare::Predictions;
use pipeline_config::{Config, flatten};
use pipeline_report::left_out::LeftOut;
use pipeline_report::stage as report;
use pipeline_report::stage::{GroupFigures, GroupInput};
use std::collections::BTreeMap;

/// The only option of the report that figures read.
const PNG_DPI: &str = "report.png_dpi";

/// Brings the figures of one group up to date.
///
/// # Errors
/// System errors, damaged entries.
pub fn process(engine: &Engine, group: &GroupResult, config: &Config) -> Result<Step> {
    let unit = format!("figures of {}", group.unit());
    let mut inputs = BTreeMap::new();
    for (stage, step) in group.steps() {
        let Some(entry) = step.entry() else {
            return engine.waits(REPORT, &unit, &format!("{stage} of {}", group.unit()));
        };
        inputs.insert(format!("{} {stage}", group.unit()), entry.digest());
    }
    let mut options = flatten("report", &config.report)?;
    options.retain(|name, _| name == PNG_DPI);
    options.extend(flatten("fit", &config.fit)?);
    let step = engine.step(REPORT, &unit, options, inputs, || {
        let input = input(engine, group, group.predictions(engine)?)?;
        report::group_figures(&input, config)
    })?;
    Ok(step.settled())
}

/// What the report says of a group, with these predictions.
///
/// # Errors
/// A damaged entry.
pub fn input(engine: &Engine, group: &GroupResult, predictions: Predictions) -> Result<GroupInput> {
    Ok(GroupInput {
        fit: group.fitted(engine)?,
        comparison: group.compared(engine)?,
        predictions,
        diagnosis: group.diagnosed(engine)?,
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
