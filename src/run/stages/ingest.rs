//! `ingest`: the raw logs of a session, calibrated and in one unit a quantity.

use super::parts::*;
use pipeline_ingest as ingest;
use pipeline_ingest::{IngestHeader, LogSamples};

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: ingest::VERSION,
        code: code::INGEST,
    },
    rules: &[Rule {
        scope: Scope::Session,
        takes: every,
        inputs: &[Input::Descriptions, Input::Logs],
        options: &[],
        run,
    }],
};

/// As users name it.
pub const NAME: &str = "ingest";

/// Everything but the values; it names the output that holds those of each log.
pub const HEADER: Artifact<IngestHeader> = Artifact::json(NAME, "header.json");

fn run(given: &Given) -> Result<Outputs> {
    let (folder, files) = given.logs()?;
    let ingested = ingest::ingest(given.description()?, folder, files);
    let mut outputs = HEADER.alone(&ingested.header)?;
    for (header, log) in ingested.header.logs.iter().zip(&ingested.logs) {
        outputs.insert(header.output.clone(), log.to_frame().to_parquet()?);
    }
    Ok(outputs)
}

/// The logs of a session, for a rule that reads all outputs of this stage.
///
/// # Errors
/// They are not declared; a damaged cache.
pub fn logs(given: &Given) -> Result<Vec<LogSamples>> {
    let logs = given.own(&HEADER)?.logs.into_iter();
    let samples = logs.map(|log| {
        let frame = given.own_table(NAME, &log.output)?;
        Ok(LogSamples::from_frame(log.spec, log.first_line, frame))
    });
    samples.collect()
}
