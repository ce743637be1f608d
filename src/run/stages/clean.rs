//! `clean`: the steady readings of a session.

use super::ingest;
use super::parts::*;
use pipeline_base::reading::Reading;
use pipeline_clean as clean;
use pipeline_clean::CleanHeader;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: clean::VERSION,
        code: code::CLEAN,
    },
    rules: &[Rule {
        scope: Scope::Session,
        takes: every,
        inputs: &[Input::All(ingest::NAME), Input::Descriptions],
        options: &["clean"],
        run,
    }],
};

/// As users name it.
pub const NAME: &str = "clean";

/// Everything but the readings.
pub const HEADER: Artifact<CleanHeader> = Artifact::json(NAME, "header.json");
/// The readings.
pub const READINGS: Artifact<Vec<Reading>> = Artifact::table(NAME, "readings.parquet");

fn run(given: &Given) -> Result<Outputs> {
    let logs = ingest::logs(given)?;
    let cleaned = clean::clean(given.description()?, &logs, &given.config().clean);
    let mut outputs = HEADER.alone(&cleaned.header)?;
    READINGS.put(&cleaned.readings, &mut outputs)?;
    Ok(outputs)
}
