//! `compare`: every model on the rows of a group.

use super::fit::FIT;
use super::normalize::{ROWS_OF_EACH, rows};
use super::parts::*;
use super::report;
use crate::engine::Engine;
use crate::made::UnitMade;
use pipeline_base::columns::derived;
use pipeline_base::error::Error;
use pipeline_base::frame::{Frame, Values};
use pipeline_base::row;
use pipeline_compare as compare;
use pipeline_compare::{GroupComparison, Predictions};
use pipeline_report::predictions::Columns;
use std::collections::BTreeMap;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: compare::VERSION,
        code: code::COMPARE,
    },
    rules: &[Rule {
        scope: Scope::Group,
        takes: every,
        inputs: &[FIT.own(), Input::Group, ROWS_OF_EACH],
        options: &["fit", "compare"],
        run,
    }],
};

/// As users name it.
pub const NAME: &str = "compare";

/// The comparison.
pub const COMPARISON: Artifact<GroupComparison> = Artifact::json(NAME, "comparison.json");
/// Rows with the prediction of every model.
pub const PREDICTIONS: Artifact<Predictions> = Artifact::table(NAME, "predictions.parquet");

/// The same as a table.
const FORCES: Artifact<Frame> = Artifact::table(NAME, "predictions.parquet");

/// How the column of a model's predictions begins.
const PREDICTED: &str = "force_n by ";

fn run(given: &Given) -> Result<Outputs> {
    let (fitted, config) = (given.own(&FIT)?, given.config());
    let rows = rows(given)?;
    let (comparison, predictions) = compare::compare(&fitted, &rows, &config.compare, &config.fit);
    let mut outputs = COMPARISON.alone(&comparison)?;
    PREDICTIONS.put(&predictions, &mut outputs)?;
    Ok(outputs)
}

impl Tabular for Predictions {
    fn to_frame(&self) -> Frame {
        let rows = row::to_frame(&self.rows);
        self.by_model.iter().fold(rows, |frame, (model, forces)| {
            let name = format!("{PREDICTED}{model}");
            frame.with(&name, Values::Number(forces.clone()))
        })
    }

    fn from_frame(frame: Frame) -> Result<Self> {
        let mut rows = row::from_frame(&frame)?;
        let mut by_model = BTreeMap::new();
        for (name, values) in frame.columns {
            if let (Some(model), Values::Number(forces)) = (name.strip_prefix(PREDICTED), values) {
                by_model.insert(model.to_owned(), forces);
                for row in &mut rows {
                    row.extras.remove(&name);
                }
            }
        }
        Ok(Predictions { rows, by_model })
    }
}

/// The readings of a group with every model's force, placed among all readings.
///
/// # Errors
/// A damaged entry.
pub fn place(engine: &Engine, group: &UnitMade, among: &mut Columns) -> Result<()> {
    let frame = report::read(engine, group, &FORCES)?;
    let missing = || Error::Internal("a table of predictions without its readings".to_owned());
    let sessions = frame.texts(derived::SESSION).ok_or_else(missing)?;
    let logs = frame.texts(derived::LOG).ok_or_else(missing)?;
    let rows = frame.integers(derived::ROW).ok_or_else(missing)?;
    let keys = sessions.iter().zip(logs).zip(rows);
    let places: Vec<Option<usize>> = keys
        .map(|((session, log), row)| among.place(session.as_deref()?, log.as_deref()?, (*row)?))
        .collect();
    let is_pool = group.unit.group.as_ref().is_some_and(|g| g.is_pool());
    for (name, values) in &frame.columns {
        if let (Some(model), Values::Number(forces)) = (name.strip_prefix(PREDICTED), values) {
            among.put_model(is_pool, model, &places, forces);
        }
    }
    Ok(())
}
