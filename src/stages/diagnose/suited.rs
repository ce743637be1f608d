//! The problem that suits some readings: the floor of its misfit, and whether strokes have one; with its model without any effect.

use crate::base::Base;
use crate::data::Data;
use crate::problem::ForceProblem;
use crate::{library, settings};
use pipeline_inference::decisions;
use pipeline_inference::fit::{Fitted, Setting};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// What is made of the standard deviations of set lengths that somebody declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declared {
    /// They are taken as they are.
    Taken,
    /// The readings contradict them: the scatter is estimated.
    Contradicted,
}

/// The problem with the floor of the misfit under which the readings are most likely, and with a misfit of every stroke where they show it;
/// and its model without any effect.
pub fn suited<'a>(
    base: &'a Base,
    data: &'a Data,
    library: &'a [library::Term],
    kept_out: &BTreeSet<&str>,
    declared: Declared,
) -> (ForceProblem<'a>, Fitted) {
    let assumed = |problem: ForceProblem<'a>| match declared {
        Declared::Taken => problem,
        Declared::Contradicted => problem.with_declared_estimated(),
    };
    let with_null = |problem: ForceProblem<'a>| {
        let problem = assumed(problem);
        let null = start(&part_of(&problem, kept_out));
        (problem, null)
    };
    // Whether strokes differ is asked first: their misfit has the same scale, and without it another floor would be the likelier one.
    let plain = assumed(ForceProblem::new(base, data, library));
    let plain = with_null(plain.with_reference());
    let stroked = plain.0.with_strokes().map(with_null);
    let gain = |(_, null): &(ForceProblem, Fitted)| null.log_likelihood - plain.1.log_likelihood;
    let mut best = match stroked {
        Some(stroked) if gain(&stroked) > decisions::ALIKE => stroked,
        _ => plain,
    };
    let others: Vec<(ForceProblem, Fitted)> = settings::OTHER_FLOORS
        .into_par_iter()
        .map(|share| with_null(best.0.with_floor(share)))
        .collect();
    for other in others {
        if other.1.log_likelihood > best.1.log_likelihood {
            best = other;
        }
    }
    best
}

/// A problem without the sessions that are kept out.
pub(crate) fn part_of<'a>(problem: &'a ForceProblem, kept_out: &BTreeSet<&str>) -> Setting<'a> {
    let nodes = problem.sessions.iter().zip(&problem.data.sessions);
    nodes
        .filter(|(_, id)| kept_out.contains(id.as_str()))
        .fold(Setting::new(problem), |part, (node, _)| part.without(*node))
}

/// The model without any effect.
pub(crate) fn start(setting: &Setting) -> Fitted {
    setting.fit_afresh(&setting.problem.start())
}
