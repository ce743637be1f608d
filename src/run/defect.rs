//! Defects of the program: what panics in one unit is an error of that unit, and says which.

use crate::step::Stage;
use pipeline_base::error::{Error, Result, panic_message};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of some work on a unit; of a panic or an internal error, an error that names stage and unit.
///
/// # Errors
/// What the work fails with.
pub fn caught<T>(stage: Stage, unit: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    // Nothing that the work has touched is looked at again: what it would have given is dropped with it.
    let done = catch_unwind(AssertUnwindSafe(work));
    let named = |why: &str| Error::Internal(format!("{} of {unit}: {why}", stage.name));
    match done {
        Ok(Err(Error::Internal(why))) => Err(named(&why)),
        Ok(result) => result,
        Err(panic) => Err(named(&panic_message(panic.as_ref()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_that_names_the_unit() {
        let stage = Stage {
            name: "clean",
            version: 1,
            code: "",
        };
        let empty: Vec<usize> = Vec::new();
        let panics = caught(stage, "iso10", || Ok(empty[empty.len()]));
        let said = "clean of iso10: index out of bounds: the len is 0 but the index is 0";
        assert!(matches!(panics, Err(Error::Internal(w)) if w == said));
        let fails = caught(stage, "iso10", || -> Result<()> {
            Err(Error::Internal("no room".to_owned()))
        });
        assert!(matches!(fails, Err(Error::Internal(w)) if w == "clean of iso10: no room"));
        assert!(matches!(caught(stage, "iso10", || Ok(1)), Ok(1)));
    }
}
