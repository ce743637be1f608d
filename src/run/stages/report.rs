//! `report`: tables, figures and pages of everything. It has no rules: its results are put in place between its units
//! ([`crate::reports`]), tables before the first figure is drawn. What it reads is declared all the same.

use super::parts::*;
use super::{clean, compare, diagnose, fit, ingest, normalize, torque};
use crate::engine::Engine;
use crate::made::UnitMade;
use pipeline_base::digest::Digest;
use pipeline_base::error::Error;
use pipeline_report::stage as report;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: "report",
        version: report::VERSION,
        code: code::REPORT,
    },
    rules: &[],
};

/// The stages of which it reads what they have made.
const READS: &[&str] = &[
    ingest::NAME,
    clean::NAME,
    normalize::NAME,
    fit::NAME,
    compare::NAME,
    diagnose::NAME,
    torque::NAME,
];

/// What it reads of a unit: stages, with a digest of each one's output; none where that is pending.
pub fn reads(made: &UnitMade) -> impl Iterator<Item = (&'static str, Option<&Digest>)> {
    made.outputs().filter(|(stage, _)| READS.contains(stage))
}

/// The value of an output, of a stage that it reads.
///
/// # Errors
/// It does not read that stage; a damaged cache.
pub fn read<T>(engine: &Engine, made: &UnitMade, artifact: &Artifact<T>) -> Result<T> {
    if !READS.contains(&artifact.stage) {
        let why = format!("the report does not read what {} makes", artifact.stage);
        return Err(Error::Internal(why));
    }
    made.read(engine, artifact)
}
