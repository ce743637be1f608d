//! `normalize`: the rows of a session.

use super::clean::READINGS;
use super::parts::*;
use pipeline_base::reject::Reject;
use pipeline_base::row::Row;
use pipeline_fit::zeros::with_usual_zeros;
use pipeline_normalize as normalize;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: normalize::VERSION,
        code: code::NORMALIZE,
    },
    rules: &[Rule {
        scope: Scope::Session,
        takes: every,
        inputs: &[READINGS.own(), Input::Descriptions],
        options: &[],
        run,
    }],
};

/// As users name it.
pub const NAME: &str = "normalize";

/// The rows.
pub const ROWS: Artifact<Vec<Row>> = Artifact::table(NAME, "rows.parquet");
/// The readings that could not be normalised.
pub const REJECTS: Artifact<Vec<Reject>> = Artifact::json(NAME, "rejects.json");

/// The rows of each session, as an input that the key has under the session's id.
pub const ROWS_OF_EACH: Input = ROWS.each("");

fn run(given: &Given) -> Result<Outputs> {
    let readings = given.own(&READINGS)?;
    let (rows, rejects) = normalize::normalize(given.description()?, &readings);
    let mut outputs = ROWS.alone(&rows)?;
    REJECTS.put(&rejects, &mut outputs)?;
    Ok(outputs)
}

/// The rows of all sessions one after the other, with the usual zeros of their campaigns ([`pipeline_fit::zeros`]), for a rule that reads
/// [`ROWS_OF_EACH`] and the options of the fit.
///
/// # Errors
/// They are not declared; a damaged cache.
pub fn rows(given: &Given) -> Result<Vec<Row>> {
    let rows = given.each(&ROWS)?.into_iter().flatten().collect();
    Ok(with_usual_zeros(rows, &given.config().fit))
}
