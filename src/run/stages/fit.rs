//! `fit`: the new model, fitted to the rows of a group.

use super::normalize::{ROWS_OF_EACH, rows};
use super::parts::*;
use pipeline_fit as fit;
use pipeline_fit::GroupFit;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: NAME,
        version: fit::VERSION,
        code: code::FIT,
    },
    rules: &[Rule {
        scope: Scope::Group,
        takes: every,
        inputs: &[Input::Group, ROWS_OF_EACH],
        options: &["fit"],
        run,
    }],
};

/// As users name it.
pub const NAME: &str = "fit";

/// The fit.
pub const FIT: Artifact<GroupFit> = Artifact::json(NAME, "fit.json");

fn run(given: &Given) -> Result<Outputs> {
    FIT.alone(&fit::fit_group(
        given.group()?,
        &rows(given)?,
        &given.config().fit,
    ))
}
